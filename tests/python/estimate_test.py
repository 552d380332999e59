"""estimate() of the Python package: a plane whose depths are known exactly, and arguments that
are not as they should be."""
import math
import os
import signal
import threading
import time
import types
import unittest

import numpy as np

import hpm_mvs

WIDTH, HEIGHT, FOCAL = 160, 120, 150.0
# In columns and rows, where the first pixel covers 0 to 1.
K = np.array([[FOCAL, 0, WIDTH / 2], [0, FOCAL, HEIGHT / 2], [0, 0, 1]])
# The plane NORMAL . x = OFFSET of the world, 4 m away and tilted; NORMAL towards the cameras.
NORMAL = np.array([0.2, -0.1, -1]) / np.linalg.norm([0.2, -0.1, -1])
OFFSET = 4 * NORMAL[2]
FAST = {"Hpm.quality": "low", "num_threads": 2}


def rotation(angle):
    """About the y axis."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])


def rays():
    """Through the centres of the pixels, z = 1, frame of the camera."""
    cols, rows = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
    return np.stack([(cols - K[0, 2]) / FOCAL, (rows - K[1, 2]) / FOCAL, np.ones_like(cols)], -1)


def true_depth(camera):
    r, t = camera["R"], camera["t"]
    return (OFFSET + NORMAL @ r.T @ t) / (rays() @ (r @ NORMAL))


def picture(camera):
    points = (rays() * true_depth(camera)[..., None] - camera["t"]) @ camera["R"]
    x, y = points[..., 0], points[..., 1]
    paint = np.sin(17 * x + 3 * np.sin(5 * y)) + np.sin(13 * y + 3 * np.sin(7 * x))
    return (128 + 60 * paint).astype(np.uint8)


def scene():
    """Images, cameras, sources, depth ranges of three views; the third turned and ahead."""
    cameras = []
    for angle, center in ((0, (0, 0, 0)), (0.05, (0.3, 0, 0)), (-0.05, (-0.3, 0.1, 0.2))):
        r = rotation(angle)
        cameras.append({"K": K, "R": r, "t": -r @ np.array(center)})
    sources = [[1, 2], [0, 2], [0, 1]]
    return [picture(c) for c in cameras], cameras, sources, np.tile([1.0, 10.0], (3, 1))


class Plane(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = scene()
        cls.maps = hpm_mvs.estimate(*cls.scene, **FAST)

    def check(self, maps, cameras):
        for result, camera in zip(maps, cameras):
            depth, normal = result
            self.assertEqual((depth.shape, depth.dtype), ((HEIGHT, WIDTH), np.float32))
            self.assertEqual((normal.shape, normal.dtype), ((HEIGHT, WIDTH, 3), np.float32))
            valid = depth > 0
            # Of two sources both must confirm a pixel, and not both see all of it.
            self.assertGreater(valid.mean(), 0.6)
            error = np.abs(depth / true_depth(camera) - 1)[valid]
            self.assertLess(np.median(error), 0.001)
            self.assertLess(np.quantile(error, 0.95), 0.01)
            np.testing.assert_allclose(np.linalg.norm(normal[valid], axis=-1), 1, atol=1e-4)
            self.assertGreater(np.median(normal[valid] @ (camera["R"] @ NORMAL)), 0.99)
            self.assertTrue((normal[~valid] == 0).all())

    def test_has_the_closed_form(self):
        self.check(self.maps, self.scene[1])

    def test_far_from_the_origin_it_is_as_good(self):
        images, cameras, sources, ranges = self.scene
        far = np.array([4e5, -5e6, 300.0])
        moved = [{**c, "t": c["t"] - c["R"] @ far} for c in cameras]
        # The closed form is that of the cameras near the origin.
        self.check(hpm_mvs.estimate(images, moved, sources, ranges, **FAST), cameras)

    def test_cameras_may_be_objects_and_arrays_of_any_layout(self):
        images, cameras, sources, ranges = self.scene
        strided = [np.asfortranarray(image) for image in images]
        objects = [types.SimpleNamespace(**camera) for camera in cameras]
        again = hpm_mvs.estimate(strided, objects, np.array(sources), ranges.tolist(),
                                 **{**FAST, "num_threads": 1})
        for a, b in zip(self.maps, again):
            self.assertEqual(a.depth.tobytes(), b.depth.tobytes())
            self.assertEqual(a.normal.tobytes(), b.normal.tobytes())

    def test_another_seed_gives_other_digits(self):
        other = hpm_mvs.estimate(*self.scene, seed=1, **FAST)
        self.assertFalse((other[0].depth == self.maps[0].depth).all())
        self.check(other, self.scene[1])

    def test_an_image_without_sources_has_no_maps(self):
        images, cameras, _, ranges = self.scene
        maps = hpm_mvs.estimate(images, cameras, [[], [0, 2], []], ranges, **FAST)
        self.assertEqual([m is None for m in maps], [True, False, True])
        self.assertGreater((maps[1].depth > 0).mean(), 0.5)
        self.assertEqual(hpm_mvs.estimate([], [], [], np.zeros((0, 2))), [])

    def test_without_the_filter_all_pixels_stay(self):
        maps = hpm_mvs.estimate(*self.scene, filter=False, **FAST)
        self.assertGreater((maps[0].depth > 0).mean(), (self.maps[0].depth > 0).mean())

    def test_nothing_lies_outside_the_range(self):
        images, cameras, sources, _ = self.scene
        ranges = np.tile([1.0, 4.0], (3, 1))
        depth = hpm_mvs.estimate(images, cameras, sources, ranges, method="hpm_fast")[0].depth
        self.assertTrue((depth <= 4).all())
        self.assertGreater((depth > 0).mean(), 0.2)


class Run(unittest.TestCase):
    def test_tells_how_far_it_is_while_other_threads_go_on(self):
        events, ticks, stop = [], [], threading.Event()

        def tick():
            while not stop.wait(0.01):
                ticks.append(1)

        thread = threading.Thread(target=tick)
        thread.start()
        hpm_mvs.estimate(*scene(), progress=events.append, **FAST)
        stop.set()
        thread.join()
        self.assertAlmostEqual(events[-1].fraction, 1)
        self.assertLessEqual({event.image for event in events}, {"", "0", "1", "2"})
        self.assertGreater(len(ticks), 5)

    def test_ctrl_c_stops_it(self):
        begin = []

        def progress(event):
            if not begin:
                begin.append(time.monotonic())
                os.kill(os.getpid(), signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            hpm_mvs.estimate(*scene(), progress=progress, **{"Hpm.num_iterations": 1000})
        self.assertLess(time.monotonic() - begin[0], 2)


class WrongArguments(unittest.TestCase):
    def check(self, words, change, **keywords):
        arguments = [list(argument) for argument in scene()]
        change(*arguments)
        with self.assertRaisesRegex(hpm_mvs.UsageError, words):
            hpm_mvs.estimate(*arguments, **keywords)

    def change_camera(self, **values):
        def change(images, cameras, sources, ranges):
            cameras[1] = {**cameras[1], **values}
        return change

    def test_images(self):
        def colour(images, *_):
            images[1] = np.zeros((HEIGHT, WIDTH, 3), np.uint8)

        def floats(images, *_):
            images[1] = images[1] / 255

        self.check(r"images\[1\]: uint8 of shape \(120, 160, 3\); allowed: grey", colour)
        self.check(r"images\[1\]: float64", floats)

    def test_cameras(self):
        self.check(r"cameras\[1\].K: shape \(3, 4\)", self.change_camera(K=np.eye(3, 4)))
        self.check(r"cameras\[1\].K: allowed", self.change_camera(K=K + np.eye(3, k=1)))
        self.check(r"cameras\[1\].R: not a rotation", self.change_camera(R=2 * np.eye(3)))
        self.check(r"cameras\[1\].t: .*finite", self.change_camera(t=[0, 0, math.nan]))
        self.check(r"cameras\[1\].t: not numbers", self.change_camera(t="here"))
        self.check("cameras: 2 for 3", lambda images, cameras, *_: cameras.pop())
        self.check(r"cameras\[1\]: has no t", lambda images, cameras, *_: cameras[1].pop("t"))

    def test_sources(self):
        for numbers, words in (([3], "3; allowed: 0 to 2"), ([1], "not the image itself"),
                               ([0, 0], "each once"), ([-1], "0 to 2"), (["a"], "a list of numbers")):
            def change(images, cameras, sources, ranges, numbers=numbers):
                sources[1] = numbers
            self.check(rf"sources\[1\]: .*{words}", change)

    def test_depth_ranges(self):
        def change(images, cameras, sources, ranges):
            ranges[2] = [3, 2]
        self.check(r"depth_ranges\[2\]: 3 to 2; allowed: 0 < nearest", change)
        self.check(r"depth_ranges: shape \(2, 2\)", lambda *arguments: arguments[3].pop())

    def test_options(self):
        self.check("Hpm.method 'best'", lambda *_: None, method="best")
        self.check("did you mean 'filter_min_ncc'", lambda *_: None, filter_mn_ncc=0)


if __name__ == "__main__":
    unittest.main()
