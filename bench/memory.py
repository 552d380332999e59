#!/usr/bin/env python3
"""Peak memory of hpm_mvs at several image sizes, beside the formula of
docs/architecture.md; computes two reference images with one iteration per pass.

    bench/memory.py --hpm_mvs build/release/colmap_plugin/tool/hpm_mvs \\
        --scene room_hd --sizes 400 800 1600
"""
import argparse
import json
import pathlib
import shutil
import subprocess
import tempfile

MIB = 1 << 20


def measure(hpm_mvs, scene, size, num_refs):
    """(width, height, sources, peak bytes)"""
    with tempfile.TemporaryDirectory(prefix="hpm_memory_") as folder:
        dense = pathlib.Path(folder) / "dense"
        (dense / "stereo").mkdir(parents=True)
        for part in ("images", "sparse"):
            (dense / part).symlink_to((scene / part).resolve())
        names = (scene / "stereo/fusion.cfg").read_text().split("\n")
        names = [name for name in names if name]
        (dense / "stereo/patch-match.cfg").write_text(
            "".join(f"{name}\n__all__\n" for name in names[:num_refs])
        )
        shutil.copyfile(scene / "stereo/fusion.cfg", dense / "stereo/fusion.cfg")
        subprocess.run(
            [hpm_mvs, "patch_match_stereo", "--workspace_path", dense,
             "--PatchMatchStereo.max_image_size", str(size), "--Hpm.num_iterations", "1",
             "--Hpm.num_geom_iterations", "1", "--Hpm.num_geom_passes", "1"],
            check=True, stdout=subprocess.DEVNULL,
        )
        record = json.loads((dense / "stereo/hpm_mvs/run.json").read_text())
        depth_map = dense / f"stereo/depth_maps/{names[0]}.geometric.bin"
        width, height = depth_map.read_bytes()[:32].split(b"&")[:2]
        return int(width), int(height), len(names) - 1, record["peak_memory_bytes"]


def formula(width, height, num_srcs, num_refs):
    """Working memory, images in the cache, depth maps of the sources."""
    pixels = width * height
    working = pixels * (2 * num_srcs + 1 + 40 + 16)
    cached = pixels * (num_srcs + 1) + 4 * pixels * min(num_refs, num_srcs)
    return 80 * MIB + working + cached


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--hpm_mvs", required=True)
    parser.add_argument("--scene", type=pathlib.Path, required=True)
    parser.add_argument("--sizes", type=int, nargs="+", default=[400, 800, 1600])
    parser.add_argument("--refs", type=int, nargs="+", default=[2])
    args = parser.parse_args()
    print("| size | sources | references | measured MiB | formula MiB |\n|---|---|---|---|---|")
    for size in args.sizes:
        for refs in args.refs:
            width, height, srcs, peak = measure(args.hpm_mvs, args.scene, size, refs)
            bound = formula(width, height, srcs, refs)
            print(f"| {width}x{height} | {srcs} | {refs} | {peak / MIB:.0f} | {bound / MIB:.0f} |",
                  flush=True)


if __name__ == "__main__":
    main()
