#!/usr/bin/env python3
"""The rule of docs/benchmarks.md as a gate: the default on all scenes, three seeds, against
the figures of the last accepted state. Ends with 1 when it fails. The six scenes of
docs/benchmarks.md take 22 CPU minutes by their table there.

    bench/gate.py --build build/release --scenes SCENES            # judge a change
    bench/gate.py --build build/release --scenes SCENES --renew    # once it is accepted

SCENES is a folder as bench/suite.py takes it; scenes without figures are run and named,
and judged by nothing.
"""
import argparse
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile

import suite

ACCEPTED = pathlib.Path(__file__).parent / "results/gate.json"
LEAST_NOISE = 0.3  # three seeds may lie closer together by chance


def run(args, out):
    command = [sys.executable, pathlib.Path(suite.__file__), "--build", args.build,
               "--scenes", args.scenes, "--methods", "hpm_plus", "--label", "now",
               "--seeds", str(args.seeds), "--out", out]
    if args.names:
        command += ["--names", args.names]
    status = subprocess.run(command, stdout=subprocess.DEVNULL).returncode
    if status != 0:  # the suite has said why
        sys.exit(status)
    return json.loads(out.read_text())["records"]


def group_means(records, scene, group):
    """Of each seed, the mean of a group's figures; empty if the scene has none."""
    means = []
    for record in records:
        if record["scene"] != scene:
            continue
        values = [v for name, v in suite.metrics_of(record).items() if name.split()[0] == group]
        if values:
            means.append(statistics.fmean(values))
    return means


def noise_of(*samples):
    """Two standard errors of the difference of means."""
    variance = sum(statistics.variance(s) / len(s) for s in samples if len(s) > 1)
    return max(LEAST_NOISE, 2 * variance ** 0.5)


def judge(now, accepted):
    """Lines to print, and what speaks against the change."""
    scenes = [s for s in dict.fromkeys(r["scene"] for r in now)
              if any(r["scene"] == s for r in accepted)]
    lines = ["| figure | mean | " + " | ".join(scenes) + " |", "|" + "---|" * (len(scenes) + 2)]
    failures = []
    for group in suite.GROUPS:
        cells, differences, noises = [], [], []
        for scene in scenes:
            mine, theirs = group_means(now, scene, group), group_means(accepted, scene, group)
            if not mine or not theirs:
                cells.append("-")
                continue
            difference = statistics.fmean(mine) - statistics.fmean(theirs)
            noise = noise_of(mine, theirs)
            differences.append(difference)
            noises.append(noise)
            cells.append(f"{difference:+.1f} ± {noise:.1f}")
            if difference < -noise:
                failures.append(f"{scene}: {group} {difference:+.1f} ± {noise:.1f}")
        if not differences:
            continue
        mean = statistics.fmean(differences)
        mean_noise = sum(n * n for n in noises) ** 0.5 / len(noises)
        if mean < -mean_noise:
            failures.append(f"mean over scenes: {group} {mean:+.2f} ± {mean_noise:.2f}")
        lines.append(f"| {group} | {mean:+.2f} ± {mean_noise:.2f} | " + " | ".join(cells) + " |")
    return lines, failures


def falling_figures(now, accepted):
    """The single figures (one share or threshold of one scene) that fall by more than their
    noise. Of more than a hundred some do so by chance, so they fail nothing: look at them again
    with more seeds."""
    falls = []
    for scene in dict.fromkeys(r["scene"] for r in now):
        mine, theirs = ([suite.metrics_of(r) for r in records if r["scene"] == scene]
                        for records in (now, accepted))
        if not theirs:
            continue
        for name in mine[0]:
            after, before = ([row[name] for row in rows] for rows in (mine, theirs))
            difference = statistics.fmean(after) - statistics.fmean(before)
            noise = noise_of(after, before)
            if difference < -noise:
                falls.append(f"{scene}: {name} {difference:+.1f} ± {noise:.1f}")
    return falls


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, default=pathlib.Path("build/release"))
    parser.add_argument("--scenes", type=pathlib.Path, required=True)
    parser.add_argument("--names", help="of the scenes, with commas; default: all of the folder")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--renew", action="store_true", help="these are the accepted figures from now on")
    args = parser.parse_args()
    accepted = json.loads(ACCEPTED.read_text())["records"] if ACCEPTED.exists() else []
    with tempfile.TemporaryDirectory(prefix="hpm_gate_") as folder:
        now = run(args, pathlib.Path(folder) / "suite.json")
    if args.renew:
        scenes = {r["scene"] for r in now}
        kept = [r for r in accepted if r["scene"] not in scenes]
        ACCEPTED.write_text(json.dumps({"records": kept + now}, indent=1) + "\n")
        print(f"{ACCEPTED}: {len(scenes)} scenes renewed, "
              f"{len({r['scene'] for r in kept})} kept")
        return
    unknown = {r["scene"] for r in now} - {r["scene"] for r in accepted}
    for scene in sorted(unknown):
        print(f"{scene}: no accepted figures; --renew takes these")
    lines, failures = judge(now, accepted)
    print("\n".join(lines))
    for fall in falling_figures(now, accepted):
        print(f"single figure, to be looked at with more seeds: {fall}")
    for failure in failures:
        print(f"falls by more than its noise: {failure}")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
