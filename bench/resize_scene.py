#!/usr/bin/env python3
"""A scene of the suite at another size: photographs, cameras and truth, each image
WIDTH pixels wide. Enlarged ones show no detail that the scene did not have, as many
photographs do; what is known of the truth is the nearest pixel's.

    scripts/install_pycolmap.sh
    .venv/bin/python bench/resize_scene.py SCENE OUT/NAME --width 800
"""
import argparse
import pathlib
import shutil
import subprocess
import tempfile

import numpy as np
import pycolmap

from map_files import read_map, write_map


def nearest(array, width, height):
    """Samples at the centres of the new pixels."""
    rows = ((np.arange(height) + 0.5) * array.shape[1] / height).astype(int)
    cols = ((np.arange(width) + 0.5) * array.shape[2] / width).astype(int)
    return array[:, rows[:, None], cols]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path, help="must not exist")
    parser.add_argument("--width", type=int, required=True)
    args = parser.parse_args()
    (args.out / "sparse").mkdir(parents=True)
    shutil.copytree(args.scene / "stereo", args.out / "stereo")
    if (args.scene / "suite.json").exists():
        shutil.copyfile(args.scene / "suite.json", args.out / "suite.json")

    model = pycolmap.Reconstruction(args.scene / "sparse")
    for image in model.images.values():
        scale = args.width / model.cameras[image.camera_id].width
        for point in image.points2D:
            point.xy = point.xy * scale
    for camera in model.cameras.values():
        camera.rescale(args.width, round(camera.height * args.width / camera.width))
    model.write(args.out / "sparse")

    with tempfile.TemporaryDirectory(prefix="hpm_resize_") as folder:
        truth = args.scene / "gt"
        if not truth.is_dir():
            subprocess.run(["tar", "-xf", args.scene / "gt.tar.xz", "-C", folder], check=True)
            truth = pathlib.Path(folder) / "gt"
        for image in model.images.values():
            camera = model.cameras[image.camera_id]
            picture = pycolmap.Bitmap.read(str(args.scene / "images" / image.name), True)
            picture.rescale(camera.width, camera.height)
            picture.set_jpeg_quality(96)
            target = args.out / "images" / image.name
            target.parent.mkdir(parents=True, exist_ok=True)
            picture.write(str(target))
            for kind in ("depth_maps", "normal_maps"):
                name = pathlib.Path("gt") / kind / f"{image.name}.bin"
                if (truth.parent / name).exists():
                    (args.out / name).parent.mkdir(parents=True, exist_ok=True)
                    whole = read_map(truth.parent / name)
                    write_map(args.out / name, nearest(whole, camera.width, camera.height))
        if (truth / "points.ply").exists():
            shutil.copyfile(truth / "points.ply", args.out / "gt/points.ply")


if __name__ == "__main__":
    main()
