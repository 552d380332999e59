#!/usr/bin/env python3
"""A header as Doxygen wants it: plain comments in front of or behind what they explain
become its own. The first comment of a file explains the file.
usage: doxygen_filter.py HEADER"""
import re
import sys


def for_doxygen(text):
    lines = text.split("\n")
    out = ["/// \\file"] if lines[0].startswith("//") else []
    for line in lines:
        comment = re.match(r"(\s*)//(?!/)(.*)", line)
        if comment:
            out.append(f"{comment[1]}///{comment[2]}")
            continue
        # Not within a string, as in "http://".
        behind = re.match(r"([^\"]*[;,{}])\s*// (.*)", line)
        out.append(f"{behind[1]}  ///< {behind[2]}" if behind else line)
    return "\n".join(out)


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as header:
        sys.stdout.write(for_doxygen(header.read()))
