#!/usr/bin/env python3
"""Runs methods over scenes with ground truth, fuses with COLMAP, scores, and writes
a table (stdout) and a JSON.

    bench/run_methods.py --build build/release --scenes data_folder/room_half \\
        --methods acmh,nesp,hpm --out bench/results/ablation.json [-- --Hpm.num_levels 3]

A scene is a dense workspace with gt/depth_maps and, for F1, gt/points.ply. Everything
after -- goes to hpm_mvs. Maps are written unfiltered unless the options say otherwise,
so that every pixel counts; COLMAP's fusion does its own checks.
"""
import argparse
import datetime
import json
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile

METHODS = (
    "acmh nsp esp nesp nesp_pa hpm_fast_no_nesp hpm_no_nesp hpm_fast hpm "
    "acmm acmp acmmp acmm_nesp acmp_nesp acmmp_nesp"
).split()


def run(command, log):
    with open(log, "a", encoding="utf-8") as out:
        code = subprocess.run([str(c) for c in command], stdout=out, stderr=out).returncode
    if code != 0:
        last_words = log.read_text(encoding="utf-8", errors="replace").splitlines()[-5:]
        sys.exit("\n".join([f"{command[0]} ended with {code}:", *last_words]))


def copy_workspace(scene, folder):
    """Our own stereo folder; images, model and truth stay where they are."""
    (folder / "stereo").mkdir(parents=True)
    for part in ("images", "sparse", "gt"):
        (folder / part).symlink_to((scene / part).resolve())
    for cfg in (scene / "stereo").glob("*.cfg"):
        shutil.copyfile(cfg, folder / "stereo" / cfg.name)


def score(build, scene, method, options, min_num_pixels, folder):
    copy_workspace(scene, folder)
    log = folder / "log.txt"
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run(
        [build / "colmap_plugin/tool/hpm_mvs", "patch_match_stereo", "--workspace_path", folder,
         "--Hpm.method", method, *options],
        log,
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    record = json.loads((folder / "stereo/hpm_mvs/run.json").read_text())
    result = {
        "cpu_seconds": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime,
        "ncc_evaluations_per_pixel": record["ncc_evaluations_per_pixel"],
        "backend": record["backend"],
    }
    run([build / "bench/eval_depth", folder, "--json", folder / "depth.json"], log)
    result["depth"] = json.loads((folder / "depth.json").read_text())
    if (scene / "gt/points.ply").exists():
        for pixels in min_num_pixels:
            cloud = folder / f"fused_{pixels}.ply"
            run(
                ["colmap", "stereo_fusion", "--workspace_path", folder, "--output_path", cloud,
                 "--StereoFusion.num_threads", 1, "--StereoFusion.min_num_pixels", pixels],
                log,
            )
            run([build / "bench/eval_cloud", cloud, scene / "gt/points.ply",
                 "--json", folder / "cloud.json"], log)
            result[f"cloud_min_num_pixels_{pixels}"] = json.loads(
                (folder / "cloud.json").read_text()
            )
    return result


def table(results):
    """Markdown: one row per method and scene."""
    lines = [
        "| scene | method | costs/px | all 1 % | 2 % | 5 % | low 2 % | normal | F1 (acc/comp) |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for scene, rows in results["scenes"].items():
        for method, row in rows.items():
            depth = row["depth"]
            normal = depth["all"]["median_normal_error_deg"]  # None without truth
            within = [100 * share for share in depth["all"]["within"]]
            clouds = [row[key] for key in row if key.startswith("cloud_")]
            f1 = "; ".join(
                f"{s['threshold']:g}: {100 * s['f1']:.1f} "
                f"({100 * s['accuracy']:.1f}/{100 * s['completeness']:.1f})"
                for cloud in clouds[:1]
                for s in cloud["scores"]
            )
            lines.append(
                f"| {scene} | {method} | {row['ncc_evaluations_per_pixel']:.0f} "
                f"| {within[3]:.1f} | {within[4]:.1f} | {within[5]:.1f} "
                f"| {100 * depth['low_texture']['within'][4]:.1f} "
                f"| {normal if normal is None else format(normal, '.1f')} | {f1} |"
            )
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, default=pathlib.Path("build/release"))
    parser.add_argument("--scenes", type=pathlib.Path, nargs="+", required=True)
    parser.add_argument("--methods", default=",".join(METHODS))
    parser.add_argument("--min_num_pixels", type=int, nargs="+", default=[5])
    parser.add_argument("--out", type=pathlib.Path, required=True)
    arguments = sys.argv[1:]
    options = ["--PatchMatchStereo.filter", "0"]
    if "--" in arguments:
        at = arguments.index("--")
        options += arguments[at + 1 :]
        arguments = arguments[:at]
    args = parser.parse_args(arguments)

    results = {
        "date": datetime.date.today().isoformat(),
        "options": options,
        "scenes": {},
    }
    for scene in args.scenes:
        rows = results["scenes"].setdefault(scene.name, {})
        for method in args.methods.split(","):
            with tempfile.TemporaryDirectory(prefix="hpm_bench_") as folder:
                rows[method] = score(
                    args.build, scene, method, options, args.min_num_pixels,
                    pathlib.Path(folder) / "dense",
                )
            print(f"{scene.name} {method} done", file=sys.stderr, flush=True)
            args.out.parent.mkdir(parents=True, exist_ok=True)
            args.out.write_text(json.dumps(results, indent=1) + "\n")
    print(table(results))


if __name__ == "__main__":
    main()
