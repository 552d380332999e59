"""Maps do not depend on where a model lies and on its unit of length."""
import unittest

import sparse_patch
from support import FAST, CliTest, read_map

IMAGE = "view01.png"


class Frames(CliTest):
    def depths(self, scale=1, shift=(0, 0, 0)):
        """Of one image, in units of the scene, and the warnings."""
        workspace = self.workspace(width=64, height=48)
        sparse_patch.transform_model(workspace / "sparse", scale, shift)
        result = self.run_tool(workspace, *FAST)
        self.assert_exit(result, 0)
        values = read_map(workspace / f"stereo/depth_maps/{IMAGE}.geometric.bin")[3]
        return [v / scale for v in values], result.stderr

    def assert_alike(self, depths, expected):
        seen = [k for k, value in enumerate(expected) if value > 0]
        self.assertGreater(len(seen), len(expected) / 2)
        alike = [k for k in seen if abs(depths[k] / expected[k] - 1) < 0.02]
        self.assertGreater(len(alike), 0.95 * len(seen))

    def test_geo_referenced_models_give_the_same_maps_and_one_warning(self):
        expected, warnings = self.depths()
        self.assertNotIn("origin", warnings)
        # UTM and earth-centred coordinates.
        for shift in ((534000, 3378500, 120), (2511673.6, 1438633.7, 5664733.7)):
            with self.subTest(shift):
                depths, warnings = self.depths(shift=shift)
                self.assert_alike(depths, expected)
                self.assertEqual(warnings.count("model_aligner"), 1, warnings)

    def test_any_unit_of_length_will_do(self):
        expected, _ = self.depths()
        for scale in (1e-6, 1e-3, 1e4, 1e7):
            with self.subTest(scale):
                self.assert_alike(self.depths(scale)[0], expected)


if __name__ == "__main__":
    unittest.main()
