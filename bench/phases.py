#!/usr/bin/env python3
"""Where the time of a run goes, and how it scales: hpm_mvs over one scene with several
numbers of threads. Prints a table and writes a JSON that compares across commits.

    bench/phases.py --hpm_mvs build/release/colmap_plugin/tool/hpm_mvs --scene data/workshop \\
        --threads 1 2 --out bench/results/phases.json [-- --Hpm.quality low]

Everything after -- goes to hpm_mvs. Needs nothing but a dense workspace.
"""
import argparse
import datetime
import json
import pathlib
import re
import resource
import subprocess
import sys
import tempfile

from suite import copy_workspace

MATCHING = ("basic", "prior", "geometric")  # phases that compute matching costs


def run(hpm_mvs, scene, threads, options):
    """The run record and the CPU seconds of the process."""
    with tempfile.TemporaryDirectory(prefix="hpm_phases_") as folder:
        dense = pathlib.Path(folder) / "dense"
        copy_workspace(scene, 1, dense)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [hpm_mvs, "patch_match_stereo", "--workspace_path", dense,
             "--PatchMatchStereo.num_threads", str(threads), "--Hpm.report", "0", *options],
            check=True, stdout=subprocess.DEVNULL,
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        record = json.loads((dense / "stereo/hpm_mvs/run.json").read_text())
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return record, cpu


def costs_per_pixel(record):
    """Mean over the images per pixel of full size, per kind of stage: photometric or
    geometric."""
    sums = {}
    for stages in record["images"].values():
        for name, stage in stages.items():
            kind = "geometric" if "geometric" in name else "photometric"
            level = re.match(r"level_(\d+)_", name)
            share = 0.25 ** int(level.group(1)) if level else 1
            sums[kind] = sums.get(kind, 0) + share * stage["cost_evaluations_per_pixel"]
    return {kind: total / len(record["images"]) for kind, total in sums.items()}


def serial_share(few, many):
    """Amdahl's, from the wall seconds of two runs: (threads, seconds) each."""
    (n, t), (m, u) = few, many
    ratio = u / t
    return (ratio / n - 1 / m) / (1 - 1 / m - ratio * (1 - 1 / n))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--hpm_mvs", required=True)
    parser.add_argument("--scene", type=pathlib.Path, required=True)
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--out", type=pathlib.Path)
    arguments = sys.argv[1:]
    options = []
    if "--" in arguments:
        at = arguments.index("--")
        options = arguments[at + 1 :]
        arguments = arguments[:at]
    args = parser.parse_args(arguments)

    results = {"date": datetime.date.today().isoformat(), "scene": args.scene.name,
               "options": options, "runs": {}}
    walls = []
    for threads in args.threads:
        record, cpu = run(args.hpm_mvs, args.scene, threads, options)
        phases = record["seconds_per_phase"]
        wall = record["seconds"]
        costs = record["cost_evaluations_per_pixel"]
        walls.append((threads, wall))
        results["runs"][threads] = {
            "backend": record["backend"], "wall_seconds": wall, "cpu_seconds": cpu,
            "seconds_per_phase": phases, "costs_per_pixel": costs,
            "costs_per_pixel_per_stage": costs_per_pixel(record),
            "peak_memory_bytes": record["peak_memory_bytes"],
        }
        print(f"\n{record['backend']}: {wall:.1f} s wall, {cpu:.1f} s CPU, {costs:.0f} costs per pixel, "
              f"peak {record['peak_memory_bytes'] / (1 << 20):.0f} MiB")
        print("| phase | seconds | share |\n|---|---|---|")
        for phase, seconds in sorted(phases.items(), key=lambda item: -item[1]):
            print(f"| {phase} | {seconds:.2f} | {100 * seconds / wall:.1f} % |")
        outside = wall - sum(phases.values())
        print(f"| outside | {outside:.2f} | {100 * outside / wall:.1f} % |")
        matching = sum(phases.get(phase, 0) for phase in MATCHING)
        print(f"share outside the matching phases: {100 * (1 - matching / wall):.1f} %")
    if len(walls) > 1:
        share = serial_share(walls[0], walls[-1])
        results["serial_share"] = share
        print(f"\n{walls[0][1] / walls[-1][1]:.2f} times faster with {walls[-1][0]} threads than with "
              f"{walls[0][0]}; serial share by Amdahl {100 * share:.1f} %")
    if args.out:
        args.out.parent.mkdir(parents=True, exist_ok=True)
        args.out.write_text(json.dumps(results, indent=1) + "\n")


if __name__ == "__main__":
    main()
