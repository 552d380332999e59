#!/usr/bin/env python3
"""Runs methods over scenes and seeds, fuses with COLMAP, scores against ground truth and
says who is better by more than noise.

    bench/suite.py --build build/release --scenes data --methods hpm_plus,hpm,nesp \\
        --seeds 3 --reference hpm --out bench/results/suite.json [-- --Hpm.quality low]

The folder of --scenes holds dense workspaces with gt/depth_maps and, for F1,
gt/points.ply, or with both in gt.tar.xz. A scene's suite.json may name its F1 thresholds
(model units), the min_num_pixels of its fusion and which of its images take part; see
SceneSettings. Everything after -- goes to hpm_mvs. Maps are written unfiltered, so that every pixel counts
(-- --PatchMatchStereo.filter 1 judges them as published); COLMAP's fusion does its own checks. What --out holds already is not run again, so a second call adds to it.
With --only_report nothing is run.
"""
import argparse
import concurrent.futures
import dataclasses
import datetime
import json
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile

# Neither the filter nor the page for people is measured.
UNLESS_GIVEN = {"--PatchMatchStereo.filter": 0, "--Hpm.report": 0}
PARTS = ("all", "low_texture", "rest", "edges")  # of eval_depth
DEPTH_SHARES = {"0.5%": 2, "1%": 3, "2%": 4, "5%": 5}  # index into eval_depth's thresholds


@dataclasses.dataclass
class SceneSettings:
    thresholds: list = dataclasses.field(default_factory=lambda: [0.01, 0.02, 0.05])
    min_num_pixels: int = 5
    every: int = 1  # every n-th image takes part
    # The first of DEPTH_SHARES that the truth is good enough for.
    finest_share: str = "0.5%"


# The scenes that the project is developed on; any other reads suite.json.
KNOWN_SCENES = {
    "room": SceneSettings(),
    "room_hd": SceneSettings(),
    "room_half": SceneSettings([0.02, 0.05, 0.1]),
    "workshop": SceneSettings(),
    "studio": SceneSettings(min_num_pixels=3),
    "street": SceneSettings([0.05, 0.1, 0.25]),
    "aerial": SceneSettings([0.2, 0.4, 1.0]),
    "kitchen30": SceneSettings(finest_share="2%"),
    "holo_table": SceneSettings(finest_share="2%"),
    "apc_shelf": SceneSettings(finest_share="2%"),
}


def settings_of(scene):
    path = scene / "suite.json"
    if path.exists():
        return SceneSettings(**json.loads(path.read_text()))
    return KNOWN_SCENES.get(scene.name, SceneSettings())


def run(command, log):
    """CPU seconds of the command; ends the program when it fails."""
    with open(log, "a", encoding="utf-8") as out:
        child = subprocess.Popen([str(c) for c in command], stdout=out, stderr=out)
        _, status, usage = os.wait4(child.pid, 0)
    if os.waitstatus_to_exitcode(status) != 0:
        last_words = log.read_text(encoding="utf-8", errors="replace").splitlines()[-5:]
        raise RuntimeError("\n".join([f"{command[0]} failed:", *last_words]))
    return usage.ru_utime + usage.ru_stime


def copy_workspace(scene, every, folder):
    """Our own stereo folder; images, model and truth stay where they are."""
    (folder / "stereo").mkdir(parents=True)
    for part in ("images", "sparse"):
        (folder / part).symlink_to((scene / part).resolve())
    if (scene / "gt").is_dir():
        (folder / "gt").symlink_to((scene / "gt").resolve())
    else:
        subprocess.run(["tar", "-xf", scene / "gt.tar.xz", "-C", folder], check=True)
    names = (scene / "stereo/fusion.cfg").read_text().split("\n")
    kept = [name for name in names if name.strip()][::every]
    (folder / "stereo/fusion.cfg").write_text("\n".join(kept) + "\n")
    if every == 1:
        shutil.copyfile(scene / "stereo/patch-match.cfg", folder / "stereo/patch-match.cfg")
    else:
        problems = (f"{ref}\n" + ", ".join(n for n in kept if n != ref) + "\n" for ref in kept)
        (folder / "stereo/patch-match.cfg").write_text("".join(problems))


