"""hpm_mvs check: every damaged, unreadable, stale, unstamped, foreign and missing map is
named, and --fix removes what is damaged, no more."""
import array
import subprocess
import unittest

from support import FAST, HPM_MVS, CliTest, map_files

GRAPHS = [*FAST, "--PatchMatchStereo.write_consistency_graph=1"]


def with_values(data, changes):
    """The bytes of a map with other float values at some indices."""
    begin = 0
    for _ in range(3):
        begin = data.index(b"&", begin) + 1
    values = array.array("f")
    values.frombytes(data[begin:])
    for index, value in changes.items():
        values[index] = value
    return data[:begin] + values.tobytes()


class Check(CliTest):
    def setUp(self):
        self.dense = self.workspace()

    def check(self, *options):
        result = subprocess.run(
            [HPM_MVS, "check", "--workspace_path", str(self.dense), *options],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            timeout=120,
        )
        lines = result.stdout.splitlines()
        return result, [line for line in lines if line.split()[0] in KINDS]

    def run_all(self, *options):
        self.assert_exit(self.run_tool(self.dense, *(options or GRAPHS)), 0)

    def spoil(self, name, fault):
        path = self.dense / "stereo" / name
        path.write_bytes(fault(path.read_bytes()))

    def test_good_maps_are_exit_0_and_nothing_is_changed(self):
        self.run_all()
        before = {p: p.stat().st_mtime_ns for p in self.dense.rglob("*") if p.is_file()}
        result, findings = self.check(*GRAPHS)
        self.assertEqual((result.returncode, findings, result.stderr), (0, [], ""))
        self.assertIn("24 files read: 0 damaged", result.stdout)
        after = {p: p.stat().st_mtime_ns for p in self.dense.rglob("*") if p.is_file()}
        self.assertEqual(before, after)

    def test_before_a_run_all_maps_are_missing(self):
        result, findings = self.check(*FAST)
        self.assertEqual(result.returncode, 4)
        self.assertEqual(len(findings), 8)
        self.assertTrue(all(line.startswith("missing view0") for line in findings))

    def test_each_kind_of_damage_is_named_with_file_and_reason(self):
        self.run_all()
        size = 96 * 72
        faults = {
            "depth_maps/view00.png.geometric.bin": (lambda d: d[:-1], "does not match its size"),
            "depth_maps/view01.png.geometric.bin": (
                lambda d: with_values(d, {5: float("nan")}), "not finite at column 5, row 0"),
            "depth_maps/view02.png.geometric.bin": (
                lambda d: with_values(d, {97: -2.0}), "negative at column 1, row 1"),
            "depth_maps/view03.png.geometric.bin": (
                lambda d: with_values(d, {7: 123.0}), "checksum"),
            "depth_maps/view00.png.photometric.bin": (
                lambda d: d.replace(b"96&72&1&", b"72&96&1&"), "is 72x96, its image 96x72"),
            "normal_maps/view01.png.photometric.bin": (
                lambda d: with_values(d, {9: 0.0, size + 9: 2.0, 2 * size + 9: 0.0}),
                "has the length 2 at column 9, row 0"),
            "normal_maps/view02.png.photometric.bin": (lambda d: b"", "does not begin with"),
            "consistency_graphs/view03.png.geometric.bin": (
                lambda d: d[:8] + b"\x01\0\0\0\x01\0\0\0\x01\0\0\0\x63\0\0\0", "image 99 of a model of 4"),
            "hpm_mvs/stamps/photometric/view03.png.json": (lambda d: d[:50], "no stamp"),
        }
        for name, (fault, _) in faults.items():
            self.spoil(name, fault)
        result, findings = self.check(*GRAPHS)
        self.assertEqual(result.returncode, 3, result.stdout)
        for name, (_, reason) in faults.items():
            matching = [f for f in findings if f.startswith(f"damaged {name}: ") and reason in f]
            self.assertEqual(len(matching), 1, f"{name}: {result.stdout}")
        self.assertIn(f"{len(faults)} damaged", result.stdout)
        # Nothing was touched.
        for name in faults:
            self.assertTrue((self.dense / "stereo" / name).exists())

    def test_fix_removes_what_is_damaged_and_the_next_run_makes_only_that(self):
        self.run_all()
        good = map_files(self.dense)
        bad = [
            "depth_maps/view00.png.geometric.bin",
            "normal_maps/view02.png.photometric.bin",
            "consistency_graphs/view03.png.geometric.bin",
        ]
        for name in bad:
            self.spoil(name, lambda data: data[:-3])
        result, findings = self.check(*GRAPHS, "--fix", "1")
        self.assertEqual(result.returncode, 4, result.stdout)
        self.assertEqual(
            [f.split(":")[0] for f in findings if "(removed)" in f],
            [f"damaged {name} (removed)" for name in (bad[1], bad[0], bad[2])],
        )
        self.assertEqual(set(map_files(self.dense)), set(good) - set(bad))
        kept = {
            name: (self.dense / "stereo" / name).stat().st_mtime_ns
            for name in good
            if not any(b.split("/")[1].replace(".bin", "") in name for b in bad)
        }
        self.assertEqual(len(kept), 15)
        self.run_all()
        self.assert_same_maps(map_files(self.dense), good)
        for name, time in kept.items():
            self.assertEqual((self.dense / "stereo" / name).stat().st_mtime_ns, time, name)
        self.assertEqual(self.check(*GRAPHS)[0].returncode, 0)

    def test_stale_foreign_and_missing_are_told_apart_and_stay(self):
        self.run_all(*FAST)
        depth = self.dense / "stereo/depth_maps"
        (self.dense / "stereo/hpm_mvs/stamps/geometric/view01.png.json").unlink()
        (depth / "stranger.png.geometric.bin").write_bytes(b"1&1&1&\0\0\0\0")
        (depth / "view02.png.geometric.bin").unlink()
        (self.dense / "stereo/hpm_mvs/stamps/geometric/stranger.png.json").write_text("{}")
        before = map_files(self.dense)
        result, findings = self.check(*FAST, "--fix", "1")
        self.assertEqual(result.returncode, 4)
        self.assertEqual(
            [f.split(":")[0] for f in findings],
            [
                "unstamped view01.png geometric",
                "missing view02.png geometric",
                "foreign depth_maps/stranger.png.geometric.bin",
                "foreign hpm_mvs/stamps/geometric/stranger.png.json",
            ],
        )
        self.assertEqual(map_files(self.dense), before)
        result, findings = self.check(*FAST, "--random_seed=4")
        self.assertEqual(result.returncode, 4)
        self.assertEqual(len([f for f in findings if f.startswith("stale ")]), 6)
        self.assertIn("give check the options of the run", result.stdout)

    def test_what_cannot_be_read_is_told_and_stays(self):
        self.run_all()
        depth = self.dense / "stereo/depth_maps"
        stamps = self.dense / "stereo/hpm_mvs/stamps/geometric"
        for path in (depth / "view00.png.geometric.bin", stamps / "view01.png.json"):
            path.unlink()
            path.mkdir()
        before = sorted(self.dense.rglob("*"))
        result, findings = self.check(*GRAPHS, "--fix", "1")
        self.assertEqual(result.returncode, 3, result.stdout)
        self.assertEqual(
            [f.split(": ")[0] for f in findings],
            [
                "unreadable depth_maps/view00.png.geometric.bin",
                "unreadable hpm_mvs/stamps/geometric/view01.png.json",
            ],
        )
        self.assertEqual(sorted(self.dense.rglob("*")), before)

    def test_a_folder_that_cannot_be_read_is_named(self):
        self.run_all(*FAST)
        folder = self.dense / "stereo/consistency_graphs"
        folder.rmdir()
        folder.write_bytes(b"")
        result, findings = self.check(*FAST, "--fix", "1")
        self.assertEqual(result.returncode, 3, result.stdout)
        self.assertEqual(len(findings), 1)
        self.assertTrue(findings[0].startswith("unreadable consistency_graphs: "), findings[0])
        self.assertTrue(folder.exists())

    def test_files_that_the_run_does_not_make_are_told_and_no_fault(self):
        self.run_all(*FAST)
        strangers = ["hpm_mvs/stamps/x.json", "hpm_mvs/stamps/geometric/x.json", "depth_maps/x.bin"]
        for name in strangers:
            (self.dense / "stereo" / name).write_text("{}")
        result, findings = self.check(*FAST, "--fix=1")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertEqual(
            sorted(f.split(": ")[0] for f in findings), sorted(f"foreign {s}" for s in strangers)
        )

    def test_a_damaged_stamp_is_told_once(self):
        self.run_all(*FAST)
        self.spoil("hpm_mvs/stamps/geometric/view01.png.json", lambda data: data[:50])
        for options, code in (((), 3), (("--fix=1",), 4)):
            result, findings = self.check(*FAST, *options)
            self.assertEqual((result.returncode, len(findings)), (code, 1), result.stdout)
        result, findings = self.check(*FAST)
        self.assertEqual(result.returncode, 4)
        self.assertEqual([f.split(": ")[0] for f in findings], ["unstamped view01.png geometric"])

    def test_depths_outside_a_given_range_are_damage(self):
        ranged = [*FAST, "--PatchMatchStereo.depth_min=1", "--PatchMatchStereo.depth_max=50"]
        self.run_all(*ranged)
        self.assertEqual(self.check(*ranged)[0].returncode, 0)
        self.spoil(
            "depth_maps/view00.png.geometric.bin", lambda d: with_values(d, {0: 80.0})
        )
        result, findings = self.check(*ranged)
        self.assertEqual(result.returncode, 3)
        self.assertIn("the depth 80 is not in 1 ... 50 at column 0, row 0", findings[0])

    def test_fix_waits_for_no_run(self):
        process = self.start_tool(self.dense, "--Hpm.num_iterations=400")
        result, _ = self.check("--fix=1")
        self.assert_exit(result, 7, "process")
        process.kill()

    def test_a_workspace_that_no_run_could_use_is_exit_3(self):
        (self.dense / "sparse/cameras.bin").write_bytes(b"")
        self.assert_exit(self.check()[0], 3, "cameras.bin")


KINDS = ("damaged", "unreadable", "stale", "unstamped", "foreign", "missing")

if __name__ == "__main__":
    unittest.main()
