"""The benchmarks that need nothing but hpm_mvs run to their end and report."""
import importlib.util
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

HPM_MVS = os.environ["HPM_MVS"]
BENCH = pathlib.Path(os.environ["HPM_BENCH"])


def output_of(*command):
    return subprocess.run(
        [str(word) for word in command], check=True, capture_output=True, text=True
    ).stdout


class ScriptsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="hpm_bench_test_")
        cls.out = pathlib.Path(cls.folder.name) / "out.json"
        cls.scene = pathlib.Path(cls.folder.name) / "scenes/scene"
        cls.scene.parent.mkdir()
        output_of(os.environ["HPM_MAKE_SCENE"], "tilted_plane", cls.scene,
                  "--views", 4, "--width", 64, "--height", 48)

    def setUp(self):
        self.out.unlink(missing_ok=True)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_phases(self):
        table = output_of(sys.executable, BENCH / "phases.py", "--hpm_mvs", HPM_MVS,
                          "--scene", self.scene, "--threads", 1, 2, "--out", self.out)
        self.assertIn("times faster with 2 threads", table)
        costs = json.loads(self.out.read_text())["runs"]["2"]
        self.assertAlmostEqual(
            sum(costs["costs_per_pixel_per_stage"].values()), costs["costs_per_pixel"], 3
        )

    def test_memory(self):
        table = output_of(sys.executable, BENCH / "memory.py", "--hpm_mvs", HPM_MVS,
                          "--scene", self.scene, "--sizes", 64, "--images", 1)
        row = table.splitlines()[-1].split("|")
        self.assertEqual([cell.strip() for cell in row[1:4]], ["64x48", "3", "1"])
        self.assertGreater(int(row[4]), 10)

    def test_eta(self):
        table = output_of(sys.executable, BENCH / "eta.py", "--hpm_mvs", HPM_MVS, "--scene", self.scene,
                          "--out", self.out, "--", "--Hpm.num_iterations", 20)
        for clock in ("the clock", "CPU time"):
            self.assertRegex(table, f"by {clock}: [0-9.]+ % of the run")
        record = json.loads(self.out.read_text())
        self.assertEqual(record["progress"][-1]["fraction"], 1)
        self.assertEqual(output_of(sys.executable, BENCH / "eta.py", "--only_report", self.out), table)

    @unittest.skipIf(importlib.util.find_spec("numpy") is None, "no numpy")
    def test_report_size(self):
        line = output_of(sys.executable, BENCH / "report_size.py", "--hpm_mvs", HPM_MVS,
                         "--images", 25, "--size", 64, 48, "--points", 1000)
        self.assertRegex(line, r"exit 0, 25 images of 64x48: .* page 0\.[1-9] MB")

    def suite(self, *arguments):
        return subprocess.run(
            [sys.executable, BENCH / "suite.py", "--build", pathlib.Path(HPM_MVS).parents[2],
             "--scenes", self.scene.parent, "--names", "scene", "--out", self.out, *arguments],
            capture_output=True, text=True,
        )

    def test_suite_tells_methods_apart(self):
        ended = self.suite("--methods", "nesp,acmh", "--seeds", "2", "--reference", "acmh")
        self.assertEqual(ended.returncode, 0, ended.stderr)
        self.assertRegex(ended.stdout, r"(?m)^\| scene \| nesp \|")
        self.assertRegex(ended.stdout, r"(?m)^\| nesp \|.* of \d+ \|")
        records = json.loads(self.out.read_text())["records"]
        self.assertEqual(len(records), 4)
        # What is there is not run again.
        self.assertNotIn("done", self.suite("--methods", "nesp", "--seeds", "2").stderr)

    def test_suite_says_what_went_wrong(self):
        ended = self.suite("--methods", "nonsense")
        self.assertEqual(ended.returncode, 1)
        self.assertIn("'nonsense' is not allowed", ended.stderr)
        self.assertNotIn("Traceback", ended.stderr)

    def test_match_cost_speed(self):
        output_of(os.environ["HPM_MATCH_COST_SPEED"], "--rounds", 1, "--width", 64,
                  "--height", 48, "--srcs", 2, "--json", self.out)
        self.assertIn("scalar", self.out.read_text())


if __name__ == "__main__":
    unittest.main()