def score(build, scene, method, seed, options, keep):
    settings = settings_of(scene)
    with tempfile.TemporaryDirectory(prefix="hpm_suite_") as temporary:
        folder = pathlib.Path(temporary) / "dense"
        copy_workspace(scene, settings.every, folder)
        log = folder / "log.txt"
        cpu_seconds = run(
            [build / "colmap_plugin/tool/hpm_mvs", "patch_match_stereo", "--workspace_path", folder,
             "--random_seed", seed, "--Hpm.method", method, "--PatchMatchStereo.num_threads", 1,
             *(word for pair in UNLESS_GIVEN.items() if pair[0] not in options for word in pair),
             *options], log)
        record = json.loads((folder / "stereo/hpm_mvs/run.json").read_text())
        result = {
            "scene": scene.name, "method": method, "seed": seed, "cpu_seconds": cpu_seconds,
            "costs_per_pixel": record["cost_evaluations_per_pixel"],
            "thresholds": settings.thresholds, "finest_share": settings.finest_share,
        }
        run([build / "bench/eval_depth", folder, "--json", folder / "depth.json"], log)
        depth = json.loads((folder / "depth.json").read_text())
        result["normal_error_deg"] = depth["all"]["median_normal_error_deg"]
        for part in PARTS:
            result[part] = {share: 100 * depth[part]["within"][i] for share, i in DEPTH_SHARES.items()}
            result[part]["density"] = 100 * depth[part]["density"]
        truth = folder / "gt/points.ply"
        if truth.exists():
            cloud = folder / "fused.ply"
            run(["colmap", "stereo_fusion", "--workspace_path", folder, "--output_path", cloud,
                 "--StereoFusion.num_threads", 1,
                 "--StereoFusion.min_num_pixels", settings.min_num_pixels], log)
            run([build / "bench/eval_cloud", cloud, truth, "--json",
                 folder / "cloud.json", "--thresholds", ",".join(map(str, settings.thresholds))], log)
            scores = json.loads((folder / "cloud.json").read_text())["scores"]
            for metric in ("f1", "accuracy", "completeness"):
                result[metric] = [100 * s[metric] for s in scores]
        if keep:
            kept = keep / f"{scene.name}_{method}_{seed}"
            shutil.rmtree(kept, ignore_errors=True)
            shutil.copytree(folder, kept, symlinks=True)
    return result


def metrics_of(record):
    """Name -> value of all that a person would notice, higher is better."""
    shares = list(DEPTH_SHARES)
    values = {}
    for part in PARTS:
        for share in shares[shares.index(record["finest_share"]):]:
            values[f"{part} {share}"] = record[part][share]
    for metric in ("f1", "accuracy", "completeness"):
        for threshold, value in zip(record["thresholds"], record.get(metric, [])):
            values[f"{metric} {threshold:g}"] = value
    return values


class Results:
    def __init__(self, records):
        self.records = records
        self.scenes = list(dict.fromkeys(r["scene"] for r in records))
        self.methods = list(dict.fromkeys(r["method"] for r in records))

    def of(self, scene, method):
        return [r for r in self.records if r["scene"] == scene and r["method"] == method]

    def mean(self, scene, method):
        rows = [metrics_of(r) for r in self.of(scene, method)]
        return {name: statistics.fmean(row[name] for row in rows) for name in rows[0]} if rows else None

    def noise(self, scene, method, name):
        """Twice the standard error over seeds; None for one seed."""
        values = [metrics_of(r)[name] for r in self.of(scene, method)]
        return 2 * statistics.stdev(values) / len(values) ** 0.5 if len(values) > 1 else None


def slashed(values):
    return " / ".join(f"{v:.1f}" for v in values)


def scene_table(results):
    """Markdown: one row per scene and method, means over seeds."""
    lines = ["| scene | method | all 0.5 / 1 / 2 / 5 % | low texture | textured | edges | F1 | accuracy "
             "| completeness | CPU s | costs per pixel |", "|" + "---|" * 11]
    for scene in results.scenes:
        for method in results.methods:
            rows = results.of(scene, method)
            if not rows:
                continue
            cells = [slashed(statistics.fmean(r[part][s] for r in rows) for s in DEPTH_SHARES)
                     for part in PARTS]
            for metric in ("f1", "accuracy", "completeness"):
                cells.append(slashed(statistics.fmean(v) for v in zip(*(r[metric] for r in rows)))
                             if metric in rows[0] else "-")
            cells += [f"{statistics.fmean(r[key] for r in rows):.0f}"
                      for key in ("cpu_seconds", "costs_per_pixel")]
            lines.append(f"| {scene} | {method} | " + " | ".join(cells) + " |")
    return lines


