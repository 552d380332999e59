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


def read_map(path):
    """COLMAP's depth or normal map: height x width x channels."""
    data = path.read_bytes()
    width, height, channels, values = data.split(b"&", 3)
    shape = int(channels), int(height), int(width)
    return np.moveaxis(np.frombuffer(values, np.float32).reshape(shape), 0, 2)


def write_map(path, array):
    path.parent.mkdir(parents=True, exist_ok=True)
    height, width, channels = array.shape
    path.write_bytes(f"{width}&{height}&{channels}&".encode() + np.moveaxis(array, 2, 0).astype(np.float32).tobytes())


def nearest(array, width, height):
    """Samples at the centres of the new pixels."""
    rows = ((np.arange(height) + 0.5) * array.shape[0] / height).astype(int)
    cols = ((np.arange(width) + 0.5) * array.shape[1] / width).astype(int)
    return array[np.ix_(rows, cols)]


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
                path = truth / kind / f"{image.name}.bin"
                if path.exists():
                    write_map(args.out / "gt" / kind / path.name, nearest(read_map(path), camera.width, camera.height))
        if (truth / "points.ply").exists():
            shutil.copyfile(truth / "points.ply", args.out / "gt/points.ply")


if __name__ == "__main__":
    main()
