#!/usr/bin/env python3
"""Registers, stack, spills and shared memory of every kernel on every target, as a
markdown table; needs nvcc, no card.

    bench/gpu/ptxas_report.py [--arch 75 80 86 89 90]
"""
import argparse
import pathlib
import re
import shutil
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SOURCES = ("cuda/sweep_texture.cu", "cuda/sweep_quad.cu", "cuda/image_kernels.cu")
KINDS = {"0": "initialise", "1": "update", "2": "follow", "3": "median", "4": "filter"}


def short_name(name):
    """E.g. "PooledSweep update, TextureSampler" of a demangled signature."""
    match = re.search(r"(\w+)(<.*?>)?\(", name.replace("hpm::", "").replace("(anonymous namespace)::", "")
                      .replace("(SweepKind)", "kind "))
    arguments = re.sub(r"kind (\d)", lambda m: KINDS[m[1]], (match[2] or "").strip("<>"))
    return f"{match[1]} {arguments}".strip()


def parse(text):
    """[(kernel, registers, stack, spill stores, spill loads, shared)] of ptxas -v."""
    rows, kernel, frame = [], None, None
    for line in text.splitlines():
        if match := re.search(r"Compiling entry function '(.*)' for", line):
            kernel, frame = match[1], None
        elif match := re.search(
            r"(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads", line
        ):
            if frame is None:
                frame = match.groups()
        elif match := re.search(r"Used (\d+) registers", line):
            shared = re.search(r"(\d+) bytes smem", line)
            rows.append((kernel, match[1], *frame, shared[1] if shared else "0"))
            frame = None
    return rows


def report(nvcc, arch, source):
    with tempfile.TemporaryDirectory() as folder:
        result = subprocess.run(
            [nvcc, "-std=c++17", "-O3", "-ftz=true", "-prec-div=false", "-prec-sqrt=false", "-gencode", f"arch=compute_{arch},code=sm_{arch}",
             "-Xptxas", "-v", f"-I{ROOT}", "-c", ROOT / source, "-o", f"{folder}/out.o"],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=True,
        )
    text = subprocess.run(["c++filt"], input=result.stdout, stdout=subprocess.PIPE, text=True,
                          check=True).stdout
    return parse(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--arch", nargs="+", default=["75", "80", "86", "89", "90"])
    args = parser.parse_args()
    nvcc = shutil.which("nvcc") or "/usr/local/cuda/bin/nvcc"
    print("| kernel | sm | registers | stack | spill stores / loads | shared |")
    print("|---|---|---|---|---|---|")
    for source in SOURCES:
        for arch in args.arch:
            for kernel, registers, stack, stores, loads, shared in report(nvcc, arch, source):
                print(f"| {short_name(kernel)} | {arch} | {registers} | {stack} | {stores} / {loads} "
                      f"| {shared} |", flush=True)


if __name__ == "__main__":
    main()
