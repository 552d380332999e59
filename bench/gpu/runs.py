#!/usr/bin/env python3
"""Whole runs of hpm_mvs on the card and on the CPU; called by bench/gpu_bench.sh.

    bench/gpu/runs.py --carry build/gpu_carry --out runs.json [--scenes NAME,...] [--only WORD,...]

Workspaces are those of data/ and of the carried folder scenes/; where truth is known, depth
is judged. --only: those runs whose name has one of the words. A run on two threads of the
CPU, the yardstick, goes on beside the others. The JSON is written after each run.
"""
import argparse
import collections
import json
import pathlib
import shutil
import subprocess
import tarfile
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
CUDA = ["--Hpm.device", "cuda"]
# name: arguments; in order of what one wants to know first.
RUNS = {
    "cuda hpm_plus": CUDA,
    "cuda hpm": [*CUDA, "--Hpm.method", "hpm"],
    "cuda hpm_fast": [*CUDA, "--Hpm.method", "hpm_fast"],
    "cuda hpm_plus, low": [*CUDA, "--Hpm.quality", "low"],
    "cuda hpm_plus, 12 in flight": [*CUDA, "--Hpm.gpu_images", "12"],
    "cuda hpm_plus, low, one kind of maps": [*CUDA, "--Hpm.quality", "low", "--Hpm.keep_photometric", "0"],
    "cuda hpm_plus, 1 in flight": [*CUDA, "--Hpm.gpu_images", "1"],
}
CPU_RUN = {"cpu hpm_plus, 2 threads": ["--Hpm.device", "cpu", "--PatchMatchStereo.num_threads", "2"]}


def unpack(scene, folder):
    for part in ("images", "sparse", "stereo"):
        shutil.copytree(scene / part, folder / part)
    if (scene / "gt.tar.xz").exists():
        with tarfile.open(scene / "gt.tar.xz") as archive:
            archive.extractall(folder, filter="data")


def summed_phases(record):
    """Seconds per image by stage and phase, of the host and of the card, and costs per
    pixel by stage."""
    seconds, card, costs = (collections.Counter() for _ in range(3))
    images = record["images"].values()
    for stages in images:
        for stage, figures in stages.items():
            costs[stage] += figures["cost_evaluations_per_pixel"] / len(images)
            for sums, times in (seconds, figures["seconds"]), (card, figures.get("device_seconds", {})):
                for phase, value in times.items():
                    sums[f"{stage}/{phase}"] += value / len(images)
    rounded = [{name: round(value, 4) for name, value in sums.items()} for sums in (seconds, card, costs)]
    return dict(zip(("host_seconds_per_image", "card_seconds_per_image", "costs_per_pixel"), rounded))


def run(carry, scene, name, arguments):
    with tempfile.TemporaryDirectory(prefix="hpm_runs_") as temporary:
        folder = pathlib.Path(temporary)
        unpack(scene, folder)
        start = time.monotonic()
        done = subprocess.run(
            [carry / "bin/hpm_mvs", "patch_match_stereo", "--workspace_path", folder,
             "--PatchMatchStereo.filter", "0", *arguments],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")
        seconds = time.monotonic() - start
        result = {"scene": scene.name, "run": name, "arguments": arguments, "exit": done.returncode,
                  "seconds": round(seconds, 2)}
        if done.returncode != 0:
            return {**result, "log": done.stdout[-3000:]}
        record = json.loads((folder / "stereo/hpm_mvs/run.json").read_text())
        result.update(images=len(record["images"]), seconds_per_image=round(seconds / len(record["images"]), 3),
                      backend=record["backend"], log=done.stdout[-1500:], **summed_phases(record))
        if (folder / "gt").exists():
            subprocess.run([carry / "bin/eval_depth", folder, "--json", folder / "depth.json"],
                           check=True, stdout=subprocess.DEVNULL)
            result["depth"] = {part: figures["within"] for part, figures
                               in json.loads((folder / "depth.json").read_text()).items()
                               if isinstance(figures, dict) and "within" in figures}
        return result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--carry", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--scenes", default="", help="default: all")
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    scenes = [path for folder in (ROOT / "data", options.carry / "scenes")
              for path in sorted(folder.iterdir()) if (path / "images").is_dir()]
    if options.scenes:
        scenes = [scene for scene in scenes if scene.name in options.scenes.split(",")]
    wanted = {name: arguments for name, arguments in RUNS.items()
              if any(word in name for word in options.only.split(","))}
    results, lock = [], threading.Lock()

    def add(*job):
        result = run(options.carry, *job)
        with lock:
            results.append(result)
            options.out.write_text(json.dumps(results, indent=1))
        print(f"{result['scene']}: {result['run']}: exit {result['exit']}, {result['seconds']} s,"
              f" {result.get('seconds_per_image')} s/image, of the card"
              f" {sum(result.get('card_seconds_per_image', {}).values()):.3f}", flush=True)
        if result["exit"] != 0:
            print(result["log"], flush=True)
        elif "depth" in result:
            print("   within", {part: [round(100 * share, 1) for share in shares]
                                for part, shares in result["depth"].items()}, flush=True)

    yardstick = threading.Thread(target=lambda: [
        add(scene, *item) for scene in scenes if (scene / "gt.tar.xz").exists() for item in CPU_RUN.items()],
        daemon=True)
    yardstick.start()
    for name, arguments in wanted.items():
        for scene in scenes:
            add(scene, name, arguments)
    yardstick.join()


if __name__ == "__main__":
    main()
