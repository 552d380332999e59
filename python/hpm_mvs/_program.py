"""The console script hpm_mvs: becomes the program that the wheel brings."""
import os
import pathlib
import sys

PROGRAM = pathlib.Path(__file__).parent / "bin/hpm_mvs"


def main() -> None:
    os.execv(PROGRAM, [os.fspath(PROGRAM), *sys.argv[1:]])
