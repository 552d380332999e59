#!/usr/bin/env python3
"""Peak memory of hpm_mvs at several image sizes, beside the formula of
docs/architecture.md. All images are references with all others as sources; the run
is stopped after a few images of the last stage, which hold all that a run ever holds.

    bench/memory.py --hpm_mvs build/release/colmap_plugin/tool/hpm_mvs \\
        --scene room_hd --sizes 400 800 1600 --images 2
"""
import argparse
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

MIB = 1 << 20


def measure(hpm_mvs, scene, size, num_images):
    """(width, height, sources, peak bytes)"""
    with tempfile.TemporaryDirectory(prefix="hpm_memory_") as folder:
        dense = pathlib.Path(folder) / "dense"
        (dense / "stereo").mkdir(parents=True)
        for part in ("images", "sparse"):
            (dense / part).symlink_to((scene / part).resolve())
        names = (scene / "stereo/fusion.cfg").read_text().split()
        (dense / "stereo/patch-match.cfg").write_text(
            "".join(f"{name}\n__all__\n" for name in names)
        )
        shutil.copyfile(scene / "stereo/fusion.cfg", dense / "stereo/fusion.cfg")
        program = subprocess.Popen(
            [hpm_mvs, "patch_match_stereo", "--workspace_path", dense,
             "--PatchMatchStereo.max_image_size", str(size), "--Hpm.quality", "low",
             "--Hpm.report", "0"],
            stdout=subprocess.DEVNULL,
        )
        maps = dense / "stereo/depth_maps"
        pid = 0
        while pid == 0:  # not Popen.poll(), which would drop the child's usage
            time.sleep(0.05)
            pid, status, usage = os.wait4(program.pid, os.WNOHANG)
            done = sorted(maps.glob("*.geometric.bin"))
            if pid == 0 and len(done) >= num_images:
                os.kill(program.pid, signal.SIGINT)
                _, status, usage = os.wait4(program.pid, 0)
                break
        program.returncode = os.waitstatus_to_exitcode(status)
        if not done:
            sys.exit(f"hpm_mvs ended with {program.returncode} and without maps")
        width, height = done[0].read_bytes()[:32].split(b"&")[:2]
        return int(width), int(height), len(names) - 1, 1024 * usage.ru_maxrss


def formula(width, height, num_srcs):
    """The program, working memory, images and the sources' depth."""
    pixels = width * height
    working = pixels * (2 * num_srcs + 1 + 24 + 22)
    inputs = pixels * (num_srcs + 1 + 3 * num_srcs)
    return 80 * MIB + working + inputs


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--hpm_mvs", required=True)
    parser.add_argument("--scene", type=pathlib.Path, required=True)
    parser.add_argument("--sizes", type=int, nargs="+", default=[400, 800, 1600])
    parser.add_argument("--images", type=int, nargs="+", default=[2])
    args = parser.parse_args()
    print("| size | sources | images | measured MiB | formula MiB |\n|---|---|---|---|---|")
    for size in args.sizes:
        for images in args.images:
            width, height, srcs, peak = measure(args.hpm_mvs, args.scene, size, images)
            bound = formula(width, height, srcs)
            print(f"| {width}x{height} | {srcs} | {images} | {peak / MIB:.0f} | {bound / MIB:.0f} |",
                  flush=True)


if __name__ == "__main__":
    main()
