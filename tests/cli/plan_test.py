"""hpm_mvs plan: all that would stop a run at once, with the run's exit code, and nothing
computed or changed."""
import re
import struct
import subprocess
import time
import unittest

from png import constant
from support import FAST, HPM_MVS, IS_SANITIZED, CliTest, map_files


class Plan(CliTest):
    def plan(self, dense, *options):
        return subprocess.run(
            [HPM_MVS, "plan", "--workspace_path", str(dense), *options],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            timeout=200,
        )

    def test_a_good_workspace_is_exit_0_with_what_a_run_would_do(self):
        dense = self.workspace()
        before = {p: p.is_file() and p.read_bytes() for p in dense.rglob("*")}
        result = self.plan(dense, *FAST, "--sample_seconds=0")
        self.assert_exit(result, 0)
        for line in (
            "Images: 4 to compute, 0 kept from an earlier run, 0 cannot be computed",
            "Sources per image: 3 to 3, median 3",
            "Working size: 96x72; ",
            " MB of memory",
            "Memory that may be used: ",
            "Disk: ",
            "Computed on: cpu",
            "Nothing stops this run",
        ):
            self.assertIn(line, result.stdout)
        self.assertNotIn("Time: ", result.stdout)
        self.assertEqual({p: p.is_file() and p.read_bytes() for p in dense.rglob("*")}, before)
        # Then a run of the same options, after which nothing is left.
        self.assert_exit(self.run_tool(dense, *FAST), 0)
        result = self.plan(dense, *FAST)
        self.assert_exit(result, 0)
        self.assertIn("Images: 0 to compute, 4 kept", result.stdout)
        self.assertIn("Time: nothing is left to compute", result.stdout)

    def test_the_time_is_of_the_order_of_the_run(self):
        dense = self.workspace(width=320, height=240)
        options = ["--PatchMatchStereo.num_threads=2", "--Hpm.quality=low"]
        result = self.plan(dense, *options, f"--sample_seconds={30 if IS_SANITIZED else 6}")
        self.assert_exit(result, 0)
        match = re.search(r"Time: about (\d+) s, from .* s of view0\d.png at \d+ pixels", result.stdout)
        self.assertIsNotNone(match, result.stdout)
        self.assertEqual(map_files(dense), {})
        begin = time.monotonic()
        self.assert_exit(self.run_tool(dense, *options), 0)
        taken = time.monotonic() - begin
        # Other tests run beside this one.
        self.assertLess(taken / 5, float(match[1]) + 1)
        self.assertGreater(taken * 5 + 1, float(match[1]))

    def test_reading_a_large_model_is_no_work_of_the_sample(self):
        dense = self.workspace(width=32, height=24)
        points = dense / "sparse/points3D.bin"
        data = points.read_bytes()
        count = struct.unpack_from("<Q", data)[0]
        most = 2000000  # read in several tenths of a second, by which the times are told
        points.write_bytes(
            struct.pack("<Q", count + most)
            + data[8:]
            + b"".join(
                struct.pack("<Qddd3sdQIIII", 10**6 + i, 0, 0, 0, b"", 1, 2, 1, 0, 2, 0)
                for i in range(most)
            )
        )
        result = self.plan(dense, *FAST, "--sample_seconds=2")
        self.assert_exit(result, 0)
        match = re.search(
            r"Time: about \d+ s, from ([\d.]+) s of .*; ([\d.]+) s of it to read", result.stdout
        )
        self.assertIsNotNone(match, result.stdout)
        sampled, reading = (float(value) for value in match.groups())
        self.assertLess(sampled, reading)

    def test_all_problems_are_named_at_once_with_the_code_of_the_first(self):
        dense = self.workspace()
        (dense / "stereo/patch-match.cfg").write_text("nobody.png\n__auto__, 3\n")
        result = self.plan(dense, "--Hpm.cpu_target=abacus")
        self.assert_exit(result, 2, "abacus")
        self.assert_exit(result, 2, "patch-match.cfg:1", "nobody.png")
        self.assertEqual(result.stderr.count("ERROR: "), 2)
        self.assertEqual(self.run_tool(dense, "--Hpm.cpu_target=abacus").returncode, 2)

    def test_an_image_that_would_fail_is_exit_4_as_of_the_run(self):
        dense = self.workspace()
        (dense / "images/view02.png").write_bytes(constant(72, 96, 77))
        result = self.plan(dense, *FAST)
        self.assert_exit(result, 4, "1 of 4 images would fail, the first: view02.png")
        self.assertEqual(self.run_tool(dense, *FAST).returncode, 4)

    def test_a_file_that_ends_too_early_is_found_before_the_run(self):
        dense = self.workspace()
        path = dense / "images/view02.png"
        path.write_bytes(path.read_bytes()[:-40])
        result = self.plan(dense, *FAST, "--sample_seconds=1")
        self.assert_exit(result, 4, "1 of 4 images would fail, the first: view02.png")
        self.assertIn("view02.png: the end of the file is missing", result.stderr)
        self.assertIn("Images: 3 to compute", result.stdout)
        self.assertIn("Time: ", result.stdout)
        self.assertEqual(map_files(dense), {})

    def test_files_that_options_name_do_not_hide_what_else_is_wrong(self):
        dense = self.workspace()
        masks = dense.parent / "masks"
        masks.mkdir()
        (masks / "view01.png.png").write_bytes(constant(10, 10, 255))
        ranges = dense.parent / "ranges"
        ranges.write_text("view01.png 3 2\n")
        (dense / "stereo/patch-match.cfg").write_text("view00.png\n__auto__, 3\nno.png\n__all__\nnobody.png\nview01.png\n")
        result = self.plan(dense, f"--Hpm.mask_path={masks}", f"--Hpm.depth_ranges={ranges}")
        self.assert_exit(result, 3, "with a mask of another size")
        self.assert_exit(result, 3, "ranges:1")
        self.assert_exit(result, 3, "patch-match.cfg:3: image 'no.png'", "likewise in lines 5")
        self.assertEqual(result.stderr.count("ERROR: "), 3)

    def test_a_run_at_work_and_a_missing_workspace_are_told(self):
        dense = self.workspace()
        process = self.start_tool(dense, "--Hpm.num_iterations=400")
        self.assert_exit(self.plan(dense, "--sample_seconds=0"), 7, "process")
        process.kill()
        self.assert_exit(self.plan(dense / "nowhere"), 3, "nowhere is no folder")


if __name__ == "__main__":
    unittest.main()
