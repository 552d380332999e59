"""hpm_mvs status: how far a workspace is, for people and for scripts, without changing
anything."""
import json
import os
import subprocess
import unittest

from png import png
from support import FAST, HPM_MVS, CliTest


class Status(CliTest):
    def setUp(self):
        self.dense = self.workspace()

    def status(self, *options, code):
        result = subprocess.run(
            [HPM_MVS, "status", "--workspace_path", str(self.dense), *FAST, *options],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            timeout=120,
        )
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        return result.stdout

    def stages(self, *options, code):
        answer = json.loads(self.status("--format", "json", *options, code=code))
        self.assertEqual(answer["complete"], code == 0)
        return {stage.pop("name"): stage for stage in answer["stages"]}, answer

    def spoil_unnoticed(self, kind, name):
        """Other bytes, with the length and time of before."""
        path = self.dense / "stereo" / kind / name
        stat = path.stat()
        data = bytearray(path.read_bytes())
        data[-2] ^= 1
        path.write_bytes(data)
        os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))

    def test_counts_what_each_stage_needs_and_ends_with_0_when_complete(self):
        stages, _ = self.stages(code=8)
        self.assertEqual(list(stages)[-1], "geometric")
        self.assertIn("photometric", stages)
        self.assertTrue(all(s["needed"] == 4 and s["finished"] == 0 for s in stages.values()))
        self.assert_exit(self.run_tool(self.dense, *FAST), 0)
        stages, answer = self.stages(code=0)
        self.assertEqual(answer["failing"], [])
        self.assertTrue(all(s["needed"] == 0 and s["finished"] == 4 for s in stages.values()))
        self.assertTrue(self.status(code=0).endswith("complete\n"))

    def test_a_missing_result_needs_its_inner_maps_too(self):
        self.assert_exit(self.run_tool(self.dense, *FAST), 0)
        (self.dense / "stereo/depth_maps/view00.png.geometric.bin").unlink()
        stages, _ = self.stages(code=8)
        self.assertEqual(stages["geometric"]["needed"], 1)
        self.assertEqual(stages["geometric"]["finished"], 3)

    def test_other_options_make_maps_stale(self):
        self.assert_exit(self.run_tool(self.dense, *FAST), 0)
        stages, _ = self.stages("--random_seed", "7", code=8)
        self.assertEqual(stages["geometric"]["stale"], 4)
        self.assertEqual(stages["geometric"]["needed"], 4)

    def test_damage_is_counted_and_with_verify_also_where_length_and_time_hide_it(self):
        self.assert_exit(self.run_tool(self.dense, *FAST), 0)
        self.spoil_unnoticed("depth_maps", "view01.png.geometric.bin")
        self.stages(code=0)
        stages, _ = self.stages("--verify", "1", code=8)
        self.assertEqual(stages["geometric"]["damaged"], 1)
        map_file = self.dense / "stereo/normal_maps/view02.png.geometric.bin"
        map_file.write_bytes(map_file.read_bytes()[:-1])
        stages, _ = self.stages(code=8)
        self.assertEqual(stages["geometric"]["damaged"], 1)

    def test_changes_nothing(self):
        self.assert_exit(self.run_tool(self.dense, *FAST), 0)
        map_file = self.dense / "stereo/depth_maps/view02.png.geometric.bin"
        map_file.write_bytes(map_file.read_bytes()[:-1])
        os.utime(self.dense / "stereo/depth_maps/view01.png.geometric.bin")

        def files():
            return {p: p.stat().st_mtime_ns for p in self.dense.rglob("*")}

        before = files()
        self.status(code=8)
        self.status("--verify", "1", code=8)
        self.assertEqual(files(), before)

    def test_nothing_is_written_by_whoever_only_looks(self):
        for path in (self.dense / "images").iterdir():
            grey = b"".join((100 + 37 * i % 4000).to_bytes(2, "big") for i in range(96 * 72))
            path.write_bytes(png(96, 72, grey, bits=16))
        before = sorted(self.dense.rglob("*"))
        for command in (["status"], ["check"], ["plan", "--sample_seconds=0"]):
            result = subprocess.run(
                [HPM_MVS, *command, "--workspace_path", str(self.dense), *FAST],
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                timeout=120,
            )
            self.assertIn(result.returncode, (0, 4, 8), result.stderr)
            self.assertEqual(sorted(self.dense.rglob("*")), before, command)

    def test_images_that_cannot_be_computed_are_named_and_exit_4(self):
        (self.dense / "images/view03.png").unlink()
        self.assert_exit(self.run_tool(self.dense, *FAST), 4)
        _, answer = self.stages(code=4)
        self.assertEqual(answer["failing"], ["view03.png"])
        self.assertRegex(self.status(code=4), r"view03.png\nnot complete, .* mended\n$")

    def test_a_folder_that_is_no_workspace_is_exit_3(self):
        (self.dense / "sparse/cameras.bin").unlink()
        self.status(code=3)


if __name__ == "__main__":
    unittest.main()
