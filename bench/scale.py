#!/usr/bin/env python3
"""What large models cost: planning of many points, or many small images end to end.

Makes the workspace of an aerial survey (cameras in rows above a textured ground, each
point in the tracks of the cameras nearest to it), runs hpm_mvs on it and tells CPU
seconds and peak memory of planning (until the first image is worked on) and of the run.
Needs numpy.

    bench/scale.py --hpm_mvs build/release/colmap_plugin/tool/hpm_mvs \\
        --images 200 --points 5000000 --track 20 --planning_only
    bench/scale.py --hpm_mvs ... --images 2000 --points 200000 --track 10 \\
        --options --Hpm.quality low
"""
import argparse
import json
import os
import pathlib
import struct
import subprocess
import tempfile
import threading
import time
import zlib

import numpy as np

from proc import MIB, cpu_seconds, peak_bytes

SPACING = 10.0
HEIGHT = 50.0


def write_png(path, grey):
    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    height, width = grey.shape
    rows = np.zeros((height, width + 1), np.uint8)
    rows[:, 1:] = grey
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
        + chunk(b"IDAT", zlib.compress(rows.tobytes(), 1))
        + chunk(b"IEND", b"")
    )


def make(folder, num_images, num_points, track, width, height, sources, shuffle, seed=1):
    random = np.random.default_rng(seed)
    per_row = max(1, int(np.ceil(np.sqrt(num_images))))
    places = np.array([(i % per_row, i // per_row) for i in range(num_images)])
    centers = SPACING * places + random.normal(0, 0.5, (num_images, 2))
    for part in ("images", "sparse", "stereo"):
        (folder / part).mkdir(parents=True)
    names = [f"{i:06d}.png" for i in range(num_images)]

    # A pixel of the ground is a pixel of the images: nadir views are cut out of it.
    focal = 0.8 * width
    metres = HEIGHT / focal
    extent = (np.ptp(centers, axis=0) / metres).astype(int) + [width + 4, height + 4]
    ground = random.integers(0, 256, (extent[1] // 2 + 1, extent[0] // 2 + 1), np.uint8)
    ground = ground.repeat(2, 0).repeat(2, 1)
    for name, corner in zip(names, (centers - centers.min(axis=0)) / metres):
        col, row = corner.astype(int)
        write_png(folder / "images" / name, ground[row : row + height, col : col + width])

    with open(folder / "sparse/cameras.bin", "wb") as file:
        file.write(struct.pack("<QIiQQ4d", 1, 1, 1, width, height, focal, focal, width / 2, height / 2))
    with open(folder / "sparse/images.bin", "wb") as file:
        file.write(struct.pack("<Q", num_images))
        for i, name in enumerate(names):
            # Looking down: x stays, y and z are turned round.
            x, y = centers[i]
            file.write(struct.pack("<I7dI", i + 1, 0, 1, 0, 0, -x, y, HEIGHT, 1))
            file.write(name.encode() + b"\0" + struct.pack("<Q", 0))
    record = np.dtype(
        [("id", "<u8"), ("xyz", "<f8", 3), ("rgb", "u1", 3), ("error", "<f8"),
         ("length", "<u8"), ("track", [("image", "<u4"), ("point", "<u4")], track)]
    )
    grid = np.full((places[:, 1].max() + 1, per_row), -1)
    grid[places[:, 1], places[:, 0]] = np.arange(num_images)
    reach = int(np.ceil(np.sqrt(track)))
    offsets = np.array([(i, j) for j in range(-reach, reach + 1) for i in range(-reach, reach + 1)])
    with open(folder / "sparse/points3D.bin", "wb") as file:
        file.write(struct.pack("<Q", num_points))
        for begin in range(0, num_points, 250000):
            count = min(250000, num_points - begin)
            xy = random.uniform(centers.min(axis=0), centers.max(axis=0) + 1e-9, (count, 2))
            cells = np.rint(xy / SPACING).astype(int)[:, None, :] + offsets
            inside = ((cells >= 0) & (cells < grid.shape[::-1])).all(axis=2)
            cells = cells.clip(0, np.array(grid.shape[::-1]) - 1)
            images = np.where(inside, grid[cells[..., 1], cells[..., 0]], -1)
            distance = ((centers[images] - xy[:, None, :]) ** 2).sum(axis=2)
            distance[images < 0] = 1e9
            nearest = np.argpartition(distance, track - 1, axis=1)[:, :track]
            block = np.zeros(count, record)
            block["id"] = np.arange(begin + 1, begin + count + 1)
            block["xyz"][:, :2] = xy
            block["xyz"][:, 2] = random.normal(0, 0.5, count)
            block["length"] = track
            block["track"]["image"] = np.take_along_axis(images, nearest, 1) + 1
            file.write(block.tobytes())
    if shuffle:
        random.shuffle(names)
    (folder / "stereo/patch-match.cfg").write_text(
        "".join(f"{name}\n__auto__, {sources}\n" for name in names)
    )


def run(command, num_images, planning_only):
    begin = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    planned = False
    peaks = []
    number = 0
    peak = 0
    for line in process.stdout:
        peak = peak_bytes(process.pid) or peak
        if "Processing view" in line:
            if not planned:
                planned = True
                print(f"planning: {time.monotonic() - begin:.1f} s, {cpu_seconds(process.pid):.1f} CPU s, "
                      f"peak {peak / MIB:.0f} MiB", flush=True)
                if planning_only:
                    process.terminate()
            number += 1
            if number % max(1, num_images // 2) == 0:
                peaks.append(f"{number}: {peak / MIB:.0f}")
        elif not planned or "WARN" in line or "ERROR" in line:
            print(f"  {time.monotonic() - begin:6.1f} s {line.rstrip()}", flush=True)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    cpu = usage.ru_utime + usage.ru_stime
    print(f"exit {process.returncode} after {time.monotonic() - begin:.1f} s, {cpu:.1f} CPU s, "
          f"{1000 * cpu / num_images:.1f} ms per image, peak {peak / MIB:.0f} MiB")
    if not planning_only:
        print("peak MiB after so many images of all stages: " + ", ".join(peaks))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hpm_mvs", required=True)
    parser.add_argument("--images", type=int, default=200)
    parser.add_argument("--points", type=int, default=5000000)
    parser.add_argument("--track", type=int, default=20)
    parser.add_argument("--sources", type=int, default=20)
    parser.add_argument("--size", type=int, nargs=2, default=(64, 48))
    parser.add_argument("--shuffle", action="store_true", help="the order of patch-match.cfg")
    parser.add_argument("--planning_only", action="store_true")
    parser.add_argument("--workspace", type=pathlib.Path, help="kept, and used again if it exists")
    parser.add_argument("--options", nargs=argparse.REMAINDER, default=[])
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="hpm_scale_") as folder:
        dense = arguments.workspace or pathlib.Path(folder) / "dense"
        if not dense.exists():
            make(dense, arguments.images, arguments.points, arguments.track,
                 *arguments.size, arguments.sources, arguments.shuffle)
        run([arguments.hpm_mvs, "patch_match_stereo", "--workspace_path", dense,
             "--PatchMatchStereo.num_threads", "2", "--Hpm.report", "0", *arguments.options],
            arguments.images, arguments.planning_only)
        record = dense / "stereo/hpm_mvs/run.json"
        if record.exists():
            told = json.loads(record.read_text())
            print(", ".join(f"{told[key] / arguments.images:.2f} {key} per image"
                            for key in ("images_decoded", "depth_maps_read")))


if __name__ == "__main__":
    main()
