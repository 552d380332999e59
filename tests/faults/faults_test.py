"""Calls of the system fail one after the other, by fault_injector.cc: the n-th open,
read, write, ... of a run that touches the workspace. Whatever fails, the program ends
by itself, no file under a final name is torn, and the next run gives the bytes of an
undisturbed one. A sample of the points by default; HPM_FAULT_POINTS=all tries every
call, HPM_FAULT_POINTS=<n> up to n of each kind."""
import errno
import os
import pathlib
import subprocess
import unittest

from support import HPM_MVS, TIME_FACTOR, CliTest, map_files

INJECTOR = os.environ["HPM_FAULT_INJECTOR"]
POINTS = os.environ.get("HPM_FAULT_POINTS", "2")

OPTIONS = [
    "--Hpm.num_iterations=1",
    "--Hpm.num_geom_iterations=1",
    "--Hpm.num_geom_passes=1",
    "--PatchMatchStereo.window_radius=3",
    "--PatchMatchStereo.num_threads=1",
]
# Pass by themselves, so a run whose call fails once is as good as any other.
TRANSIENT = {errno.EIO, errno.ESTALE, errno.EAGAIN}
# Kind of call -> errors it fails with.
ERRORS = {
    "open": [errno.EIO, errno.EACCES, errno.EMFILE],
    "read": [errno.ESTALE, errno.EIO],
    "write": [errno.ENOSPC, errno.EIO],
    "fsync": [errno.EIO, errno.EDQUOT],
    "close": [errno.EIO, errno.ENOSPC],
    "rename": [errno.ESTALE, errno.EACCES],
    "stat": [errno.ESTALE, errno.EACCES],
    "mkdir": [errno.EIO, errno.ENOSPC],
    "unlink": [errno.EIO],
}
ONCE, EVER_AFTER = 1, 0


def sample(count):
    """Numbers of calls, from 1: first, last and some between."""
    most = count if POINTS == "all" else min(int(POINTS), count)
    if most <= 1:
        return [1] * min(most, count)
    return sorted({1 + round(i * (count - 1) / (most - 1)) for i in range(most)})


