"""--Hpm.confidence: maps beside the final ones, which stay as they are."""
import json
import shutil
import subprocess
import unittest

from support import FAST, HPM_MVS, CliTest, map_files, read_map

STAGE = "geometric"


class Confidence(CliTest):
    def setUp(self):
        self.dense = self.workspace()
        self.folder = self.dense / "stereo/confidence_maps"

    def run_with(self, *options):
        self.assert_exit(self.run_tool(self.dense, *FAST, *options), 0)

    def path(self, name):
        return self.folder / f"{name}.{STAGE}.bin"

    def names(self):
        return sorted(path.name for path in (self.dense / "images").iterdir())

    def run_other(self, name, *options):
        return subprocess.run(
            [HPM_MVS, name, "--workspace_path", str(self.dense), *options],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=120,
        )

    def test_they_say_something_of_exactly_the_pixels_with_a_depth(self):
        self.run_with("--Hpm.confidence=1")
        for name in self.names():
            width, height, channels, confidence = read_map(self.path(name))
            depth = read_map(self.dense / f"stereo/depth_maps/{name}.{STAGE}.bin")
            self.assertEqual((width, height, channels), depth[:3])
            for value, z in zip(confidence, depth[3]):
                self.assertEqual(value > 0, z > 0)
                self.assertLessEqual(value, 1)
            self.assertGreater(len(set(confidence)), 3)
        self.assertEqual(len(list(self.folder.rglob("*.bin"))), len(self.names()))

    def test_the_maps_stay_the_same(self):
        for options in ([], ["--PatchMatchStereo.filter=0"]):
            other = self.dense.parent / "other"
            shutil.copytree(self.dense, other)
            self.assert_exit(self.run_tool(other, *FAST, *options), 0)
            shutil.rmtree(self.dense / "stereo/hpm_mvs", ignore_errors=True)
            self.run_with("--Hpm.confidence=1", *options)
            self.assert_same_maps(map_files(self.dense), map_files(other))
            shutil.rmtree(other)

    def test_a_workspace_without_them_gets_them(self):
        self.run_with()
        self.assertFalse(self.folder.exists())
        before = map_files(self.dense)
        self.run_with("--Hpm.confidence=1")
        self.assertEqual(len(list(self.folder.rglob("*.bin"))), len(self.names()))
        self.assert_same_maps(map_files(self.dense), before)
        again = self.run_tool(self.dense, *FAST, "--Hpm.confidence=1")
        self.assertNotIn("Processing view", again.stdout)

    def test_none_is_left_beside_newer_maps(self):
        self.run_with("--Hpm.confidence=1")
        self.run_with("--random_seed=7")
        self.assertEqual(list(self.folder.rglob("*.bin")), [])

    def test_a_damaged_one_is_found_and_made_again(self):
        self.run_with("--Hpm.confidence=1")
        good = self.path("view01.png").read_bytes()
        self.path("view01.png").write_bytes(good[:-4] + b"\0\0\0\x40")  # 2
        result = self.run_other("check", *FAST, "--Hpm.confidence=1", "--fix=1")
        self.assertIn("confidence_maps/view01.png", result.stdout)
        self.assertFalse(self.path("view01.png").exists())
        self.run_with("--Hpm.confidence=1")
        self.assertEqual(self.path("view01.png").read_bytes(), good)

    def test_export_and_report_show_them(self):
        self.run_with("--Hpm.confidence=1")
        self.assert_exit(self.run_other("export", "--format=npy"), 0)
        exported = self.dense / "stereo/export/view01.png.confidence.npy"
        self.assertEqual(
            exported.read_bytes()[-4 * 96 * 72 :],
            self.path("view01.png").read_bytes()[-4 * 96 * 72 :],
        )
        meaning = json.loads((self.dense / "stereo/export/view01.png.json").read_text())
        self.assertIn("1 %", meaning["confidence"])
        page = (self.dense / "stereo/report.html").read_text()
        self.assertIn(">confidence</th>", page)

    def test_a_damaged_one_does_not_hide_the_depth_from_the_report(self):
        self.run_with("--Hpm.confidence=1")
        for name in self.names():
            self.path(name).write_bytes(b"96&72&1&")
        self.assert_exit(self.run_other("report", *FAST), 0)
        self.assertNotIn("no maps", (self.dense / "stereo/report.html").read_text())


if __name__ == "__main__":
    unittest.main()
