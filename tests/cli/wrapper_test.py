"""The wrapper named `colmap`: patch_match_stereo goes to hpm_mvs, everything else
to the next colmap on PATH, and nobody notices the wrapper."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import unittest

from support import FAST, HPM_MVS, CliTest, map_files

WRAPPER = pathlib.Path(os.environ["HPM_WRAPPER"])
HPM_FOLDER = str(pathlib.Path(HPM_MVS).parent)

# Stands for the real colmap: tells what it was given and ends as told.
FAKE = """#!/usr/bin/env python3
import json, os, signal, sys
for line in open("/proc/self/status"):
    if line.startswith("SigIgn"):
        ignored = int(line.split()[1], 16)
environment = dict(os.environb)
json.dump({
    "name": sys.argv[0], "arguments": sys.argv[1:], "input": sys.stdin.read(), "ignored": ignored,
    "environment": {os.fsdecode(k): os.fsdecode(v) for k, v in environment.items()},
    "pid": os.getpid(),
}, sys.stdout)
sys.stdout.flush()
if "die" in sys.argv:
    os.kill(os.getpid(), signal.SIGKILL)
if "wait" in sys.argv:
    signal.pause()
sys.exit(int(os.environ.get("FAKE_EXIT", "0")))
"""


class WrapperTest(CliTest):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.fake = self.program("real", FAKE)

    def program(self, folder, text):
        path = self.folder / folder / "colmap"
        path.parent.mkdir()
        path.write_text(text)
        path.chmod(0o755)
        return path

    def environment(self, *folders, **more):
        path = ":".join(map(str, [*folders, HPM_FOLDER, "/usr/bin", "/bin"]))
        sanitizers = {name: value for name, value in os.environ.items() if name.endswith("SAN_OPTIONS")}
        return {"PATH": path, "PYTHONDONTWRITEBYTECODE": "1", **sanitizers, **more}

    def run_wrapper(self, *arguments, env=None, program=WRAPPER, **keywords):
        return subprocess.run(
            [program, *arguments],
            env=env or self.environment(WRAPPER.parent, self.fake.parent),
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120, **keywords,
        )

    def test_arguments_input_and_environment_arrive_untouched(self):
        env = self.environment(WRAPPER.parent, self.fake.parent, STRANGE="a b\n'\"$x")
        arguments = ["mapper", "", "two words", "--a=*", "$HOME", "\\", "é\n", "--", "-h"]
        result = self.run_wrapper(*arguments, env=env, input=b"to the real one")
        self.assertEqual(result.returncode, 0, result.stderr)
        told = json.loads(result.stdout)
        self.assertEqual(told["arguments"], arguments)
        self.assertEqual(told["input"], "to the real one")
        self.assertEqual(told["name"], str(self.fake))
        # What the interpreter itself adds is there in a direct call too.
        direct = json.loads(self.run_wrapper(program=self.fake, env=env).stdout)
        self.assertEqual(told["environment"], direct["environment"])

    def test_exit_codes_arrive(self):
        for code in (1, 77, 134, 255):
            env = self.environment(WRAPPER.parent, self.fake.parent, FAKE_EXIT=str(code))
            self.assertEqual(self.run_wrapper("stereo_fusion", env=env).returncode, code)

    def test_death_by_a_signal_arrives(self):
        self.assertEqual(self.run_wrapper("mapper", "die").returncode, -signal.SIGKILL)

    def test_signals_reach_the_real_program_itself(self):
        process = subprocess.Popen(
            [WRAPPER, "mapper", "wait"], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            env=self.environment(WRAPPER.parent, self.fake.parent), bufsize=0,
        )
        self.addCleanup(process.stdout.close)
        text = b""
        while not text.endswith(b"}"):
            text += process.stdout.read(65536)
        self.assertEqual(json.loads(text)["pid"], process.pid)
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(timeout=20), -signal.SIGTERM)

    def test_ignored_signals_stay_ignored(self):
        result = self.run_wrapper(
            "mapper", preexec_fn=lambda: signal.signal(signal.SIGUSR1, signal.SIG_IGN)
        )
        self.assertTrue(json.loads(result.stdout)["ignored"] & 1 << (signal.SIGUSR1 - 1))

    def test_finds_the_real_one_only_behind_itself(self):
        env = self.environment(self.fake.parent, WRAPPER.parent)
        env["PATH"] = env["PATH"].rsplit(":", 2)[0]  # no system folders
        result = self.run_wrapper("mapper", env=env)
        self.assertEqual(result.returncode, 127)
        self.assertIn(b"install COLMAP", result.stderr)

    def test_two_wrappers_do_not_call_each_other_for_ever(self):
        other = self.folder / "other" / "colmap"
        other.parent.mkdir()
        shutil.copy(WRAPPER, other)
        env = self.environment(other.parent, WRAPPER.parent, self.fake.parent)
        for program in (WRAPPER, other):
            result = self.run_wrapper("mapper", env=env, program=program)
            self.assertEqual(json.loads(result.stdout)["name"], str(self.fake))

    def test_a_link_to_the_wrapper_is_the_wrapper(self):
        link = self.folder / "link" / "colmap"
        link.parent.mkdir()
        link.symlink_to(WRAPPER)
        result = self.run_wrapper(
            "mapper", env=self.environment(link.parent, self.fake.parent), program=link
        )
        self.assertEqual(json.loads(result.stdout)["name"], str(self.fake))

    def test_folders_and_plain_files_named_colmap_are_passed_over(self):
        (self.folder / "folder" / "colmap").mkdir(parents=True)
        plain = self.program("plain", "no program")
        plain.chmod(0o644)
        env = self.environment(
            WRAPPER.parent, self.folder / "folder", plain.parent, self.fake.parent
        )
        self.assertEqual(
            json.loads(self.run_wrapper("mapper", env=env).stdout)["name"], str(self.fake)
        )

    def test_stereo_gives_the_maps_and_exit_codes_of_hpm_mvs(self):
        direct, wrapped = self.workspace(), self.workspace()
        self.assert_exit(self.run_tool(direct, *FAST), 0)
        result = self.run_wrapper("patch_match_stereo", "--workspace_path", wrapped, *FAST)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assert_same_maps(map_files(wrapped), map_files(direct))

        (wrapped / "images/view00.png").write_bytes(b"no picture")
        options = [*FAST, "--Hpm.overwrite=1"]
        result = self.run_wrapper("patch_match_stereo", "--workspace_path", wrapped, *options)
        self.assertEqual(result.returncode, 4)
        self.assertIn(b"view00.png", result.stderr)
        self.assertEqual(self.run_wrapper("patch_match_stereo", "--no_such=1").returncode, 2)

    def test_says_when_hpm_mvs_is_missing(self):
        result = self.run_wrapper("patch_match_stereo", env={"PATH": "/usr/bin"})
        self.assertEqual(result.returncode, 127)
        self.assertIn(b"hpm_mvs", result.stderr)

    def test_the_undistorters_script_runs_unchanged(self):
        scene = self.workspace(views=6, width=160, height=120)
        dense = scene / "dense"
        subprocess.run(
            [
                "colmap", "image_undistorter", "--image_path", scene / "images",
                "--input_path", scene / "sparse", "--output_path", dense,
            ],
            check=True, stdout=subprocess.DEVNULL,
        )
        direct = scene / "direct"
        shutil.copytree(dense, direct)
        for kind in ("photometric", "geometric"):
            result = subprocess.run(
                ["sh", f"./run-colmap-{kind}.sh"], cwd=dense,
                env=self.environment(
                    COLMAP_EXE_PATH=str(WRAPPER.parent),
                    # Else threads of the mesher spin on a busy machine.
                    OMP_NUM_THREADS="1",
                ),
                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=600,
            )
            ply = (dense / "fused.ply").read_bytes()
            points = int(ply.split(b"element vertex ", 1)[1].split(b"\n", 1)[0])
            self.assertGreater(points, 3000, result.stdout)
            self.assertTrue((dense / "meshed-poisson.ply").is_file(), result.stdout)
            (dense / "fused.ply").unlink()
        result = self.run_tool(direct, "--PatchMatchStereo.max_image_size=2000")
        self.assert_exit(result, 0)
        self.assert_same_maps(map_files(dense), map_files(direct))


if __name__ == "__main__":
    unittest.main()
