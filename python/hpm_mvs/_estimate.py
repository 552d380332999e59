"""estimate(): what it takes and gives, and the checks of what it is given."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from . import _core

MAX_SOURCES = 32


class Estimate(NamedTuple):
    """The maps of one image.

    depth   (H, W) float32: z in the frame of the camera, model units; 0: none
    normal  (H, W, 3) float32: unit vectors in the frame of the camera, towards it; 0: none
    """

    depth: np.ndarray
    normal: np.ndarray


def estimate(
    images: Sequence[np.ndarray],
    cameras: Sequence[object],
    sources: Sequence[Sequence[int]],
    depth_ranges: object,
    *,
    method: str | None = None,
    seed: int | None = None,
    filter: bool | None = None,
    options: object = None,
    progress: Callable[[_core.ProgressEvent], object] | None = None,
    **more: object,
) -> list[Estimate | None]:
    """Depth and normal maps of N images in memory, on the CPU: no workspace, no files.

    images        N arrays (H, W) uint8, grey, without distortion; sizes may differ
    cameras       N objects or dicts with
                    K (3, 3) float: pinhole without skew, pixels. The centre of the pixel in
                      column c and row r lies at (c + 0.5, r + 0.5), as in COLMAP's models:
                      whose principal point counts from the centre of the first pixel adds 0.5.
                    R (3, 3), t (3,) float: x_camera = R x_world + t; x right, y down, z ahead
    sources       N lists of the images (numbers from 0) that the image is matched against, at
                  most 32; empty: the image has no maps of its own
    depth_ranges  (N, 2) float: nearest and farthest z of each image, model units; nothing
                  outside is searched. Of images without sources they do not matter.
    method, seed  Hpm.method and random_seed
    filter        False: keep pixels that too few sources confirm, as COLMAP's option
    options       as of patch_match_stereo(); those about files, image size, depth range and
                  devices have no say here
    progress      called with a ProgressEvent; its image is the number as text
    more          options by name; they go before `options`

    Returns an Estimate for each image, None for those without sources. Values belong to the
    rays through the centres of the pixels. (The files of COLMAP's workspaces hold them on rays
    half a pixel up and left of these.) The same arguments give the same bytes on one machine,
    for any number of threads.

    The GIL is released. Raises UsageError for arguments that are not as they should be, other
    classes of Error, and KeyboardInterrupt on Ctrl-C.
    """
    pixels = [_image(f"images[{i}]", image) for i, image in enumerate(images)]
    count = len(pixels)
    _check_count("cameras", cameras, count)
    _check_count("sources", sources, count)
    matrices = [_camera(f"cameras[{i}]", camera) for i, camera in enumerate(cameras)]
    lists = [_sources(i, some, count) for i, some in enumerate(sources)]
    given = {"Hpm.method": method, "random_seed": seed, "filter": filter}
    more.update({name: value for name, value in given.items() if value is not None})
    maps = _core.estimate(
        pixels,
        *(np.array([m[k] for m in matrices]).reshape(shape)
          for k, shape in enumerate([(-1, 3, 3), (-1, 3, 3), (-1, 3)])),
        lists,
        _ranges(depth_ranges, lists),
        _core.PatchMatchOptions(options, **more),
        progress,
    )
    return [None if pair is None else Estimate(*pair) for pair in maps]


def _image(name: str, image: object) -> np.ndarray:
    array = np.asarray(image)
    if array.ndim != 2 or array.dtype != np.uint8 or array.size == 0:
        raise _core.UsageError(
            f"{name}: {array.dtype} of shape {array.shape}; allowed: grey, uint8 of shape (H, W)"
        )
    return np.ascontiguousarray(array)


def _check_count(name: str, values: Sequence[object], count: int) -> None:
    if len(values) != count:
        raise _core.UsageError(f"{name}: {len(values)} for {count} images; allowed: one each")


def _numbers(name: str, values: object, shape: tuple[int, ...]) -> np.ndarray:
    try:
        array = np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise _core.UsageError(f"{name}: not numbers; allowed: shape {shape}") from None
    if array.shape != shape or not np.isfinite(array).all():
        raise _core.UsageError(
            f"{name}: shape {array.shape}; allowed: finite numbers of shape {shape}"
        )
    return array


def _camera(name: str, camera: object) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    values = {}
    for key, shape in (("K", (3, 3)), ("R", (3, 3)), ("t", (3,))):
        try:
            value = camera[key] if isinstance(camera, dict) else getattr(camera, key)
        except (KeyError, AttributeError):
            raise _core.UsageError(f"{name}: has no {key}; allowed: K, R and t") from None
        values[key] = _numbers(f"{name}.{key}", value, shape)
    k, r = values["K"], values["R"]
    zeros = k[[0, 1, 2, 2], [1, 0, 0, 1]]
    if (zeros != 0).any() or k[2, 2] != 1 or k[0, 0] <= 0 or k[1, 1] <= 0:
        raise _core.UsageError(
            f"{name}.K: allowed: [[fx, 0, cx], [0, fy, cy], [0, 0, 1]] with fx, fy > 0"
        )
    if np.abs(r @ r.T - np.eye(3)).max() > 1e-3 or np.linalg.det(r) < 0:
        raise _core.UsageError(f"{name}.R: not a rotation")
    return k, r, values["t"]


def _sources(image: int, sources: Sequence[int], count: int) -> list[int]:
    name = f"sources[{image}]"
    try:
        numbers = [int(number) for number in sources]
    except (TypeError, ValueError):
        raise _core.UsageError(f"{name}: allowed: a list of numbers of images") from None
    for number in numbers:
        if not 0 <= number < count or number == image:
            raise _core.UsageError(
                f"{name}: {number}; allowed: 0 to {count - 1}, and not the image itself"
            )
    if len(set(numbers)) != len(numbers) or len(numbers) > MAX_SOURCES:
        raise _core.UsageError(f"{name}: allowed: at most {MAX_SOURCES}, each once")
    return numbers


def _ranges(depth_ranges: object, sources: list[list[int]]) -> np.ndarray:
    ranges = _numbers("depth_ranges", depth_ranges, (len(sources), 2))
    for i, (near, far) in enumerate(ranges):
        if sources[i] and not 0 < near <= far:
            raise _core.UsageError(
                f"depth_ranges[{i}]: {near:g} to {far:g}; allowed: 0 < nearest <= farthest"
            )
    return ranges
