"""What all command line tests share: the program, small scenes, and checks that
hold after every run. HPM_MVS and HPM_MAKE_SCENE name the programs under test."""
import array
import atexit
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

HPM_MVS = os.environ["HPM_MVS"]
HPM_MAKE_SCENE = os.environ["HPM_MAKE_SCENE"]
# Under sanitizers everything takes longer, and address space is not ours to limit.
TIME_FACTOR = float(os.environ.get("HPM_TIME_FACTOR", 1))
IS_SANITIZED = os.environ.get("HPM_SANITIZE", "") != ""

# Options for tests in which only the files and the exit code count.
FAST = [
    "--Hpm.num_iterations=1",
    "--Hpm.num_geom_iterations=1",
    "--Hpm.num_geom_passes=1",
    "--PatchMatchStereo.window_radius=3",
    "--PatchMatchStereo.num_threads=2",
]
# Options with which a tiny scene takes many seconds, for tests that interrupt.
SLOW = ["--Hpm.num_iterations=400", "--PatchMatchStereo.num_threads=2"]

_templates = {}
_folder = pathlib.Path(tempfile.mkdtemp(prefix="hpm_cli_"))
_folder.chmod(0o755)
atexit.register(shutil.rmtree, _folder, ignore_errors=True)


def _template(name, views, width, height):
    key = (name, views, width, height)
    if key not in _templates:
        path = _folder / f"template_{len(_templates)}"
        subprocess.run(
            [
                HPM_MAKE_SCENE, name, path,
                "--views", str(views), "--width", str(width), "--height", str(height),
            ],
            check=True,
        )
        _templates[key] = path
    return _templates[key]


def read_map(path):
    """(width, height, channels, values); fails unless the file is complete."""
    data = path.read_bytes()
    width, height, channels, _ = data.split(b"&", 3)
    begin = len(width) + len(height) + len(channels) + 3
    width, height, channels = int(width), int(height), int(channels)
    assert len(data) == begin + 4 * width * height * channels, f"{path} is not complete"
    values = array.array("f")
    values.frombytes(data[begin:])
    if sys.byteorder == "big":
        values.byteswap()
    return width, height, channels, values


def map_files(workspace, stereo="stereo"):
    """Bytes of all finished maps by relative name."""
    root = workspace / stereo
    return {
        path.relative_to(root).as_posix(): path.read_bytes()
        for kind in ("depth_maps", "normal_maps", "consistency_graphs")
        for path in sorted((root / kind).rglob("*.bin"))
    }


class CliTest(unittest.TestCase):
    def workspace(self, name="tilted_plane", views=4, width=96, height=72):
        """A fresh copy of a scene, removed after the test."""
        template = _template(name, views, width, height)
        path = pathlib.Path(tempfile.mkdtemp(prefix="ws_", dir=_folder)) / "dense"
        shutil.copytree(template, path)
        path.parent.chmod(0o755)
        self.addCleanup(shutil.rmtree, path.parent, ignore_errors=True)
        return path

    def command(self, workspace, *options):
        return [HPM_MVS, "patch_match_stereo", "--workspace_path", str(workspace), *options]

    def run_tool(self, workspace, *options, **keywords):
        keywords["timeout"] = keywords.get("timeout", 120) * TIME_FACTOR
        return subprocess.run(
            self.command(workspace, *options),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            **keywords,
        )

    def run_command(self, name, workspace, *options):
        """Another command of the program, about the workspace."""
        return subprocess.run(
            [HPM_MVS, name, "--workspace_path", str(workspace), *options],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            timeout=120 * TIME_FACTOR,
        )

    def start_tool(self, workspace, *options):
        """Returns when the first image is being worked on."""
        log = open(workspace / "log.txt", "wb")
        process = subprocess.Popen(
            self.command(workspace, *options), stdout=log, stderr=subprocess.STDOUT
        )
        log.close()
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        deadline = time.monotonic() + 60 * TIME_FACTOR
        while b"Processing view" not in (workspace / "log.txt").read_bytes():
            self.assertIsNone(process.poll(), (workspace / "log.txt").read_text())
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.02)
        return process

    def assert_exit(self, result, code, *words):
        """The exit code, and on failure one error line that holds all words."""
        text = f"exit {result.returncode}\n{result.stdout}\n{result.stderr}"
        self.assertEqual(result.returncode, code, text)
        if words:
            lines = [l for l in result.stderr.splitlines() if l.startswith("ERROR: ")]
            self.assertTrue(
                any(all(str(word) in line for word in words) for line in lines),
                f"no error line names {words}:\n{text}",
            )

    def assert_no_partial_files(self, workspace):
        """Every map under a final name is complete, nothing temporary lies around."""
        for path in workspace.rglob("*"):
            self.assertNotIn(".tmp.", path.name)
        for kind in ("depth_maps", "normal_maps"):
            for path in (workspace / "stereo" / kind).rglob("*.bin"):
                read_map(path)

    def assert_complete(self, workspace, names=None, stages=("photometric", "geometric")):
        """Finite maps of all images; normals are unit exactly where there is depth."""
        names = names or sorted(p.name for p in (workspace / "images").iterdir())
        for stage in stages:
            for name in names:
                width, height, channels, depth = read_map(
                    workspace / "stereo/depth_maps" / f"{name}.{stage}.bin"
                )
                self.assertEqual(channels, 1)
                size = width * height
                shape = read_map(workspace / "stereo/normal_maps" / f"{name}.{stage}.bin")
                self.assertEqual(shape[:3], (width, height, 3))
                normal = shape[3]
                for i in range(size):
                    length = sum(normal[i + k * size] ** 2 for k in range(3))
                    if depth[i] == 0:
                        self.assertEqual(length, 0)
                    else:
                        self.assertTrue(0 < depth[i] < 1e6, f"{name}: depth {depth[i]}")
                        self.assertAlmostEqual(length, 1, delta=1e-4)

    def assert_same_maps(self, maps, expected):
        """As assertEqual, which would take minutes to print how maps differ."""
        self.assertEqual(set(maps), set(expected))
        self.assertEqual([name for name in maps if maps[name] != expected[name]], [])

    def assert_rerun_completes(self, workspace, *options):
        result = self.run_tool(workspace, *(options or FAST))
        self.assert_exit(result, 0)
        self.assert_no_partial_files(workspace)
        self.assert_complete(workspace)
        return result