GROUPS = ("f1", "accuracy", "completeness", "all", "low_texture", "rest", "edges")


def group_differences(results, method, reference, group):
    """(difference, noise, scene, name) of every metric of the group on every scene."""
    differences = []
    for scene in results.scenes:
        mine, theirs = results.mean(scene, method), results.mean(scene, reference)
        if not mine or not theirs:
            continue
        for name in mine:
            if name.split()[0] != group:
                continue
            noises = [n for m in (method, reference)
                      if (n := results.noise(scene, m, name)) is not None]
            noise = sum(n * n for n in noises) ** 0.5 if noises else None
            differences.append((mine[name] - theirs[name], noise, scene, name))
    return differences


def reference_table(results, reference):
    """Markdown: mean and worst difference to the reference method over scenes."""
    lines = [f"Against {reference}: mean difference; worst and where, with its noise; how many of the "
             "metrics fall by more than their noise (or by more than 1 where there is one seed).", "",
             "| method | " + " | ".join(GROUPS) + " |", "|" + "---|" * (len(GROUPS) + 1)]
    for method in results.methods:
        if method == reference:
            continue
        cells = []
        for group in GROUPS:
            differences = group_differences(results, method, reference, group)
            if not differences:
                cells.append("-")
                continue
            worst = min(differences)
            lost = sum(d < -(1 if noise is None else max(noise, 0.3)) for d, noise, *_ in differences)
            noise = "" if worst[1] is None else f" ± {worst[1]:.1f}"
            cells.append(f"{statistics.fmean(d[0] for d in differences):+.1f}; {worst[0]:+.1f}{noise} "
                         f"({worst[2]} {worst[3].split()[1]}); {lost} of {len(differences)}")
        lines.append(f"| {method} | " + " | ".join(cells) + " |")
    return lines


def report(records, reference):
    results = Results(records)
    lines = scene_table(results)
    if reference in results.methods:
        lines += [""] + reference_table(results, reference)
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, default=pathlib.Path("build/release"))
    parser.add_argument("--scenes", type=pathlib.Path, help="folder of scenes")
    parser.add_argument("--names", help="of the scenes, with commas; default: all of the folder")
    parser.add_argument("--methods", default="hpm_plus,hpm,nesp")
    parser.add_argument("--label", help="name of the method in the results, where options change it")
    parser.add_argument("--seeds", type=int, default=3, help="number of seeds, from 0")
    parser.add_argument("--reference", default="hpm")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="runs of one thread each")
    parser.add_argument("--keep", type=pathlib.Path, help="keep the workspaces in this folder")
    parser.add_argument("--only_report", action="store_true")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    arguments, options = sys.argv[1:], []
    if "--" in arguments:
        at = arguments.index("--")
        arguments, options = arguments[:at], arguments[at + 1:]
    args = parser.parse_args(arguments)

    data = {"date": datetime.date.today().isoformat(), "records": []}
    if args.out.exists():
        data = json.loads(args.out.read_text())
    if not args.only_report:
        scenes = [s for s in sorted(args.scenes.iterdir())
                  if (s / "gt").is_dir() or (s / "gt.tar.xz").exists()]
        if args.names:
            scenes = [args.scenes / name for name in args.names.split(",")]
        done = {(r["scene"], r["method"], r["seed"]) for r in data["records"]}
        with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
            futures = {}
            for seed in range(args.seeds):
                for scene in scenes:
                    for method in args.methods.split(","):
                        label = args.label or method
                        if (scene.name, label, seed) not in done:
                            futures[pool.submit(score, args.build, scene, method, seed, options,
                                                args.keep)] = label
            for future in concurrent.futures.as_completed(futures):
                try:
                    record = future.result()
                except RuntimeError as error:
                    pool.shutdown(cancel_futures=True)
                    sys.exit(str(error))
                record["method"] = futures[future]
                record["options"] = options
                data["records"].append(record)
                print(f"{record['scene']} {record['method']} seed {record['seed']} done",
                      file=sys.stderr, flush=True)
                args.out.parent.mkdir(parents=True, exist_ok=True)
                args.out.write_text(json.dumps(data, indent=1) + "\n")
    print(report(data["records"], args.reference))


if __name__ == "__main__":
    main()
