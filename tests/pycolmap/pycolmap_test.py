"""Newer COLMAP takes our maps: pycolmap reads the workspace, fuses and meshes it."""
import os
import pathlib
import shutil
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

import sparse_patch
from support import FAST, HPM_MAKE_SCENE, HPM_MVS

README = pathlib.Path(__file__).resolve().parents[2] / "README.md"

# tests/scenes: the plane through the origin with this normal, toward the cameras.
NORMAL = np.array([0.3, -0.4, -1.0]) / np.linalg.norm([0.3, -0.4, -1.0])
# The cameras are 5 units away; a pixel is 0.026 units wide there.


def read_ply(path):
    """Vertices as a structured array, number of faces; binary little-endian only."""
    data = path.read_bytes()
    header, body = data.split(b"end_header\n", 1)
    kinds = {b"float": "<f4", b"uchar": "u1", b"double": "<f8", b"int": "<i4"}
    fields, count, faces, element = [], 0, 0, None
    for line in header.split(b"\n"):
        words = line.split()
        if words[:1] == [b"element"]:
            element = words[1]
            if element == b"vertex":
                count = int(words[2])
            else:
                faces = int(words[2])
        elif words[:1] == [b"property"] and element == b"vertex":
            fields.append((words[2].decode(), kinds[words[1]]))
    return np.frombuffer(body, dtype=fields, count=count), faces


def positions(vertices):
    return np.stack([vertices[axis] for axis in "xyz"], axis=1).astype(np.float64)


