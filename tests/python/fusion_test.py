"""A script of pycolmap alone, with our stereo in it: its fusion finds the plane."""
import sys
import unittest

import numpy as np

import hpm_mvs
from support import CliTest

try:
    import pycolmap
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(0)

# tests/scenes: the plane through the origin with this normal, toward the cameras.
NORMAL = np.array([0.3, -0.4, -1.0]) / np.linalg.norm([0.3, -0.4, -1.0])


class Fusion(CliTest):
    def test_gives_the_plane(self):
        dense = self.workspace(views=6, width=160, height=120)
        options = pycolmap.PatchMatchOptions()
        options.num_threads = 2
        hpm_mvs.patch_match_stereo(dense, options=options)
        cloud = pycolmap.stereo_fusion(dense / "fused.ply", dense, output_type="ply")
        points = np.array([point.xyz for point in cloud.points3D.values()])
        self.assertGreater(len(points), 3000)
        distance = np.abs(points @ NORMAL)
        self.assertLess(np.median(distance), 0.01)
        self.assertLess(np.quantile(distance, 0.95), 0.05)


if __name__ == "__main__":
    unittest.main()
