"""The version stands in VERSION and is repeated only where a format demands it; what the
papers of a release name exists; templates ask for what is needed."""
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
VERSION = (ROOT / "VERSION").read_text().strip()
# Where a number of this form would be a second home of the version.
MAY_NOT_REPEAT = ("CMakeLists.txt", "cmake/*", "colmap_plugin/**/*", "src/**/*", "scripts/*", "tests/**/*.py",
                  "tests/**/*.sh", "tests/**/*.cmake", "bench/*.py", "Dockerfile", "vcpkg.json")
PATH = re.compile(r"`((?:src|cuda|colmap_plugin|docs|bench|tests|scripts|cmake|data|patches)/[\w./*-]+)`")


def read(name):
    return (ROOT / name).read_text(encoding="utf-8")


def missing_paths(text):
    return [path for path in PATH.findall(text) if not list(ROOT.glob(path.rstrip("/")))]


class Version(unittest.TestCase):
    def test_is_three_numbers(self):
        self.assertRegex(VERSION, r"^\d+\.\d+\.\d+$")

    def test_has_the_newest_section_of_the_changelog(self):
        sections = re.findall(r"^## (\S+)(?: \((.+)\))?$", read("CHANGELOG.md"), re.M)
        self.assertEqual(sections[0][0], VERSION)
        for _, when in sections[1:]:
            self.assertNotEqual(when, "unreleased")

    def test_is_cited(self):
        self.assertIn(f"\nversion: {VERSION}\n", read("CITATION.cff"))

    def test_stands_in_no_second_place(self):
        number = re.compile(rf"(?<![\d.]){re.escape(VERSION)}(?![\d.])")
        found = [
            path.relative_to(ROOT).as_posix()
            for pattern in MAY_NOT_REPEAT
            for path in ROOT.glob(pattern)
            if path.is_file() and number.search(path.read_text(encoding="utf-8", errors="replace"))
        ]
        self.assertEqual(found, [])


class Papers(unittest.TestCase):
    def test_paths_that_are_named_exist(self):
        for name in ("CONTRIBUTING.md", ".github/PULL_REQUEST_TEMPLATE.md"):
            self.assertEqual(missing_paths(read(name)), [], name)

    def test_a_path_that_is_gone_would_be_found(self):
        self.assertEqual(missing_paths("see `src/engine/gone.cc`"), ["src/engine/gone.cc"])

    def test_contributing_says_how_to_do_each_thing(self):
        text = read("CONTRIBUTING.md")
        for heading in ("Build", "Test", "Measure", "Add an option", "Add a method", "Add a backend"):
            self.assertIn(f"\n## {heading}\n", text)

    def test_the_fault_template_asks_for_what_is_needed(self):
        text = read(".github/ISSUE_TEMPLATE/fault.yml")
        for wanted in ("hpm_mvs version", "run.json"):
            self.assertIn(wanted, text)
        asked = re.findall(r"^    id: (\w+)$", text, re.M)
        self.assertLessEqual({"version", "command", "output", "record", "workspace"}, set(asked))


if __name__ == "__main__":
    unittest.main()
