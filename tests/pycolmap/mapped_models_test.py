"""Models as hloc and GLOMAP leave them: pycolmap maps known matches incrementally and globally,
undistorts, and fuses the maps that hpm_mvs makes in between."""
import itertools
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

from support import HPM_MAKE_SCENE, HPM_MVS, read_map

FOLDER = "mapping"  # hloc's folder of the images that are mapped
VIEWS, WIDTH, HEIGHT = 5, 160, 120


def database_of_hloc(scene, path):
    """What hloc makes before it maps: images imported, keypoints and matches written by itself
    (here those of the scene's model), matches verified by pycolmap."""
    open_database(path).close()
    model = pycolmap.Reconstruction(scene / "sparse")
    camera = next(iter(model.cameras.values()))
    options = pycolmap.ImageReaderOptions()
    options.camera_model = camera.model.name if hasattr(camera.model, "name") else "PINHOLE"
    options.camera_params = ",".join(map(str, camera.params))
    pycolmap.import_images(path, scene / "images", pycolmap.CameraMode.SINGLE, options=options)
    database = open_database(path)
    ids = {image.name: image.image_id for image in database.read_all_images()}
    seen = {}
    for image in model.images.values():
        points = [p for p in image.points2D if p.has_point3D()]
        name = f"{FOLDER}/{image.name}"
        seen[name] = {p.point3D_id: i for i, p in enumerate(points)}
        database.write_keypoints(ids[name], np.array([p.xy for p in points], np.float32))
    pairs = list(itertools.combinations(sorted(seen), 2))
    for a, b in pairs:
        both = sorted(set(seen[a]) & set(seen[b]))
        matches = np.array([(seen[a][point], seen[b][point]) for point in both], np.uint32)
        database.write_matches(ids[a], ids[b], matches)
    database.close()
    listed = path.parent / "pairs.txt"
    listed.write_text("".join(f"{a} {b}\n" for a, b in pairs))
    pycolmap.verify_matches(path, listed)


def open_database(path):
    try:
        return pycolmap.Database.open(path)
    except TypeError:  # before 3.13
        return pycolmap.Database(str(path))


def fuse(cloud, dense):
    try:
        pycolmap.stereo_fusion(cloud, dense, output_type="ply")
    except TypeError:  # before 4.0, where it makes nothing but PLY
        pycolmap.stereo_fusion(cloud, dense)


class MappedModelsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        print(f"pycolmap {pycolmap.__version__}", file=sys.stderr)
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.scene = cls.folder / "scene"
        size = ["--views", str(VIEWS), "--width", str(WIDTH), "--height", str(HEIGHT)]
        subprocess.run([HPM_MAKE_SCENE, "depth_step", cls.scene, *size], check=True)
        below = cls.scene / "images" / FOLDER
        below.mkdir()
        for image in (cls.scene / "images").glob("*.png"):
            image.rename(below / image.name)
        cls.database = cls.folder / "database.db"
        database_of_hloc(cls.scene, cls.database)

    def check(self, mapper):
        """Maps, undistorts, computes and fuses; the depths must be those of the model's points."""
        work = self.folder / mapper.__name__
        (work / "models").mkdir(parents=True)
        models = mapper(self.database, self.scene / "images", work / "models")
        self.assertEqual(len(models), 1)
        self.assertEqual(models[0].num_reg_images(), VIEWS)
        dense = work / "dense"
        pycolmap.undistort_images(dense, work / "models/0", self.scene / "images")
        with_frames = (dense / "sparse/frames.bin").exists()
        self.assertEqual(with_frames, hasattr(pycolmap, "Rig"))
        result = subprocess.run(
            [HPM_MVS, "patch_match_stereo", "--workspace_path", dense],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=400,
        )
        self.assertEqual(result.returncode, 0, result.stdout)
        model = pycolmap.Reconstruction(dense / "sparse")
        errors = []
        for image in model.images.values():
            pose = image.cam_from_world
            pose = pose() if callable(pose) else pose
            path = dense / f"stereo/depth_maps/{image.name}.geometric.bin"
            width, height, _, values = read_map(path)
            depths = np.array(values).reshape(height, width)
            for point in image.points2D:
                if not point.has_point3D():
                    continue
                col, row = (int(c) for c in point.xy)
                if not (0 <= col < width and 0 <= row < height) or depths[row, col] <= 0:
                    continue
                depth = (pose * model.points3D[point.point3D_id].xyz)[2]
                errors.append(abs(depths[row, col] / depth - 1))
        self.assertGreater(len(errors), 200)
        self.assertLess(np.median(errors), 0.01)
        fused = dense / "fused.ply"
        fuse(fused, dense)
        header = fused.read_bytes().split(b"end_header")[0]
        points = int(header.split(b"element vertex ")[1].split()[0])
        self.assertGreater(points, 2000)

    def test_a_model_mapped_incrementally_as_by_hloc(self):
        self.check(pycolmap.incremental_mapping)

    def test_a_model_mapped_globally_by_glomap(self):
        mapper = getattr(pycolmap, "global_mapping", None)
        if mapper is None:
            self.skipTest(f"pycolmap {pycolmap.__version__} has no global mapper")
        self.check(mapper)


if __name__ == "__main__":
    unittest.main()
