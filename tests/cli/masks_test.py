"""Masks: what they cover is neither estimated nor matched, and nothing else changes."""
import unittest

from png import constant, png
from support import FAST, CliTest, map_files, read_map

WIDTH, HEIGHT = 96, 72
NAMES = [f"view0{i}.png" for i in range(4)]
LEFT_HALF = png(WIDTH, HEIGHT, (b"\0" * 48 + b"\xff" * 48) * HEIGHT)
WHITE = constant(WIDTH, HEIGHT, 255)


class Masks(CliTest):
    def setUp(self):
        self.dense = self.workspace()
        self.masks = self.dense.parent / "masks"
        self.options = [*FAST, f"--Hpm.mask_path={self.masks}"]
        self.masks.mkdir()

    def write_masks(self, masks):
        for name, data in masks.items():
            path = self.masks / f"{name}.png"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)

    def share_of_depths(self, name, stage="geometric"):
        """Of the left and of the right half of the image."""
        depth = read_map(self.dense / "stereo/depth_maps" / f"{name}.{stage}.bin")[3]
        half = WIDTH * HEIGHT / 2
        left = sum(depth[i] > 0 for i in range(len(depth)) if i % WIDTH < WIDTH / 2)
        return left / half, (sum(d > 0 for d in depth) - left) / half

    def test_white_masks_change_no_byte(self):
        self.assert_exit(self.run_tool(self.dense, *FAST), 0)
        without = map_files(self.dense)
        self.write_masks(dict.fromkeys(NAMES, WHITE))
        result = self.run_tool(self.dense, *self.options, "--Hpm.overwrite=1")
        self.assert_exit(result, 0)
        self.assertIn("Masks: 4 of 4 images", result.stdout)
        self.assert_same_maps(map_files(self.dense), without)

    def test_masked_pixels_get_no_depth_in_any_map_and_others_do(self):
        self.write_masks({"view00.png": LEFT_HALF, **dict.fromkeys(NAMES[1:], WHITE)})
        self.assert_exit(self.run_tool(self.dense, *self.options), 0)
        self.assert_complete(self.dense)
        for stage in ("photometric", "geometric"):
            left, right = self.share_of_depths("view00.png", stage)
            self.assertEqual(left, 0, stage)
            self.assertGreater(right, 0.6, stage)
            self.assertGreater(min(self.share_of_depths("view01.png", stage)), 0.5, stage)

    def test_masked_pixels_confirm_nothing_as_sources(self):
        nothing = constant(WIDTH, HEIGHT, 0)
        self.write_masks({"view00.png": WHITE, **dict.fromkeys(NAMES[1:], nothing)})
        result = self.run_tool(self.dense, *self.options)
        self.assert_exit(result, 0)
        self.assertRegex(result.stderr, "3 of 4 images have a depth at less than 1 % of their pixels, the first: view01.png")
        for name in NAMES:
            self.assertEqual(self.share_of_depths(name), (0, 0), name)

    def test_masks_are_scaled_with_their_images(self):
        self.write_masks(dict.fromkeys(NAMES, LEFT_HALF))
        result = self.run_tool(self.dense, *self.options, "--PatchMatchStereo.max_image_size=48")
        self.assert_exit(result, 0)
        width, _, _, depth = read_map(
            self.dense / "stereo/depth_maps/view00.png.geometric.bin"
        )
        self.assertEqual(width, 48)
        self.assertFalse(any(d for i, d in enumerate(depth) if i % 48 < 24))
        self.assertTrue(any(depth))

    def test_another_mask_makes_its_maps_anew_and_the_same_keeps_them(self):
        self.write_masks({"view00.png": LEFT_HALF, **dict.fromkeys(NAMES[1:], WHITE)})
        self.assert_exit(self.run_tool(self.dense, *self.options), 0)
        result = self.run_tool(self.dense, *self.options)
        self.assertIn("4 kept", result.stdout)
        self.write_masks({"view00.png": WHITE})
        result = self.run_tool(self.dense, *self.options)
        self.assert_exit(result, 0)
        self.assertNotIn("4 kept", result.stdout)
        self.assertGreater(self.share_of_depths("view00.png")[0], 0.5)

    def test_masks_that_do_not_fit_are_exit_3_before_computing(self):
        self.write_masks({"view01.png": constant(48, 36, 255), "view02.png": constant(9, 9, 0)})
        result = self.run_tool(self.dense, *self.options)
        self.assert_exit(
            result, 3, "--Hpm.mask_path", "2 of 4 images", "view01.png.png is 48x36",
            "its image 96x72", "undistorted",
        )
        self.write_masks({"view01.png": b"no image", "view02.png": WHITE})
        self.assert_exit(self.run_tool(self.dense, *self.options), 3, "view01.png.png")
        self.assertEqual(map_files(self.dense), {})

    def test_no_mask_at_all_is_exit_3_and_some_missing_a_warning(self):
        self.write_masks({"view09.png": WHITE})
        self.assert_exit(self.run_tool(self.dense, *self.options), 3, "a/b.jpg.png")
        self.write_masks({"view02.png": WHITE})
        result = self.run_tool(self.dense, *self.options)
        self.assert_exit(result, 0)
        self.assertIn("3 of 4 images without a mask are used whole, the first: view00.png", result.stderr)


if __name__ == "__main__":
    unittest.main()
