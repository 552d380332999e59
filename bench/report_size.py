#!/usr/bin/env python3
"""What the report of many images takes: seconds, memory and the length of the page.

Makes the survey of bench/scale.py with made-up maps of all images, their stamps and a run
record, so that nothing has to be matched, and runs hpm_mvs report. Ten pairs of maps are
linked to all names: their files are in the system's cache, as those of a run that has just
ended are where there is room. Needs numpy.

    bench/report_size.py --hpm_mvs build/release/colmap_plugin/tool/hpm_mvs --images 500
"""
import argparse
import json
import os
import pathlib
import subprocess
import tempfile
import time

import numpy as np

import proc
import scale
from map_files import write_map

KINDS = 10  # of maps


def make_maps(dense, names, width, height):
    """A slope with steps and noise, so that pictures do not shrink to nothing; a fifth lost."""
    random = np.random.default_rng(1)
    stereo = dense / "stereo"
    folders = [stereo / "depth_maps", stereo / "normal_maps"]
    for folder in folders:
        folder.mkdir()
    for kind in range(KINDS):
        rows, columns = np.mgrid[0:height, 0:width]
        depth = 45 + 5 * rows / height + 2 * ((columns // 16 + rows // 16 + kind) % 2)
        depth = depth + random.normal(0, 0.1, depth.shape)
        lost = random.random(depth.shape) < 0.2
        normal = random.normal(0, 0.2, (3, height, width)) + np.array([0, 0, -1.0])[:, None, None]
        normal /= np.linalg.norm(normal, axis=0)
        for folder, values in zip(folders, (depth, normal)):
            first = folder / f"{names[kind]}.geometric.bin"
            write_map(first, np.where(lost, 0, values))
            for name in names[kind + KINDS :: KINDS]:
                os.link(first, folder / f"{name}.geometric.bin")


def make_records(dense, names):
    random = np.random.default_rng(2)
    state = dense / "stereo/hpm_mvs"
    stamps = state / "stamps/geometric"
    stamps.mkdir(parents=True)
    images = {}
    for name in names:
        statistics = {
            "valid_pixel_share": 0.8 - 0.1 * random.random(),
            "filter_losses": {"geometry": 0.15, "num_consistent": 0.04},
            "cost_histogram": random.integers(0, 30000, 20).tolist(),
            "cost_evaluations_per_pixel": 250.0,
            "seconds": {"basic": 9.0 + random.random(), "geometric": 5.0, "write": 0.2},
        }
        images[name] = {"geometric": statistics, "photometric": statistics}
        (stamps / f"{name}.json").write_text(
            json.dumps({"version": 2, "fingerprint": "", "files": {}, **statistics}))
    (state / "run.json").write_text(json.dumps({
        "options": {f"option_{i}": i for i in range(80)}, "backend": "made up", "seconds": 7000,
        "seconds_per_phase": {"basic": 4500, "geometric": 2500}, "peak_memory_bytes": 1 << 30,
        "images_computed": len(names), "images_kept": 0, "images_failed": [], "warnings": [],
        "images": images}))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hpm_mvs", required=True)
    parser.add_argument("--images", type=int, default=500)
    parser.add_argument("--size", type=int, nargs=2, default=(1024, 768))
    parser.add_argument("--points", type=int, default=200000)
    parser.add_argument("--threads", type=int, default=2)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="hpm_report_") as folder:
        dense = pathlib.Path(folder) / "dense"
        scale.make(dense, arguments.images, arguments.points, 10, *arguments.size, 20)
        names = sorted(path.name for path in (dense / "images").iterdir())
        make_maps(dense, names, *arguments.size)
        make_records(dense, names)
        begin = time.monotonic()
        process = subprocess.Popen(
            [arguments.hpm_mvs, "report", "--workspace_path", dense,
             "--PatchMatchStereo.num_threads", str(arguments.threads)], stdout=subprocess.DEVNULL)
        peak = cpu = 0
        while process.poll() is None:
            peak = proc.peak_bytes(process.pid) or peak
            cpu = proc.cpu_seconds(process.pid)
            time.sleep(0.02)
        seconds = time.monotonic() - begin
        page = (dense / "stereo/report.html").stat().st_size if process.returncode == 0 else 0
        print(f"exit {process.returncode}, {arguments.images} images of {arguments.size[0]}x{arguments.size[1]}: "
              f"{seconds:.1f} s, {cpu:.1f} CPU s, "
              f"peak {peak / proc.MIB:.0f} MiB, page {page / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
