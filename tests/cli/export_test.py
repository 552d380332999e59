"""hpm_mvs export: what is written is what the maps hold, in every format. The readers
here are small; with NumPy and OpenCV in HPM_PYTHON theirs read the files, too."""
import array
import json
import os
import struct
import subprocess
import sys
import textwrap
import unittest

from png import decode16
from support import FAST, HPM_MVS, CliTest, read_map

WIDTH, HEIGHT = 96, 72
SIZE = WIDTH * HEIGHT
NAME = "view01.png"


def floats(data):
    values = array.array("f")
    values.frombytes(data)
    return values


def interleaved(values):
    """Channel after channel -> all channels of a pixel together."""
    channels = len(values) // SIZE
    return [values[c * SIZE + i] for i in range(SIZE) for c in range(channels)]


def read_npy(data):
    assert data[:8] == b"\x93NUMPY\x01\0"
    length = struct.unpack("<H", data[8:10])[0]
    assert (10 + length) % 64 == 0
    header = eval(data[10 : 10 + length])  # as NumPy's own reader understands it
    assert header["descr"] == "<f4" and not header["fortran_order"]
    return header["shape"], list(floats(data[10 + length :]))


def read_pfm(data):
    kind, size, scale, body = data.split(b"\n", 3)
    channels = {b"Pf": 1, b"PF": 3}[kind]
    assert size == b"%d %d" % (WIDTH, HEIGHT) and float(scale) == -1
    row = WIDTH * channels
    values = floats(body)
    return [v for y in reversed(range(HEIGHT)) for v in values[y * row : (y + 1) * row]]


