#!/usr/bin/env python3
"""Whether --Hpm.confidence means what it says: per class of confidence, the share of
published pixels whose depth is within 1 % of the truth.

    bench/reliability.py --hpm_mvs build/release/colmap_plugin/tool/hpm_mvs \\
        --scenes data --names workshop,street [--within 0.02] [-- --Hpm.quality low]

Scenes are workspaces with gt/depth_maps, or gt.tar.xz; see suite.py. Needs numpy.
Everything after -- goes to hpm_mvs. The last column is the mean over the classes of
the difference between both, weighted by their pixels (expected calibration error).
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

from map_files import read_map
from suite import copy_workspace

NUM_CLASSES = 10


def pixels_of(dense, within):
    """Confidence and whether the depth is right, of all published pixels with truth."""
    confidences, right = [], []
    folder = dense / "stereo/depth_maps"
    for path in sorted(folder.rglob("*.geometric.bin")):
        name = path.relative_to(folder).as_posix()[: -len(".geometric.bin")]
        depth = read_map(path)[0]
        confidence = read_map(dense / "stereo/confidence_maps" / path.relative_to(folder))[0]
        true_depth = read_map(dense / f"gt/depth_maps/{name}.bin")[0]
        if true_depth.shape != depth.shape:
            sys.exit(f"{name}: the truth has another size; leave max_image_size out")
        known = (depth > 0) & (true_depth > 0)
        confidences.append(confidence[known])
        right.append(np.abs(depth[known] / true_depth[known] - 1) < within)
    return np.concatenate(confidences), np.concatenate(right)


def row_of(confidence, right):
    cells, error = [], 0
    classes = np.minimum((confidence * NUM_CLASSES).astype(int), NUM_CLASSES - 1)
    for k in range(NUM_CLASSES):
        chosen = classes == k
        share = chosen.mean()
        if share < 0.001:
            cells.append("-")
            continue
        said, seen = confidence[chosen].mean(), right[chosen].mean()
        error += share * abs(said - seen)
        cells.append(f"{100 * seen:.0f} ({100 * share:.0f})")
    return cells, error


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--hpm_mvs", type=pathlib.Path, required=True)
    parser.add_argument("--scenes", type=pathlib.Path, required=True)
    parser.add_argument("--names", required=True)
    parser.add_argument("--within", type=float, default=0.01)
    own, _, options = " ".join(sys.argv[1:]).partition(" -- ")
    args = parser.parse_args(own.split())
    heads = [f"{k / NUM_CLASSES:.1f}" for k in range(NUM_CLASSES)]
    print("| scene | " + " | ".join(heads) + " | error |\n|" + "---|" * (NUM_CLASSES + 2))
    for name in args.names.split(","):
        with tempfile.TemporaryDirectory(prefix="hpm_reliability_") as scratch:
            dense = pathlib.Path(scratch) / "dense"
            copy_workspace(args.scenes / name, 1, dense)
            subprocess.run(
                [args.hpm_mvs, "patch_match_stereo", "--workspace_path", dense,
                 "--Hpm.confidence=1", "--Hpm.report=0", *options.split()],
                check=True, stdout=subprocess.DEVNULL,
            )
            cells, error = row_of(*pixels_of(dense, args.within))
        print(f"| {name} | " + " | ".join(cells) + f" | {error:.3f} |", flush=True)


if __name__ == "__main__":
    main()
