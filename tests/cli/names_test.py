"""Names of images, and what stands under them: long ones, those of Windows, files
that are missing or stand in another case, configurations written by hand."""
import unittest

import sparse_patch
from support import FAST, CliTest, map_files


class Names(CliTest):
    def rename(self, workspace, new_name, new_file=None):
        """view01.png gets another name, in the model and the cfg, and its file follows."""
        sparse_patch.rename_image(workspace / "sparse/images.bin", 1, new_name.encode())
        for cfg in ("patch-match.cfg", "fusion.cfg"):
            path = workspace / "stereo" / cfg
            path.write_text(path.read_text().replace("view01.png", new_name), encoding="utf-8")
        path = workspace / "images" / (new_file or new_name)
        path.parent.mkdir(exist_ok=True)
        (workspace / "images/view01.png").rename(path)

    def test_names_as_long_as_colmap_can_write_are_computed_and_kept(self):
        workspace = self.workspace()
        name = "n" * 235 + ".png"
        self.rename(workspace, name)
        self.assert_exit(self.run_tool(workspace, *FAST, "--Hpm.previews=1"), 0)
        self.assert_no_partial_files(workspace)
        self.assert_complete(workspace)
        result = self.run_tool(workspace, *FAST, "--Hpm.previews=1")
        self.assert_exit(result, 0)
        self.assertIn("0 computed, 4 kept", result.stdout)

    def test_a_name_too_long_for_its_maps_is_refused_before_computing(self):
        workspace = self.workspace()
        self.rename(workspace, "n" * 236 + ".png")
        result = self.run_tool(workspace, *FAST)
        self.assert_exit(result, 3, "nnn", "too long")
        self.assertNotIn("Processing view", result.stdout)
        self.assertEqual(map_files(workspace), {})

    def test_backslashes_in_the_cfg_and_in_the_model_stand_for_slashes(self):
        workspace = self.workspace()
        self.rename(workspace, "cam\\view01.png", "cam/view01.png")
        cfg = workspace / "stereo/patch-match.cfg"
        cfg.write_text(cfg.read_text().replace("\\", "/"))
        result = self.run_tool(workspace, *FAST)
        self.assert_exit(result, 0)
        self.assert_complete(workspace, ["view00.png", "cam\\view01.png"])
        self.assertEqual(result.stderr.count("backslashes"), 1)


class Files(CliTest):
    def test_missing_files_are_told_in_one_line_for_all(self):
        workspace = self.workspace()
        for i in (1, 2):
            path = workspace / f"images/view0{i}.png"
            path.rename(path.with_suffix(".PNG"))
        result = self.run_tool(workspace, *FAST)
        self.assert_exit(result, 4, "2 of 4 images failed", "view01.png", "view02.png")
        lines = result.stderr.splitlines()
        self.assertEqual(len(lines), 2, result.stderr)
        for word in ("2 of 4", "view01.png", "'view01.PNG'", "case"):
            self.assertIn(word, lines[0])
        self.assert_complete(workspace, ["view00.png", "view03.png"])

    def test_a_missing_folder_of_images_is_exit_3_in_one_line(self):
        workspace = self.workspace()
        (workspace / "images").rename(workspace / "images_4")
        result = self.run_tool(workspace, *FAST)
        self.assert_exit(result, 3, "images is missing")
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)

    def test_a_numbered_model_is_hinted_at(self):
        workspace = self.workspace()
        (workspace / "sparse").rename(workspace / "0")
        (workspace / "sparse").mkdir()
        (workspace / "0").rename(workspace / "sparse/0")
        self.assert_exit(self.run_tool(workspace, *FAST), 3, "sparse/0", "up")

    def test_a_stale_fusion_cfg_is_told_and_written_anew_once_it_is_deleted(self):
        workspace = self.workspace()
        path = workspace / "stereo/fusion.cfg"
        path.write_text("old.png\n")
        result = self.run_tool(workspace, *FAST)
        self.assert_exit(result, 0)
        self.assertRegex(result.stderr, "fusion.cfg .*'old.png'.* delete it")
        path.unlink()
        result = self.run_tool(workspace, *FAST)
        self.assert_exit(result, 0)
        self.assertEqual(result.stderr, "")
        self.assertIn("4 kept", result.stdout)
        self.assertEqual(path.read_text().split(), [f"view0{i}.png" for i in range(4)])


if __name__ == "__main__":
    unittest.main()
