#!/usr/bin/env python3
"""The default is as good as it was on the scenes of data/: no figure of a scene falls by
more than its noise over seeds, their mean not by more than half a point.

After a change that the suite accepts (docs/benchmarks.md), make the expectation anew:

    bench/suite.py --build build/release --scenes data --methods hpm_plus --out suite.json
    tests/bench/quality_test.py suite.json
"""
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import unittest

HPM_MVS = pathlib.Path(os.environ.get("HPM_MVS", ""))
ROOT = pathlib.Path(__file__).resolve().parents[2]
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


def expect(path):
    """Mean and noise of every figure: three standard deviations, a point at least, since
    SIMD targets round differently."""
    expected = {}
    records = json.loads(pathlib.Path(path).read_text())["records"]
    for scene in sorted({r["scene"] for r in records}):
        rows = [suite.metrics_of(r) for r in records if r["scene"] == scene]
        expected[scene] = {
            name: [round(statistics.fmean(row[name] for row in rows), 2),
                   round(max(1.0, 3 * statistics.stdev(row[name] for row in rows)), 2)]
            for name in rows[0]
        }
    EXPECTED.write_text(json.dumps(expected, indent=1) + "\n")


if __name__ == "__main__":
    if len(sys.argv) == 2 and sys.argv[1].endswith(".json"):
        expect(sys.argv[1])
    else:
        unittest.main()
