"""bench/resize_scene.py: what is known of a scene holds at the new size."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import numpy as np
    import pycolmap
except ImportError as error:
    print(f"skipped: {error}; run scripts/install_pycolmap.sh")
    sys.exit(77)

from support import HPM_MAKE_SCENE

BENCH = pathlib.Path(__file__).resolve().parents[2] / "bench"
sys.path.insert(0, str(BENCH))
from map_files import read_map

WIDTH, HEIGHT = 64, 48


class ResizeScene(unittest.TestCase):
    def test_truth_model_and_pictures_agree(self):
        for width, height in ((128, 96), (32, 24)):
            with tempfile.TemporaryDirectory(prefix="hpm_resize_test_") as folder:
                scene, out = pathlib.Path(folder) / "scene", pathlib.Path(folder) / "out"
                subprocess.run([HPM_MAKE_SCENE, "tilted_plane", scene, "--views", "2",
                                "--width", str(WIDTH), "--height", str(HEIGHT)], check=True)
                subprocess.run([sys.executable, BENCH / "resize_scene.py", scene, out,
                                "--width", str(width)], check=True)
                model = pycolmap.Reconstruction(out / "sparse")
                self.assertEqual((out / "stereo/fusion.cfg").read_text(), (scene / "stereo/fusion.cfg").read_text())
                for image in model.images.values():
                    picture = pycolmap.Bitmap.read(str(out / "images" / image.name), True)
                    self.assertEqual((picture.width, picture.height), (width, height))
                    self.check_depths(image, model, read_map(out / f"gt/depth_maps/{image.name}.bin")[0])

    def check_depths(self, image, model, depth):
        """Of the points that the image sees: the plane is tilted, so a shift would tell."""
        camera = model.cameras[image.camera_id]
        self.assertEqual(depth.shape, (camera.height, camera.width))
        errors = []
        for seen in image.points2D:
            if not seen.has_point3D():
                continue
            x, y, z = image.cam_from_world() * model.points3D[seen.point3D_id].xyz
            fx, fy, cx, cy = camera.params
            col, row = int(fx * x / z + cx), int(fy * y / z + cy)
            self.assertLess(abs(seen.xy[0] - (fx * x / z + cx)), 0.01)
            errors.append(abs(depth[row, col] / z - 1))
        self.assertGreater(len(errors), 10)
        self.assertLess(np.median(errors), 0.5 / camera.width)


if __name__ == "__main__":
    unittest.main()