def read_exr(data):
    assert struct.unpack("<II", data[:8]) == (20000630, 2)
    at, attributes = 8, {}
    while data[at]:
        end = data.index(b"\0", at)
        name, at = data[at:end].decode(), data.index(b"\0", end + 1) + 1
        size = struct.unpack("<I", data[at : at + 4])[0]
        attributes[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    assert struct.unpack("<4i", attributes["dataWindow"]) == (0, 0, WIDTH - 1, HEIGHT - 1)
    assert attributes["compression"] == b"\0"
    channels = [c for c in attributes["channels"][::18].decode() if c != "\0"]
    offsets = struct.unpack(f"<{HEIGHT}Q", data[at + 1 : at + 1 + 8 * HEIGHT])
    planes = {c: array.array("f") for c in channels}
    for y, offset in enumerate(offsets):
        row, size = struct.unpack("<ii", data[offset : offset + 8])
        assert (row, size) == (y, 4 * WIDTH * len(channels))
        for i, c in enumerate(channels):
            begin = offset + 8 + 4 * WIDTH * i
            planes[c].frombytes(data[begin : begin + 4 * WIDTH])
    order = "Y" if len(channels) == 1 else "RGB"
    return interleaved([v for c in order for v in planes[c]])


class Export(CliTest):
    @classmethod
    def setUpClass(cls):
        cls.dense = CliTest.workspace(cls)
        subprocess.run(
            [HPM_MVS, "patch_match_stereo", "--workspace_path", str(cls.dense), *FAST],
            check=True,
            stdout=subprocess.DEVNULL,
        )
        maps = cls.dense / "stereo"
        cls.depth = list(read_map(maps / f"depth_maps/{NAME}.geometric.bin")[3])
        cls.normal = list(read_map(maps / f"normal_maps/{NAME}.geometric.bin")[3])

    @classmethod
    def addCleanup(cls, *arguments, **keywords):
        cls.addClassCleanup(*arguments, **keywords)

    def export(self, *options):
        return subprocess.run(
            [HPM_MVS, "export", "--workspace_path", str(self.dense), *options],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            timeout=60,
        )

    def exported(self, form, end):
        out = self.dense.parent / f"out_{form}"
        self.assert_exit(self.export(f"--format={form}", f"--output_path={out}"), 0)
        names = sorted(p.name for p in out.iterdir())
        self.assertEqual(len(names), 12, names)
        return [(out / f"{NAME}.{kind}.{end}").read_bytes() for kind in ("depth", "normal")]

    def test_npy_holds_the_maps(self):
        depth, normal = self.exported("npy", "npy")
        self.assertTrue(read_npy(depth) == ((HEIGHT, WIDTH), self.depth))
        self.assertTrue(read_npy(normal) == ((HEIGHT, WIDTH, 3), interleaved(self.normal)))

    def test_pfm_holds_the_maps(self):
        depth, normal = self.exported("pfm", "pfm")
        self.assertTrue(read_pfm(depth) == self.depth)
        self.assertTrue(read_pfm(normal) == interleaved(self.normal))

    def test_exr_holds_the_maps(self):
        depth, normal = self.exported("exr", "exr")
        self.assertTrue(read_exr(depth) == self.depth)
        self.assertTrue(read_exr(normal) == interleaved(self.normal))

    def test_png16_holds_the_maps_to_a_step(self):
        depth, normal = (decode16(data) for data in self.exported("png16", "png"))
        about = json.loads((self.dense.parent / f"out_png16/{NAME}.json").read_text())
        step = about["depth_per_step"]
        self.assertAlmostEqual(step, max(self.depth) / 65535)
        for i in range(SIZE):
            self.assertEqual(depth[i] == 0, self.depth[i] == 0)
            self.assertLessEqual(abs(depth[i] * step - self.depth[i]), 0.51 * step)
            for axis in range(3):
                value = normal[3 * i + axis]
                if self.depth[i] == 0:
                    self.assertEqual(value, 0)
                else:
                    n = self.normal[axis * SIZE + i]
                    self.assertLess(abs((value - 32768) / 32767 - n), 2 / 32767)

    def test_another_format_leaves_what_the_first_one_needs(self):
        out = self.dense.parent / "both"
        self.assert_exit(self.export("--format=png16", f"--output_path={out}"), 0)
        self.assert_exit(self.export("--format=npy", f"--output_path={out}"), 0)
        about = json.loads((out / f"{NAME}.json").read_text())
        self.assertAlmostEqual(about["depth_per_step"], max(self.depth) / 65535)

    def test_steps_too_small_for_16_bits_are_refused(self):
        out = self.dense.parent / "small_steps"
        result = self.export("--format=png16", "--depth_step=0.00001", f"--output_path={out}")
        self.assert_exit(result, 4, "--depth_step 1e-05", "give at least")
        self.assertFalse(out.exists() and any(out.iterdir()))

    def test_photometric_maps_have_a_folder_of_their_own(self):
        self.assert_exit(self.export("--format=npy", "--input_type=photometric"), 0)
        self.assertTrue((self.dense / f"stereo/export_photometric/{NAME}.depth.npy").exists())
        self.assertFalse((self.dense / "stereo/export").exists())

    def test_numbers_that_no_map_may_hold_are_not_exported(self):
        path = self.dense / "stereo/depth_maps/view03.png.geometric.bin"
        good = path.read_bytes()
        try:
            for value in (float("nan"), -3.4e35):
                path.write_bytes(good[:-4] + struct.pack("<f", value))
                out = self.dense.parent / "damaged"
                result = self.export("--format=npy", f"--output_path={out}")
                self.assert_exit(result, 4, "view03.png.geometric.bin: ", "check --fix 1")
                self.assertFalse((out / "view03.png.depth.npy").exists())
        finally:
            path.write_bytes(good)

    def test_ply_points_project_to_their_pixels_with_their_depth(self):
        out = self.dense.parent / "out_ply"
        result = self.export("--format=ply", f"--output_path={out}", f"--image_name={NAME}")
        self.assert_exit(result, 0)
        self.assertEqual([p.name for p in out.iterdir()], [f"{NAME}.ply"])
        self.assert_exit(self.export("--format=npy", f"--output_path={out}"), 0)
        about = json.loads((out / f"{NAME}.json").read_text())
        head, body = (out / f"{NAME}.ply").read_bytes().split(b"end_header\n", 1)
        points = list(struct.iter_unpack("<3d3f3B", body))
        pixels = [i for i in range(SIZE) if self.depth[i] > 0]
        self.assertIn(b"element vertex %d\n" % len(pixels), head)
        self.assertEqual(len(points), len(pixels))
        w, x, y, z = about["cam_from_world_rotation_wxyz"]
        rotation = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
        turn = lambda v: [sum(a * b for a, b in zip(row, v)) for row in rotation]
        for i, point in zip(pixels, points):
            p = [a + b for a, b in zip(turn(point[:3]), about["cam_from_world_translation"])]
            self.assertAlmostEqual(p[2], self.depth[i], delta=1e-4)
            self.assertAlmostEqual(about["fx"] * p[0] / p[2] + about["cx"], i % WIDTH, delta=1e-2)
            self.assertAlmostEqual(about["fy"] * p[1] / p[2] + about["cy"], i // WIDTH, delta=1e-2)
            for axis, n in enumerate(turn(point[3:6])):
                self.assertAlmostEqual(n, self.normal[axis * SIZE + i], delta=1e-4)

    def test_what_is_not_there_is_exit_3_and_a_damaged_map_4(self):
        self.assert_exit(self.export("--image_name=view99.png"), 3, "view99.png", "no such image")
        self.assert_exit(self.export("--format=jpg"), 2, "--format 'jpg'", "png16")
        self.assert_exit(self.export("--Hpm.method=hpm"), 2, "export does not take --Hpm.method")
        path = self.dense / f"stereo/normal_maps/{NAME}.photometric.bin"
        data = path.read_bytes()
        path.write_bytes(data[:-1])
        result = self.export("--input_type=photometric", "--format=npy")
        self.assert_exit(result, 4, "1 images could not be exported", f"{NAME}.photometric.bin")
        self.assertIn("3 images exported to", result.stdout)
        path.write_bytes(data)

    def test_numpy_and_opencv_read_the_same(self):
        python = os.environ.get("HPM_PYTHON", sys.executable)
        found = subprocess.run([python, "-c", "import numpy, cv2"], stderr=subprocess.DEVNULL)
        if found.returncode != 0:
            self.skipTest("no NumPy and OpenCV for Python (HPM_PYTHON names one that has them)")
        out = self.dense.parent / "out_all"
        for form in ("npy", "exr", "pfm", "png16"):
            self.assert_exit(self.export(f"--format={form}", f"--output_path={out}"), 0)
        script = """
            import json, os, re, sys
            os.environ["OPENCV_IO_ENABLE_OPENEXR"] = "1"
            import cv2, numpy as np
            base = sys.argv[1]
            # The wheels of OpenCV come without; exchange_files_test has it.
            has_exr = not re.search(r"OpenEXR: +NO", cv2.getBuildInformation())
            step = json.load(open(base + ".json")).get("depth_per_step")
            for kind in ("depth", "normal"):
                want = np.load(f"{base}.{kind}.npy")
                flags = cv2.IMREAD_UNCHANGED
                for form in ("exr", "pfm", "png"):
                    if form == "exr" and not has_exr:
                        continue
                    got = cv2.imread(f"{base}.{kind}.{form}", flags)
                    assert got is not None, form
                    if kind == "normal":
                        got = got[..., ::-1]
                    if form == "png":
                        if kind == "depth":
                            error = np.abs(got * step - want).max() / step
                        else:
                            error = np.abs((got - 32768.0) / 32767 - want)[(got > 0).any(2)].max() * 16384
                        assert error < 1.01, (kind, error)
                    else:
                        assert got.dtype == np.float32 and np.array_equal(got, want), (kind, form)
        """
        result = subprocess.run(
            [python, "-c", textwrap.dedent(script), str(out / NAME)], stderr=subprocess.PIPE, text=True
        )
        self.assertEqual(result.returncode, 0, result.stderr)


if __name__ == "__main__":
    unittest.main()
