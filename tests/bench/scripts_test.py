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

    def test_large_images(self):
        table = output_of(sys.executable, BENCH / "large_images.py", "--hpm_mvs", HPM_MVS,
                          "--make_scene", os.environ["HPM_MAKE_SCENE"], "--width", 64, "--height", 48,
                          "--sources", 3, "--rounds", 1, "--folder", self.scene.parent.parent,
                          "--out", self.out)
        self.assertRegex(table.splitlines()[-1], r"photometric \| \d+ \| [0-9.]+ \| \d+ \|")
        self.assertIn("photometric", json.loads(self.out.read_text())["runs"][HPM_MVS][0])

    def test_gate_fails_for_what_falls_by_more_than_its_noise(self):
        sys.path.insert(0, str(BENCH))
        import gate

        def records(f1, spread=0.0):
            part = {share: 50.0 for share in ("0.5%", "1%", "2%", "5%")}
            return [{"scene": scene, "seed": seed, "thresholds": [0.1], "finest_share": "0.5%",
                     **{name: part for name in ("all", "low_texture", "rest", "edges")},
                     "f1": [f1[scene] + spread * seed], "accuracy": [90.0], "completeness": [60.0]}
                    for scene in f1 for seed in range(3)]

        accepted = records({"a": 50.0, "b": 60.0})
        _, failures = gate.judge(records({"a": 50.0, "b": 60.0}), accepted)
        self.assertEqual(failures, [])
        lines, failures = gate.judge(records({"a": 53.0, "b": 58.0}), accepted)
        self.assertEqual(failures, ["b: f1 -2.0 ± 0.3"])
        self.assertIn("| f1 | +0.50 ± 0.21 | +3.0 ± 0.3 | -2.0 ± 0.3 |", lines)
        _, failures = gate.judge(records({"a": 50.0, "b": 56.0}, spread=2.0), accepted)
        self.assertEqual(failures, [])  # the seeds lie further apart than that
        _, failures = gate.judge(records({"a": 49.75, "b": 59.75, "c": 10.0}), accepted)
        self.assertEqual(failures, ["mean over scenes: f1 -0.25 ± 0.21"])

        now = records({"a": 50.0, "b": 60.0})
        self.assertEqual(gate.falling_figures(now, accepted), [])
        now[0]["edges"] = dict(now[0]["edges"], **{"0.5%": 51.5, "1%": 48.0})
        self.assertEqual(gate.falling_figures(now, accepted), [])  # the seeds lie further apart
        for record in now[:3]:
            record["edges"] = dict(record["edges"], **{"0.5%": 51.0, "1%": 49.0})
        self.assertEqual(gate.falling_figures(now, accepted), ["a: edges 1% -1.0 ± 0.3"])

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
