"""Dependencies run one way (docs/architecture.md): a module includes only itself
and the modules below it, and names every file by its path from the root of the repository.
"""
import pathlib
import re
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SUFFIXES = {".h", ".cc", ".cu", ".cuh"}
OUR_FOLDERS = ("src", "cuda", "colmap_plugin", "python", "bench", "tests", "examples")

BASE = ("src/base",)
CORE = ("src/core",)
LIBRARY = BASE + CORE + ("src/image", "src/prior", "src/engine")
GPU = LIBRARY + ("src/gpu",)
BACKENDS = GPU + ("src/cpu", "cuda")
FORMATS = BACKENDS + ("colmap_plugin/formats",)
WORKSPACE = FORMATS + ("colmap_plugin/workspace",)
OPTIONS = WORKSPACE + ("colmap_plugin/options",)
CONTROLLER = OPTIONS + ("colmap_plugin/controller",)
INSPECT = CONTROLLER + ("colmap_plugin/inspect",)
EVERYTHING = OUR_FOLDERS

# Module -> what it may include, besides itself.
ALLOWED = {
    "src/base": (),
    "src/core": (),
    "src/image": BASE + CORE,
    "src/prior": BASE + CORE + ("src/image",),
    "src/engine": LIBRARY,
    "src/cpu": LIBRARY,
    "src/gpu": LIBRARY,
    "cuda": GPU,
    "colmap_plugin/formats": BACKENDS,
    "colmap_plugin/workspace": FORMATS,
    "colmap_plugin/options": WORKSPACE,
    "colmap_plugin/controller": OPTIONS,
    "colmap_plugin/inspect": CONTROLLER,
    "colmap_plugin/tool": INSPECT,
    "colmap_plugin/in_colmap": INSPECT + ("colmap_plugin/tool",),
    "colmap_plugin/wrapper": BASE,
    "python": INSPECT + ("colmap_plugin/tool",),
    "bench": EVERYTHING,
    "examples": LIBRARY + ("src/cpu",),
    "tests": EVERYTHING,
}

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)


def within(path, modules):
    return any(path.startswith(module + "/") for module in modules)


def violations(root):
    found = []
    for folder in OUR_FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in SUFFIXES:
                continue
            name = path.relative_to(root).as_posix()
            module = next((r for r in ALLOWED if within(name, [r])), None)
            if module is None:
                found.append(f"{name}: lies in no known module")
                continue
            for quote, target in INCLUDE.findall(path.read_text(encoding="utf-8")):
                if within(target, OUR_FOLDERS):
                    if not within(target, (module,) + ALLOWED[module]):
                        found.append(f"{name}: must not include {target}")
                    elif not (root / target).is_file():
                        found.append(f"{name}: includes {target}, which is not there")
                elif quote == '"' and (path.parent / target).is_file():
                    found.append(f"{name}: names {target} without its path from the root")
    return found


class IncludeDirection(unittest.TestCase):
    def test_every_include_runs_downward(self):
        self.assertEqual(violations(ROOT), [])


class TheTestItself(unittest.TestCase):
    """Made-up trees: one fault each must be found, a clean one must pass."""

    def check(self, files):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name, text in files.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text)
            return violations(root)

    def test_accepts_a_clean_tree(self):
        self.assertEqual(
            self.check(
                {
                    "src/core/vec.h": "#include <math.h>\n",
                    "src/engine/run.cc": '#include "src/core/vec.h"\n#include <vector>\n',
                    "src/cpu/cost.cc": '#include "hwy/highway.h"\n#include "src/core/vec.h"\n',
                    "tests/engine/run_test.cc": '#include "src/core/vec.h"\n',
                }
            ),
            [],
        )

    def test_finds_an_upward_include(self):
        faults = {
            "src/core/vec.h": "src/base/error.h",
            "src/base/error.cc": "src/core/vec.h",
            "src/image/grey.cc": "src/prior/prior.h",
            "src/engine/run.cc": "src/cpu/backend.h",
            "src/cpu/backend.cc": "cuda/backend.h",
            "src/cpu/views.cc": "src/gpu/tables.h",
            "src/gpu/tables.cc": "cuda/launch.h",
            "cuda/backend.cu": "src/cpu/backend.h",
            "src/engine/files.cc": "colmap_plugin/formats/map_file.h",
            "colmap_plugin/formats/map_file.cc": "colmap_plugin/workspace/workspace.h",
            "colmap_plugin/workspace/workspace.cc": "colmap_plugin/options/options.h",
            "colmap_plugin/options/option_table.cc": "colmap_plugin/controller/controller.h",
            "colmap_plugin/controller/controller.cc": "colmap_plugin/tool/main.h",
            "colmap_plugin/tool/main.cc": "bench/eval/ply.h",
        }
        for name, target in faults.items():
            with self.subTest(name):
                found = self.check({name: f'#include "{target}"\n', target: ""})
                self.assertEqual(found, [f"{name}: must not include {target}"])

    def test_finds_an_upward_include_in_angle_brackets(self):
        found = self.check(
            {"src/core/vec.h": "#  include <src/base/error.h>\n", "src/base/error.h": ""}
        )
        self.assertEqual(len(found), 1)

    def test_finds_a_relative_include(self):
        found = self.check({"src/core/plane.h": '#include "vec.h"\n', "src/core/vec.h": ""})
        self.assertEqual(len(found), 1)

    def test_finds_an_unknown_module(self):
        self.assertEqual(len(self.check({"src/attic/old.cc": ""})), 1)


if __name__ == "__main__":
    unittest.main(argv=sys.argv)