class Faults(CliTest):
    def scene(self):
        return self.workspace(views=3, width=48, height=36)

    def environment(self, workspace, counts, fault):
        environment = dict(
            os.environ,
            LD_PRELOAD=INJECTOR,
            HPM_FAULT_ROOT=os.path.realpath(workspace),
            HPM_FAULT_COUNTS=str(counts),
            ASAN_OPTIONS="verify_asan_link_order=0",
        )
        if fault:
            environment["HPM_FAULT"] = ":".join(str(part) for part in fault)
        return environment

    def run_with(self, workspace, fault=None):
        """The result and the calls of each kind."""
        counts = workspace.parent / "counts.txt"
        result = self.run_tool(workspace, *OPTIONS, env=self.environment(workspace, counts, fault))
        lines = counts.read_text().split("\n") if counts.exists() else []
        return result, {kind: int(n) for kind, n in (line.split() for line in lines if line)}

    @classmethod
    def setUpClass(cls):
        cls.expected = cls.counts = None

    def undisturbed(self):
        if Faults.expected is None:
            workspace = self.scene()
            result, Faults.counts = self.run_with(workspace)
            self.assert_exit(result, 0)
            Faults.expected = map_files(workspace)
            self.assertEqual(len(Faults.expected), 3 * 2 * 2)
        return Faults.expected, Faults.counts

    def check(self, kind, number, error, times):
        expected, _ = self.undisturbed()
        workspace = self.scene()
        result, counts = self.run_with(workspace, (kind, number, error, times))
        report = f"exit {result.returncode}\n{result.stdout}\n{result.stderr}"
        self.assertIn(result.returncode, (0, 1, 3, 4, 5), report)
        if result.returncode == 0:
            self.assert_same_maps(map_files(workspace), expected)
        else:
            self.assertTrue(any(l.startswith("ERROR: ") for l in result.stderr.splitlines()), report)
        if times == ONCE and error in TRANSIENT:
            self.assertEqual(result.returncode, 0, report)
        if error in (errno.ENOSPC, errno.EDQUOT) and result.returncode != 0:
            self.assertEqual(result.returncode, 5, report)
        # Maps of an unfinished run may be of sources that failed, so no bytes yet.
        for path in workspace.rglob("*"):
            if kind != "unlink":
                self.assertNotIn(".tmp.", path.name, report)
        for name, data in map_files(workspace).items():
            self.assertEqual(len(data), len(expected[name]), report)
        again = self.run_tool(workspace, *OPTIONS)
        self.assert_exit(again, 0)
        self.assert_same_maps(map_files(workspace), expected)
        self.assert_no_partial_files(workspace)
        return counts

    def try_kind(self, kind):
        _, counts = self.undisturbed()
        self.assertGreater(counts[kind], 0)
        num_failed = 0
        for error in ERRORS[kind]:
            for number in sample(counts[kind]):
                for times in (ONCE, EVER_AFTER) if POINTS == "all" else (ONCE,):
                    with self.subTest(kind=kind, number=number, error=errno.errorcode[error], times=times):
                        num_failed += self.check(kind, number, error, times)["failed"]
        self.assertGreater(num_failed, 0)

    def test_open(self):
        self.try_kind("open")

    def test_read(self):
        self.try_kind("read")

    def test_write(self):
        self.try_kind("write")

    def test_fsync(self):
        self.try_kind("fsync")

    def test_close(self):
        self.try_kind("close")

    def test_rename(self):
        self.try_kind("rename")

    def test_stat(self):
        self.try_kind("stat")

    def test_any_look_at_a_file_or_folder_may_fail_once(self):
        """A folder above that could not be looked at was taken for one that is there."""
        _, counts = self.undisturbed()
        for number in range(1, counts["stat"] + 1):
            with self.subTest(number=number):
                self.check("stat", number, errno.ESTALE, ONCE)

    def test_mkdir(self):
        self.try_kind("mkdir")

    def test_unlink(self):
        self.try_kind("unlink")

    def test_check_removes_nothing_because_it_cannot_be_read(self):
        workspace = self.scene()
        self.assert_exit(self.run_tool(workspace, *OPTIONS), 0)
        stereo = workspace / "stereo"

        def files():
            names = (p.relative_to(stereo).as_posix() for p in stereo.rglob("*"))
            return {name for name in names if name.endswith((".bin", ".json"))}

        def check(fault):
            counts = workspace.parent / "counts.txt"
            result = subprocess.run(
                [HPM_MVS, "check", "--workspace_path", str(workspace), *OPTIONS, "--fix=1"],
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                env=self.environment(workspace, counts, fault),
                timeout=120 * TIME_FACTOR,
            )
            return result, dict(line.split() for line in counts.read_text().splitlines())

        before = files()
        _, counts = check(None)
        num_told = 0
        for kind, error in (("open", errno.EACCES), ("open", errno.EIO), ("read", errno.EIO)):
            for number in range(1, int(counts[kind]) + 1, 1 if POINTS == "all" else 5):
                with self.subTest(kind=kind, number=number, error=errno.errorcode[error]):
                    result, _ = check((kind, number, error, EVER_AFTER))
                    self.assertEqual(files(), before, result.stdout + result.stderr)
                    num_told += "\nunreadable depth_maps/" in "\n" + result.stdout
                    self.assertNotEqual(result.returncode, 0, result.stdout)
        self.assertGreater(num_told, 0)

    def test_a_disk_that_goes_away_is_an_error_after_some_tries(self):
        for kind in ("read", "write", "fsync"):
            with self.subTest(kind):
                expected, counts = self.undisturbed()
                self.check(kind, counts[kind] // 2, errno.EIO, EVER_AFTER)


if __name__ == "__main__":
    unittest.main()
