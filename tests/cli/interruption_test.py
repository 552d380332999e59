"""Signals, two runs on one workspace, folders that cannot be written, full disks, too
little memory."""
import os
import resource
import shutil
import signal
import struct
import subprocess
import time
import unittest

from png import bomb
from sparse_patch import set_camera_sizes
from support import FAST, IS_SANITIZED, SLOW, TIME_FACTOR, CliTest

NOBODY = 65534


class Signals(CliTest):
    def assert_stops(self, sent, code):
        workspace = self.workspace()
        process = self.start_tool(workspace, *SLOW)
        time.sleep(0.3)
        begin = time.monotonic()
        process.send_signal(sent)
        self.assertEqual(process.wait(timeout=10 * TIME_FACTOR), code)
        self.assertLess(time.monotonic() - begin, 2 * TIME_FACTOR)
        self.assert_no_partial_files(workspace)
        self.assert_rerun_completes(workspace)

    def test_sigint_stops_within_two_seconds_with_130(self):
        self.assert_stops(signal.SIGINT, 130)

    def test_sigterm_stops_within_two_seconds_with_143(self):
        self.assert_stops(signal.SIGTERM, 143)

    def test_sighup_stops_within_two_seconds_with_129(self):
        self.assert_stops(signal.SIGHUP, 129)


def write_many_points(workspace, track=12):
    """A million points, in the tracks of all four images."""
    count = 1 << 20
    record = struct.pack("<Q3d3BdQ", 0, 0, 0, 5, 0, 0, 0, 0, track)
    record += b"".join(struct.pack("<II", 1 + i % 4, 0) for i in range(track))
    points = bytearray(record * count)
    size = len(record)
    points[0::size] = bytes(range(256)) * (count >> 8)
    points[1::size] = b"".join(bytes([i]) * 256 for i in range(256)) * (count >> 16)
    points[2::size] = b"".join(bytes([i]) * 65536 for i in range(count >> 16))
    (workspace / "sparse/points3D.bin").write_bytes(struct.pack("<Q", count) + points)


class Planning(CliTest):
    def test_a_signal_stops_it_within_two_seconds_from_the_first_line_on(self):
        workspace = self.workspace()
        write_many_points(workspace)
        for line in (b"hpm_mvs ", b"Reading workspace", b"Reading configuration"):
            process = subprocess.Popen(
                self.command(workspace, *SLOW), stdout=subprocess.PIPE, stderr=subprocess.STDOUT
            )
            self.addCleanup(process.wait)
            self.addCleanup(process.kill)
            self.addCleanup(process.stdout.close)
            while line not in process.stdout.readline():
                self.assertIsNone(process.poll())
            begin = time.monotonic()
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.wait(timeout=60), 130)
            self.assertLess(time.monotonic() - begin, 2 * TIME_FACTOR, line)


class StandardStreams(CliTest):
    def test_closed_ones_are_not_given_to_files(self):
        workspace = self.workspace()

        def close():
            for stream in (0, 1, 2):
                os.close(stream)

        process = subprocess.Popen(self.command(workspace, *SLOW), preexec_fn=close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        deadline = time.monotonic() + 60 * TIME_FACTOR
        while not (workspace / "stereo/hpm_mvs/lock").exists():
            self.assertIsNone(process.poll())
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.02)
        for stream in (0, 1, 2):
            self.assertEqual(os.readlink(f"/proc/{process.pid}/fd/{stream}"), "/dev/null")


class Locking(CliTest):
    def test_a_second_run_is_refused_until_the_first_is_gone(self):
        workspace = self.workspace()
        first = self.start_tool(workspace, *SLOW)
        second = self.run_tool(workspace, *FAST)
        self.assert_exit(second, 7, str(first.pid))
        self.assertIsNone(first.poll(), "the first run must go on")
        first.kill()
        first.wait()
        self.assert_rerun_completes(workspace)

    def test_the_lock_of_a_killed_container_is_taken_over(self):
        workspace = self.workspace()
        container = ["unshare", "--uts", "--pid", "--fork", "--mount-proc", "sh", "-c"]
        command = self.command(workspace, *SLOW)
        try:
            subprocess.run([*container, "hostname box-a1"], check=True, stderr=subprocess.PIPE)
        except (OSError, subprocess.CalledProcessError):
            self.skipTest("a name space cannot be made here")
        script = '"$@" > /dev/null 2>&1 & sleep 1; kill -9 $!; wait'
        subprocess.run([*container, "hostname box-a1; " + script, "sh", *command])
        self.assertIn("box-a1", (workspace / "stereo/hpm_mvs/lock").read_text())
        result = self.assert_rerun_completes(workspace)
        self.assertIn("box-a1", result.stdout)

    def test_a_stopped_run_that_wakes_without_its_lock_ends_with_7(self):
        workspace = self.workspace()
        process = self.start_tool(workspace, *SLOW)
        process.send_signal(signal.SIGSTOP)
        lock = workspace / "stereo/hpm_mvs/lock"
        taken = lock.read_text().replace('"token":"', '"token":"another')
        lock.unlink()
        lock.write_text(taken)
        before = {path: path.read_bytes() for path in workspace.rglob("*.bin")}
        process.send_signal(signal.SIGCONT)
        self.assertEqual(process.wait(timeout=20 * TIME_FACTOR), 7)
        self.assertIn(str(lock), (workspace / "log.txt").read_text())
        self.assertEqual(lock.read_text(), taken)
        self.assertEqual({path: path.read_bytes() for path in workspace.rglob("*.bin")}, before)
        lock.unlink()
        self.assert_rerun_completes(workspace)


