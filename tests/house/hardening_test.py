"""Release builds are hardened: told from the programs themselves, by readelf."""
import os
import re
import shutil
import subprocess
import sys
import unittest

PROGRAMS = os.environ["HPM_PROGRAMS"].split(":")


def readelf(program, *options):
    return subprocess.run(
        ["readelf", "-W", *options, program], check=True, stdout=subprocess.PIPE, text=True
    ).stdout


class Hardening(unittest.TestCase):
    def check_all(self, check):
        for program in PROGRAMS:
            with self.subTest(program):
                check(program)

    def test_programs_lie_where_nobody_expects_them(self):
        """Position independent, so that addresses differ from run to run."""
        self.check_all(lambda p: self.assertRegex(readelf(p, "-h"), r"Type:\s+DYN"))

    def test_tables_of_functions_are_read_only_from_the_start(self):
        def check(program):
            self.assertIn("GNU_RELRO", readelf(program, "-l"))
            self.assertRegex(readelf(program, "-d"), r"BIND_NOW|FLAGS.*NOW")

        self.check_all(check)

    def test_nothing_is_writable_and_executable(self):
        def check(program):
            headers = readelf(program, "-l")
            self.assertIn("GNU_STACK", headers)
            self.assertNotRegex(headers, r"(?m)^\s+(LOAD|GNU_STACK).*\bRWE\b")

        self.check_all(check)

    def test_stacks_and_buffers_are_checked(self):
        symbols = readelf(PROGRAMS[0], "-s", "--dyn-syms")
        self.assertIn("__stack_chk_fail", symbols)
        self.assertRegex(symbols, r"__\w+_chk@")

    def test_libraries_come_from_where_the_system_keeps_them(self):
        # Folders that a build names, and an empty name, which is the present one.
        self.check_all(lambda p: self.assertNotRegex(readelf(p, "-d"), r"\((RPATH|RUNPATH)\)"))


if __name__ == "__main__":
    if shutil.which("readelf") is None:
        print("skipped: readelf is not installed")
        sys.exit(77)
    unittest.main()
