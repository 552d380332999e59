#!/usr/bin/env python3
"""How far the time left that a run tells is from the time it then took.

Runs hpm_mvs over a scene with a JSON log and prints, of all progress lines from a fifth
of the run on, the largest error of the time since the start and the time left together,
as a share of the whole time.

    bench/eta.py --hpm_mvs build/release/colmap_plugin/tool/hpm_mvs --scene data/workshop \\
        [--out eta.json] [-- --PatchMatchStereo.max_image_size 320]
    bench/eta.py --only_report eta.json

Everything after -- goes to hpm_mvs, which gets one thread unless it says otherwise there.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import suite

FROM = 0.2  # of the run; before, nothing is promised


def progress_of(hpm_mvs, scene, options):
    """Progress lines with the fields time, fraction, left and stage, and the whole time."""
    with tempfile.TemporaryDirectory(prefix="hpm_eta_") as folder:
        dense = pathlib.Path(folder) / "dense"
        suite.copy_workspace(scene, 1, dense)
        begin = time.monotonic()
        run = subprocess.run(
            [hpm_mvs, "patch_match_stereo", "--workspace_path", dense,
             "--PatchMatchStereo.num_threads", "1", "--Hpm.report", "0",
             *options, "--Hpm.log_format", "json"],
            stdout=subprocess.PIPE, text=True, check=True)
        seconds = time.monotonic() - begin
    lines = [json.loads(line) for line in run.stdout.splitlines()]
    return seconds, [
        {"time": line["time"], "fraction": line["fraction"], "left": line["seconds_left"],
         "stage": line["stage"]}
        for line in lines if line["event"] == "progress"]


def report(record):
    seconds = record["seconds"]
    print(f"{record['scene']}: {seconds:.1f} s, options {' '.join(record['options'])}")
    print("| part of the run, % | work done, % | left, s | in truth, s | error, % of the run | stage |")
    print("|---|---|---|---|---|---|")
    worst, shown = 0, 0
    for line in record["progress"]:
        if line["left"] is None:
            continue
        part = line["time"] / seconds
        error = (line["time"] + line["left"]) / seconds - 1
        if part >= FROM:
            worst = max(worst, abs(error))
        if part >= shown / 10:
            print(f"| {100 * part:.0f} | {100 * line['fraction']:.0f} | {line['left']:.1f} "
                  f"| {seconds - line['time']:.1f} | {100 * error:+.1f} | {line['stage']} |")
            shown = int(10 * part) + 1
    print(f"largest error from {100 * FROM:.0f} % of the run on: {100 * worst:.1f} % of the run")
    return worst


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--hpm_mvs", type=pathlib.Path)
    parser.add_argument("--scene", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, help="what was measured, as JSON")
    parser.add_argument("--only_report", type=pathlib.Path, help="of such a file")
    parser.add_argument("options", nargs="*", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.only_report:
        record = json.loads(arguments.only_report.read_text())
    else:
        if not (arguments.hpm_mvs and arguments.scene):
            parser.error("--hpm_mvs and --scene are needed")
        seconds, progress = progress_of(arguments.hpm_mvs, arguments.scene, arguments.options)
        record = {"scene": arguments.scene.name, "options": arguments.options, "seconds": seconds,
                  "load_average": os.getloadavg()[0], "progress": progress}
        if arguments.out:
            arguments.out.write_text(json.dumps(record, indent=1) + "\n")
    report(record)


if __name__ == "__main__":
    sys.exit(main())
