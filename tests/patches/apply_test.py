"""patches/apply.sh: the patches stay small, go into the source they are for, come out
without a trace, and a source that none fits is left as it is."""
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
APPLY = ROOT / "patches/apply.sh"
PATCHES = sorted((ROOT / "patches").glob("colmap-*.patch"))
SUPPORTED = ["3.8", "3.9.1", "3.10", "3.11.1", "3.12", "3.13", "4.0", "4.1.1", "newest"]
MAX_CHANGED_LINES = 60
HUNK = re.compile(r"^@@ -(\d+)(?:,\d+)? \+\d+(?:,\d+)? @@", re.MULTILINE)

# What every patch brings, whatever the version.
BRINGS = [
    "RunHpmPatchMatchStereo",  # the command
    "PatchMatchStereo.hpm_mvs",  # the option that asks for HPM-MVS
    "reconstruction_options.hpm_mvs",  # the same of automatic_reconstructor
    "mvs::StereoController controller(",  # patch_match_stereo
    "mvs::StereoController patch_match_controller(",  # automatic_reconstructor
    "std::make_unique<",  # the stereo button
    "in_colmap/in_colmap.cmake",
]


def apply(*arguments):
    return subprocess.run(
        [APPLY, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=120
    )


def contents(folder):
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*") if path.is_file()
    }


def source_before(patch, folder, version):
    """A tree that holds just the lines `patch` must find, each hunk at its line."""
    for section in re.split(r"^diff --git ", patch, flags=re.MULTILINE)[1:]:
        old = re.search(r"^--- a/(.*)$", section, re.MULTILINE)
        if not old:  # a file that the patch brings
            continue
        name = old.group(1)
        lines = []
        pieces = HUNK.split(section)
        for start, hunk in zip(pieces[1::2], pieces[2::2]):
            lines += ["filler"] * (int(start) - 1 - len(lines))
            lines += [l[1:] for l in hunk.splitlines()[1:] if l[:1] in (" ", "-")]
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("\n".join(lines) + "\n")
    top = folder / "CMakeLists.txt"
    text = top.read_text()
    version_line = f'set(COLMAP_VERSION "{version}")'
    top.write_text(text.replace("filler", version_line, 1))


class PatchesTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def made_up_source(self, name):
        source = self.folder / name
        source.mkdir()
        version = {"newest": "4.2.0.dev0", "3.12": "3.12.6", "3.13": "3.13.0", "4.0": "4.0.4"}
        text = (ROOT / f"patches/colmap-{name}.patch").read_text()
        source_before(text, source, version.get(name, name))
        return source

    def check_there_and_back(self, source, name):
        before = contents(source)
        result = apply("--check", source)
        self.assertIn(f"colmap-{name}.patch fits", result.stdout, result.stderr)
        self.assertEqual(contents(source), before)
        result = apply(source)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn(f"colmap-{name}.patch", result.stdout)
        patched = contents(source)
        self.assertNotEqual(patched, before)
        self.assertEqual(set(patched), set(before), "patching left files behind")
        self.assertIn("already", apply(source).stdout)
        self.assertEqual(contents(source), patched)
        self.assertEqual(apply("--undo", source).returncode, 0)
        self.assertEqual(contents(source), before)

    def test_there_is_one_for_every_version(self):
        self.assertEqual({p.name for p in PATCHES}, {f"colmap-{v}.patch" for v in SUPPORTED})

    def test_they_are_small_and_bring_everything(self):
        for path in PATCHES:
            changed = [
                l for l in path.read_text().splitlines()
                if l[:1] in ("+", "-") and not l.startswith(("+++ ", "--- "))
            ]
            self.assertLessEqual(len(changed), MAX_CHANGED_LINES, path.name)
            added = "\n".join(l[1:] for l in changed if l[0] == "+")
            for piece in BRINGS:
                self.assertIn(piece, path.read_text() if piece.startswith("std::") else added)

    def test_each_goes_in_and_comes_out_without_a_trace(self):
        for name in SUPPORTED:
            with self.subTest(name):
                self.check_there_and_back(self.made_up_source(name), name)

    def test_a_source_that_none_fits_is_left_as_it_is(self):
        source = self.made_up_source("3.12")
        header = source / "src/colmap/exe/mvs.h"
        header.write_text(header.read_text().replace("RunPatchMatchStereo", "Run"))
        before = contents(source)
        result = apply(source)
        self.assertEqual(result.returncode, 1)
        self.assertIn("no patch fits", result.stderr)
        self.assertIn("src/colmap/exe/mvs.h", result.stderr)
        self.assertEqual(contents(source), before)
        self.assertEqual(apply("--undo", source).returncode, 1)
        self.assertEqual(contents(source), before)

    def test_a_folder_that_is_not_colmap_is_refused(self):
        for arguments in ([self.folder], [], ["--nonsense", self.folder]):
            result = apply(*arguments)
            self.assertEqual(result.returncode, 2)
            self.assertIn("usage", result.stderr)

    def test_the_commit_for_upstream_applies_and_is_fit_for_its_licence(self):
        (path,) = (ROOT / "patches/upstream").glob("*.patch")
        patch = path.read_text().rsplit("\n-- \n", 1)[0] + "\n"
        source_before(patch, self.folder, "4.2.0.dev0")
        before = contents(self.folder)
        command = ["git", "apply", "--whitespace=error", path]
        result = subprocess.run(command, cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stderr)
        after = contents(self.folder)
        new = {name: after[name].decode() for name in set(after) - set(before)}
        self.assertIn("src/colmap/mvs/patch_match_hpm_test.cc", new)
        for name, text in new.items():
            self.assertTrue(text.startswith("// Copyright (c), ETH Zurich and UNC Chapel Hill."), name)
            self.assertNotIn("CGAL", text, name)
        self.assertIn(path.name, (path.parent / "PROPOSAL.md").read_text())

    def test_debians_source_package(self):
        source = os.environ.get("HPM_COLMAP_SOURCE")
        if not source:
            result = subprocess.run(
                [ROOT / "patches/debian_source.sh", self.folder / "debian"],
                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=300,
            )
            if result.returncode == 77:
                self.skipTest(result.stderr.strip())
            self.assertEqual(result.returncode, 0, result.stderr)
            source = result.stdout.strip()
        copy = self.folder / "copy"
        shutil.copytree(source, copy, symlinks=True)
        self.check_there_and_back(copy, "3.8")


if __name__ == "__main__":
    unittest.main()
