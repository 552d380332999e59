#!/usr/bin/env python3
"""What matching one large image costs: the photometric stages, all levels, of one
reference of a rendered scene with texture at the scale of its pixels. Several builds run
in turn on the same machine, one thread each.

    bench/large_images.py --make_scene build/release/tests/scenes/hpm_make_scene \\
        --hpm_mvs build/release/colmap_plugin/tool/hpm_mvs [BEFORE/hpm_mvs] \\
        --width 3200 --height 2130 --sources 10 --out bench/results/large-images.json
"""
import argparse
import datetime
import json
import pathlib
import shutil
import statistics
import subprocess
import tempfile


def make_scene(args, folder):
    """Rendering takes minutes; a finished scene of this name is used again."""
    views = args.sources + 1
    scene = folder / f"{args.scene}_{args.width}x{args.height}_{views}"
    if not scene.exists():
        unfinished = scene.with_suffix(".unfinished")
        shutil.rmtree(unfinished, ignore_errors=True)
        subprocess.run(
            [args.make_scene, args.scene, unfinished, "--views", str(views),
             "--width", str(args.width), "--height", str(args.height)], check=True)
        unfinished.rename(scene)
    return scene


def run(hpm_mvs, scene, options):
    """The record of the one image."""
    names = (scene / "stereo/fusion.cfg").read_text().split()
    reference = names[len(names) // 2]
    with tempfile.TemporaryDirectory(prefix="hpm_large_") as folder:
        dense = pathlib.Path(folder)
        (dense / "stereo").mkdir()
        for part in ("images", "sparse"):
            (dense / part).symlink_to((scene / part).resolve())
        (dense / "stereo/patch-match.cfg").write_text(f"{reference}\n__all__\n")
        subprocess.run(
            [hpm_mvs, "patch_match_stereo", "--workspace_path", dense,
             "--PatchMatchStereo.num_threads", "1", "--PatchMatchStereo.geom_consistency", "0",
             "--PatchMatchStereo.filter", "0", "--Hpm.device", "cpu", "--Hpm.report", "0", *options],
            check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        return json.loads((dense / "stereo/hpm_mvs/run.json").read_text())["images"][reference]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--hpm_mvs", nargs="+", required=True)
    parser.add_argument("--make_scene", required=True)
    parser.add_argument("--scene", default="depth_step")
    parser.add_argument("--width", type=int, default=3200)
    parser.add_argument("--height", type=int, default=2130)
    parser.add_argument("--sources", type=int, default=10)
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("build/large_images"))
    parser.add_argument("--options", nargs="*", default=[], help="of hpm_mvs, pairs of words")
    parser.add_argument("--out", type=pathlib.Path)
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    scene = make_scene(args, args.folder)

    runs = {program: [] for program in args.hpm_mvs}
    for _ in range(args.rounds):
        for program in args.hpm_mvs:
            runs[program].append(run(program, scene, args.options))
    results = {"date": datetime.date.today().isoformat(), "scene": scene.name,
               "options": args.options, "runs": runs}
    print("| program | stage | costs per pixel | seconds, each round | ns per cost |\n|---|---|---|---|---|")
    for program, records in runs.items():
        for stage, record in records[0].items():
            level = int(stage.split("_")[1]) if stage.startswith("level_") else 0
            costs = record["cost_evaluations_per_pixel"]
            seconds = [sum(r[stage]["seconds"].values()) for r in records]
            pixels = (args.width >> level) * (args.height >> level)
            nanoseconds = 1e9 * statistics.median(seconds) / max(costs * pixels, 1)
            print(f"| {program} | {stage} | {costs:.0f} | "
                  + ", ".join(f"{s:.1f}" for s in seconds) + f" | {nanoseconds:.0f} |")
    if args.out:
        args.out.parent.mkdir(parents=True, exist_ok=True)
        args.out.write_text(json.dumps(results, indent=1) + "\n")


if __name__ == "__main__":
    main()