def meshing_works(folder):
    """Whether this pycolmap meshes a sphere that is nothing of ours; the wheels 4.1.1 and 4.2.0
    make NaN of it."""
    normals = np.random.default_rng(0).normal(size=(5000, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    fields = [(name, "<f4") for name in ("x", "y", "z", "nx", "ny", "nz")]
    fields += [(name, "u1") for name in ("red", "green", "blue")]
    points = np.zeros(len(normals), fields)
    for i, axis in enumerate("xyz"):
        points[axis] = points["n" + axis] = normals[:, i]
    kinds = {"<f4": "float", "u1": "uchar"}
    properties = "".join(f"property {kinds[kind]} {name}\n" for name, kind in fields)
    header = f"element vertex {len(points)}\n{properties}end_header\n"
    header = "ply\nformat binary_little_endian 1.0\n" + header
    cloud, mesh = folder / "sphere.ply", folder / "sphere-mesh.ply"
    cloud.write_bytes(header.encode() + points.tobytes())
    pycolmap.poisson_meshing(cloud, mesh, meshing_options())
    radii = np.linalg.norm(positions(read_ply(mesh)[0]), axis=1)
    return bool((np.abs(radii - 1) < 0.1).all())


def meshing_options():
    options = pycolmap.PoissonMeshingOptions()
    options.depth, options.trim, options.num_threads = 7, 3, 1
    return options


class PycolmapTest(unittest.TestCase):
    """All tests read one workspace, made by the recipe of the README."""

    @classmethod
    def setUpClass(cls):
        print(f"pycolmap {pycolmap.__version__}", file=sys.stderr)
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.dense = pathlib.Path(cls.folder.name) / "dense"
        size = ["--views", "6", "--width", "160", "--height", "120"]
        subprocess.run([HPM_MAKE_SCENE, "tilted_plane", cls.dense, *size], check=True)
        # As it stands in the README, with hpm_mvs on PATH.
        cls.recipe = README.read_text().split("```python\n", 1)[1].split("```", 1)[0]
        environment = dict(os.environ)
        environment["PATH"] = f"{pathlib.Path(HPM_MVS).parent}:{environment['PATH']}"
        cls.result = subprocess.run(
            [sys.executable, "-c", cls.recipe], cwd=cls.folder.name, env=environment,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=400,
        )

    def setUp(self):
        self.assertEqual(self.result.returncode, 0, self.result.stdout)

    def test_the_recipe_of_the_readme_has_three_lines(self):
        self.assertEqual(len([l for l in self.recipe.splitlines() if l.strip()]), 3)

    def test_reads_our_maps_as_we_wrote_them(self):
        if not hasattr(pycolmap, "DepthMap"):
            self.skipTest(f"pycolmap {pycolmap.__version__} has no reader of maps")
        name = "view00.png.geometric.bin"
        depth_map, normal_map = pycolmap.DepthMap(), pycolmap.NormalMap()
        depth_map.read(self.dense / "stereo/depth_maps" / name)
        normal_map.read(self.dense / "stereo/normal_maps" / name)
        depth = np.asarray(depth_map.to_array())
        self.assertEqual(depth.shape[:2], (120, 160))
        valid = depth.reshape(120, 160) > 0
        # to_array() says (H, W, 3), but copies COLMAP's three planes as they lie in memory.
        planes = np.asarray(normal_map.to_array()).reshape(3, 120, 160)
        normal = np.moveaxis(planes, 0, -1)
        self.assertGreater(valid.mean(), 0.5)
        np.testing.assert_allclose(np.linalg.norm(normal[valid], axis=-1), 1, atol=1e-4)
        self.assertTrue((normal[~valid] == 0).all())

    def test_reads_the_model_beside_them(self):
        model = pycolmap.Reconstruction(self.dense / "sparse")
        self.assertEqual(model.num_reg_images(), 6)

    def test_fusion_gives_the_plane(self):
        vertices, _ = read_ply(self.dense / "fused.ply")
        self.assertGreater(len(vertices), 3000)
        distance = np.abs(positions(vertices) @ NORMAL)
        self.assertLess(np.median(distance), 0.01)
        self.assertLess(np.quantile(distance, 0.95), 0.05)
        normals = np.stack([vertices[axis] for axis in ("nx", "ny", "nz")], axis=1)
        slopes = normals @ NORMAL
        self.assertGreater(slopes.min(), 0, "a normal points away from the cameras")
        self.assertGreater(np.median(slopes), 0.98)

    def test_poisson_meshing_gives_the_plane(self):
        if not meshing_works(self.dense):
            self.skipTest(f"Poisson meshing of pycolmap {pycolmap.__version__} is broken by itself")
        mesh = self.dense / "meshed-poisson.ply"
        pycolmap.poisson_meshing(self.dense / "fused.ply", mesh, meshing_options())
        vertices, faces = read_ply(mesh)
        self.assertGreater(faces, 1000)
        self.assertLess(np.median(np.abs(positions(vertices) @ NORMAL)), 0.02)

    def test_delaunay_meshing_gives_the_plane(self):
        meshing = getattr(pycolmap, "dense_delaunay_meshing", None)
        if meshing is None:
            self.skipTest(f"the wheel of pycolmap {pycolmap.__version__} has no Delaunay meshing")
        mesh = self.dense / "meshed-delaunay.ply"
        meshing(self.dense, mesh)
        vertices, faces = read_ply(mesh)
        self.assertGreater(faces, 100)
        self.assertLess(np.median(np.abs(positions(vertices) @ NORMAL)), 0.02)


def write_as_rig(sparse, binary):
    """All cameras of the model become one rig, their images its one frame; the poses in the
    images file become stale. pycolmap writes the rig, and still knows the poses."""
    model = pycolmap.Reconstruction(sparse)
    kind = pycolmap.SensorType.CAMERA
    images = [model.images[i] for i in sorted(model.images)]
    poses = {image.name: image.cam_from_world() for image in images}
    rig_from_world = poses[images[0].name]
    rig, frame = pycolmap.Rig(rig_id=1), pycolmap.Frame(frame_id=1, rig_id=1)
    for image in images:
        sensor = pycolmap.sensor_t(kind, image.camera_id)
        frame.add_data_id(pycolmap.data_t(sensor, image.image_id))
        if image is images[0]:
            rig.add_ref_sensor(sensor)
        else:
            rig.add_sensor(sensor, poses[image.name] * rig_from_world.inverse())
    frame.rig_from_world = rig_from_world
    rigged = pycolmap.Reconstruction()
    for camera in model.cameras.values():
        rigged.add_camera(camera)
    rigged.add_rig(rig)
    rigged.add_frame(frame)
    for image in images:
        rigged.add_image(pycolmap.Image(
            name=image.name, camera_id=image.camera_id, image_id=image.image_id, frame_id=1,
            points2D=pycolmap.Point2DList([pycolmap.Point2D(p.xy) for p in image.points2D]),
        ))
    rigged.register_frame(1)
    for point in model.points3D.values():
        rigged.add_point3D(point.xyz, point.track, point.color)
    for path in sparse.iterdir():
        path.unlink()
    if binary:
        rigged.write_binary(sparse)
        for image in range(len(images)):
            sparse_patch.set_pose_value(sparse / "images.bin", image, 4, 0.1 * image)
    else:
        rigged.write_text(sparse)
        lines = (sparse / "images.txt").read_text().splitlines()
        for i, line in enumerate(lines):
            words = line.split(" ")
            if len(words) == 10 and words[9].endswith(".png"):
                lines[i] = " ".join(words[:5] + ["0.3"] + words[6:])
        (sparse / "images.txt").write_text("\n".join(lines) + "\n")
    for image in pycolmap.Reconstruction(sparse).images.values():
        difference = image.cam_from_world().matrix() - poses[image.name].matrix()
        assert np.abs(difference).max() < 1e-9, "COLMAP takes the poses from the rig"


@unittest.skipUnless(hasattr(pycolmap, "Rig"), "this pycolmap knows no rigs")
class RigTest(unittest.TestCase):
    def test_the_poses_of_rigs_count_as_in_colmap(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        scene = pathlib.Path(folder.name) / "scene"
        size = ["--views", "4", "--width", "96", "--height", "72"]
        subprocess.run([HPM_MAKE_SCENE, "tilted_plane", scene, *size], check=True)
        depths = {}
        for kind in ("plain", "bin", "txt"):
            dense = pathlib.Path(folder.name) / kind
            shutil.copytree(scene, dense)
            if kind != "plain":
                write_as_rig(dense / "sparse", kind == "bin")
            result = subprocess.run(
                [HPM_MVS, "patch_match_stereo", "--workspace_path", dense, *FAST],
                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=200,
            )
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(result.stderr.count("have another pose"), int(kind != "plain"))
            path = dense / "stereo/depth_maps/view01.png.geometric.bin"
            depths[kind] = np.frombuffer(path.read_bytes()[-4 * 96 * 72 :], "<f4")
            options = pycolmap.StereoFusionOptions()
            options.min_num_pixels = 3
            pycolmap.stereo_fusion(dense / "fused.ply", dense, output_type="ply", options=options)
            vertices, _ = read_ply(dense / "fused.ply")
            self.assertGreater(len(vertices), 1000)
            self.assertLess(np.median(np.abs(positions(vertices) @ NORMAL)), 0.02)
        both = (depths["plain"] > 0) & (depths["bin"] > 0)
        self.assertGreater(both.mean(), 0.5)
        error = np.abs(depths["bin"] / np.where(both, depths["plain"], 1) - 1)[both]
        self.assertLess(np.quantile(error, 0.9), 0.01)
        self.assertTrue((depths["txt"] == depths["bin"]).all())


if __name__ == "__main__":
    unittest.main()