class Resources(CliTest):
    def test_a_file_size_limit_is_exit_5_and_leaves_nothing_partial(self):
        workspace = self.workspace()
        limit = 60000  # a depth map of 96x72 fits, a normal map does not
        result = self.run_tool(
            workspace,
            *FAST,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)),
        )
        self.assert_exit(result, 5, "normal_maps/view00.png.photometric.bin")
        self.assert_no_partial_files(workspace)
        self.assert_rerun_completes(workspace)

    @unittest.skipIf(IS_SANITIZED, "sanitizers need address space of their own")
    def test_too_little_memory_is_exit_5_before_anything_is_computed(self):
        workspace = self.workspace()
        set_camera_sizes(workspace / "sparse/cameras.bin", 8000, 6000)
        images = {path: path.read_bytes() for path in (workspace / "images").iterdir()}
        for path in images:
            path.write_bytes(bomb(8000, 6000))
        limit = 2 << 30
        result = self.run_tool(
            workspace,
            *FAST,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)),
        )
        self.assert_exit(result, 5, "--PatchMatchStereo.max_image_size")
        self.assertNotIn("Processing view", result.stdout)
        self.assert_no_partial_files(workspace)
        for path, data in images.items():
            path.write_bytes(data)
        set_camera_sizes(workspace / "sparse/cameras.bin", 96, 72)
        self.assert_rerun_completes(workspace)

    @unittest.skipUnless(os.geteuid() == 0, "mounting a small disk needs root")
    def test_a_full_disk_is_exit_5_and_leaves_nothing_partial(self):
        workspace = self.workspace()
        disk = workspace.parent / "disk"
        disk.mkdir()
        mounted = subprocess.run(
            ["mount", "-t", "tmpfs", "-o", "size=1300k", "none", disk], stderr=subprocess.PIPE
        )
        if mounted.returncode != 0:
            self.skipTest("a tmpfs cannot be mounted here")
        self.addCleanup(subprocess.run, ["umount", disk])
        stereo = workspace / "stereo"
        shutil.move(stereo, disk / "stereo")
        stereo.symlink_to(disk / "stereo")
        filler = disk / "filler"
        filler.write_bytes(bytes(1_150_000))
        result = self.run_tool(workspace, *FAST)
        self.assert_exit(result, 5, str(stereo))
        self.assert_no_partial_files(workspace)
        filler.unlink()
        # 4 images, 16 bytes a pixel, two stages and a quarter: 1.0 MB fit now.
        self.assert_rerun_completes(workspace)

    def run_as_nobody(self, workspace):
        options = {"user": NOBODY, "group": NOBODY, "extra_groups": []}
        try:
            subprocess.run(["true"], check=True, **options)
            return self.run_tool(workspace, *FAST, **options)
        except PermissionError:
            self.skipTest("an unprivileged user cannot run the program here")

    @unittest.skipUnless(os.geteuid() == 0, "becoming another user needs root")
    def test_a_workspace_without_write_permission_is_exit_3_before_computing(self):
        workspace = self.workspace()
        result = self.run_as_nobody(workspace)
        self.assert_exit(result, 3, str(workspace / "stereo"))
        self.assertNotIn("Processing view", result.stdout)
        self.assert_rerun_completes(workspace)

    @unittest.skipUnless(os.geteuid() == 0, "becoming another user needs root")
    def test_what_cannot_be_read_is_exit_3_with_a_remedy_that_helps(self):
        workspace = self.workspace()
        for path in [workspace, *workspace.rglob("*")]:
            os.chown(path, NOBODY, NOBODY)
        lock = workspace / "stereo/hpm_mvs/lock"
        lock.parent.mkdir(exist_ok=True)
        os.chown(lock.parent, NOBODY, NOBODY)
        lock.write_text("")
        lock.chmod(0)
        self.assert_exit(self.run_as_nobody(workspace), 3, lock, "cannot read", "delete it")
        lock.unlink()
        (workspace / "sparse").chmod(0o600)
        self.assert_exit(self.run_as_nobody(workspace), 3, "sparse", "searchable")
        (workspace / "sparse").chmod(0o700)
        self.assert_rerun_completes(workspace)

    def test_missing_output_folders_are_created(self):
        workspace = self.workspace()
        for name in ("depth_maps", "normal_maps", "consistency_graphs"):
            (workspace / "stereo" / name).rmdir()
        self.assert_rerun_completes(workspace)


if __name__ == "__main__":
    unittest.main()
