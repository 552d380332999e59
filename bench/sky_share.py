#!/usr/bin/env python3
"""How much of the sky got a depth, and how much of the fused cloud is sky.

    scripts/install_pycolmap.sh
    .venv/bin/python bench/sky_share.py WORKSPACE ...

For workspaces with finished geometric maps. Sky is what lies above the first pixel of a
column that is neither bluish and bright nor nearly white, less a rim of two pixels. It is
rough (white walls at the upper border count) and meant to compare programs on the same
photographs. Fuses twice with COLMAP, with and without the depths of the sky.
"""
import argparse
import pathlib
import re
import shutil
import subprocess
import tempfile

import numpy as np
import pycolmap

from map_files import read_map, write_map

SUFFIX = ".geometric.bin"
RIM = 2  # pixels


def sky_of(image_path, height, width):
    image = pycolmap.Bitmap.read(str(image_path), True)
    image.rescale(width, height)
    red, green, blue = (image.to_array()[..., i].astype(int) for i in range(3))
    bluish = (blue > red + 10) & (blue > 110)
    white = np.minimum(np.minimum(red, green), blue) > 225
    above_all_else = np.logical_and.accumulate(bluish | white, axis=0)
    sky = above_all_else.copy()
    for shift in range(1, RIM + 1):
        sky[:-shift] &= above_all_else[shift:]
        sky[:, shift:] &= above_all_else[:, :-shift]
        sky[:, :-shift] &= above_all_else[:, shift:]
    return sky


def count_fused(workspace, max_image_size):
    with tempfile.TemporaryDirectory() as folder:
        log = subprocess.run(
            ["colmap", "stereo_fusion", "--workspace_path", workspace,
             "--StereoFusion.max_image_size", str(max_image_size),
             "--output_path", pathlib.Path(folder) / "fused.ply"],
            check=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True).stdout
    return int(re.search(r"Number of fused points: (\d+)", log).group(1))


def report(workspace):
    with tempfile.TemporaryDirectory(prefix="hpm_sky_") as folder:
        without = pathlib.Path(folder) / "dense"
        shutil.copytree(workspace, without, ignore=lambda *_: ["hpm_mvs"])
        num_sky = num_with_depth = num_pixels = side = 0
        for path in sorted((without / "stereo/depth_maps").rglob("*" + SUFFIX)):
            name = str(path.relative_to(without / "stereo/depth_maps"))[:-len(SUFFIX)]
            depth = read_map(path)[0]
            sky = sky_of(without / "images" / name, *depth.shape)
            side = max(side, *depth.shape)
            num_pixels += depth.size
            num_sky += sky.sum()
            num_with_depth += (sky & (depth > 0)).sum()
            write_map(path, np.where(sky, 0, depth))
        num_fused = count_fused(workspace, side)
        num_others = count_fused(without, side)
    print(f"{workspace}: {100 * num_sky / num_pixels:.1f} % of the pixels are sky, "
          f"{100 * num_with_depth / max(1, num_sky):.1f} % of it has a depth; {num_fused} fused "
          f"points, {num_others} without it: {100 * (1 - num_others / num_fused):.1f} % are sky")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("workspaces", nargs="+", type=pathlib.Path)
    for path in parser.parse_args().workspaces:
        report(path)
