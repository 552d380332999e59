#!/usr/bin/env python3
"""How far the time left that a run tells is from the time it then took.

Runs hpm_mvs over a scene with a JSON log and prints, of all progress lines from a fifth
of the run on, the largest error of the time since the start and the time left together, as a
share of the whole time; and until a tenth is left, of the time left as a share of itself.
Both once more as if the clock were the process's CPU time and all work done told its speed:
that leaves out what others on the machine do meanwhile.

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

import proc
import suite

FROM = 0.2  # of the run; before, nothing is promised
UNTIL = 0.9  # the share of a little that is left says little


def measure(hpm_mvs, scene, options):
    """What the run took and its progress lines, with the CPU time at each."""
    with tempfile.TemporaryDirectory(prefix="hpm_eta_") as folder:
        dense = pathlib.Path(folder) / "dense"
        suite.copy_workspace(scene, 1, dense)
        begin = time.monotonic()
        process = subprocess.Popen(
            [hpm_mvs, "patch_match_stereo", "--workspace_path", dense,
             "--PatchMatchStereo.num_threads", "1", "--Hpm.report", "0",
             *options, "--Hpm.log_format", "json"],
            stdout=subprocess.PIPE, text=True)
        lines = []
        for text in process.stdout:
            line = json.loads(text)
            if line["event"] == "progress":
                lines.append({"time": line["time"], "cpu": proc.cpu_seconds(process.pid),
                              "fraction": line["fraction"], "left": line["seconds_left"],
                              "stage": line["stage"]})
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            sys.exit(f"hpm_mvs ended with {process.returncode}")
        return {"seconds": time.monotonic() - begin,
                "cpu_seconds": usage.ru_utime + usage.ru_stime, "progress": lines}


def largest_errors(whole, predictions):
    """Of pairs of time and time left: of the run, and of what was left, in percent."""
    of_run = [abs((at + left) / whole - 1) for at, left in predictions if at >= FROM * whole]
    of_left = [abs(left / (whole - at) - 1) for at, left in predictions
               if FROM * whole <= at <= UNTIL * whole]
    return 100 * max(of_run, default=0), 100 * max(of_left, default=0)


def report(record):
    seconds = record["seconds"]
    lines = [line for line in record["progress"] if line["left"] is not None]
    print(f"{record['scene']}: {seconds:.1f} s, {record['cpu_seconds']:.1f} CPU s, "
          f"options {' '.join(record['options'])}")
    print("| part of the run, % | of its CPU time, % | work done, % | left, s | in truth, s | stage |")
    print("|---|---|---|---|---|---|")
    shown = 0
    for line in lines:
        part = line["time"] / seconds
        if part >= shown / 10:
            print(f"| {100 * part:.0f} | {100 * line['cpu'] / record['cpu_seconds']:.0f} "
                  f"| {100 * line['fraction']:.0f} | {line['left']:.1f} "
                  f"| {seconds - line['time']:.1f} | {line['stage']} |")
            shown = int(10 * part) + 1
    for clock, (of_run, of_left) in {
        "the clock": largest_errors(seconds, [(line["time"], line["left"]) for line in lines]),
        "CPU time": largest_errors(
            record["cpu_seconds"],
            [(line["cpu"], line["cpu"] / line["fraction"] - line["cpu"])
             for line in lines if line["fraction"] > 0]),
    }.items():
        print(f"largest error from {100 * FROM:.0f} % on by {clock}: {of_run:.1f} % of the run; "
              f"until {100 * UNTIL:.0f} %: {of_left:.1f} % of what was left")


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
        record = {"scene": arguments.scene.name, "options": arguments.options,
                  **measure(arguments.hpm_mvs, arguments.scene, arguments.options),
                  "load_average": os.getloadavg()[0]}
        if arguments.out:
            arguments.out.write_text(json.dumps(record, indent=1) + "\n")
    report(record)


if __name__ == "__main__":
    main()
