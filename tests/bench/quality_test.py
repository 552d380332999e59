"""The default is as good as it was on the scenes of data/: no figure of a scene falls by
more than its noise over seeds, their mean not by more than half a point."""
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import unittest

HPM_MVS = pathlib.Path(os.environ["HPM_MVS"])
ROOT = pathlib.Path(os.environ["HPM_ROOT"])
EXPECTED = pathlib.Path(__file__).with_name("quality_expected.json")

sys.path.insert(0, str(ROOT / "bench"))
import suite  # noqa: E402


class QualityTest(unittest.TestCase):
    def test_no_scene_has_become_worse(self):
        with tempfile.TemporaryDirectory(prefix="hpm_quality_") as folder:
            out = pathlib.Path(folder) / "suite.json"
            subprocess.run(
                [sys.executable, ROOT / "bench/suite.py", "--build", HPM_MVS.parents[2],
                 "--scenes", ROOT / "data", "--methods", "hpm_plus", "--seeds", "1", "--out", out],
                check=True, stdout=subprocess.DEVNULL,
            )
            records = json.loads(out.read_text())["records"]
        expected = json.loads(EXPECTED.read_text())
        self.assertEqual({r["scene"] for r in records}, set(expected))
        for record in records:
            scene = record["scene"]
            gains = []
            for name, value in suite.metrics_of(record).items():
                mean, noise = expected[scene][name]
                gains.append(value - mean)
                self.assertGreater(value, mean - noise, f"{scene}: {name}")
            print(f"{scene}: {statistics.fmean(gains):+.2f} in the mean")
            self.assertGreater(statistics.fmean(gains), -0.5, scene)


if __name__ == "__main__":
    unittest.main()
