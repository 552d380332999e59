"""Limits of the system on threads and address space, and the memory that a run tells."""
import json
import os
import resource
import subprocess
import sys
import unittest

from support import FAST, HPM_MVS, IS_SANITIZED, CliTest, map_files

FAST_ALONE = [option for option in FAST if "num_threads" not in option]
# A user id that has no other process, since the limit counts all of a user's.
LONELY_USER = 54321
# At its end the address sanitizer looks for leaks with a thread of its own.
WITHOUT_LEAKS = {**os.environ, "ASAN_OPTIONS": os.environ.get("ASAN_OPTIONS", "") + ":detect_leaks=0"}


class Threads(CliTest):
    def run_with(self, workspace, num_threads, limit, value, user=None):
        def prepare():
            resource.setrlimit(limit, (value, value))
            if user is not None:
                os.setgid(user)
                os.setuid(user)

        return self.run_tool(
            workspace,
            *FAST_ALONE,
            f"--PatchMatchStereo.num_threads={num_threads}",
            preexec_fn=prepare,
            env=WITHOUT_LEAKS,
        )

    @unittest.skipIf(
        os.environ.get("HPM_SANITIZE") == "thread", "tests/tsan/tbb cannot do with fewer threads than two"
    )
    @unittest.skipUnless(os.geteuid() == 0, "becoming a user without processes needs root")
    def test_with_few_processes_fewer_threads_compute_or_the_limit_is_named(self):
        expected = self.workspace()
        self.assert_exit(self.run_tool(expected, *FAST), 0)
        for processes in (1, 2, 5, 8):
            with self.subTest(processes):
                workspace = self.workspace()
                for path in [workspace, *workspace.rglob("*")]:
                    os.chown(path, LONELY_USER, LONELY_USER)
                try:
                    result = self.run_with(
                        workspace, 16, resource.RLIMIT_NPROC, processes, LONELY_USER
                    )
                except PermissionError:
                    self.skipTest("an unprivileged user cannot run the program here")
                if processes == 1:
                    self.assert_exit(result, 5, "ulimit -u", "--PatchMatchStereo.num_threads")
                    self.assertEqual(map_files(workspace), {})
                    continue
                self.assert_exit(result, 0)
                self.assertIn(f"{processes - 1} compute in place of 16", result.stderr)
                self.assert_same_maps(map_files(workspace), map_files(expected))

    @unittest.skipIf(IS_SANITIZED, "sanitizers need address space of their own")
    def test_without_address_space_for_all_threads_nothing_is_aborted(self):
        def starts(megabytes):
            return subprocess.run(
                [HPM_MVS, "version"],
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                preexec_fn=lambda: resource.setrlimit(
                    resource.RLIMIT_AS, (megabytes << 20, megabytes << 20)
                ),
            ).returncode == 0

        least = 64
        while not starts(least):
            least += 16
            self.assertLess(least, 4096)
        codes = []
        for more in (8, 40, 96):
            workspace = self.workspace()
            result = self.run_with(workspace, 40, resource.RLIMIT_AS, (least + more) << 20)
            self.assertIn(result.returncode, (0, 5), result.stderr)
            codes.append(result.returncode)
            if result.returncode == 5:
                self.assert_exit(result, 5, "ulimit -v")
            else:
                self.assertIn("compute in place of 40", result.stderr)
                self.assert_complete(workspace)
            self.assert_no_partial_files(workspace)
        self.assertIn(0, codes)


@unittest.skipUnless(sys.platform == "linux" and not IS_SANITIZED, "counted by Linux, without what sanitizers need")
class Memory(CliTest):
    def test_the_peak_is_not_that_of_the_program_that_starts_it(self):
        ballast = b"\1" * (400 << 20)
        workspace = self.workspace()
        self.assert_exit(self.run_tool(workspace, *FAST), 0)
        record = json.loads((workspace / "stereo/hpm_mvs/run.json").read_text())
        self.assertLess(record["peak_memory_bytes"], len(ballast) // 2)
        self.assertGreater(record["peak_memory_bytes"], 1 << 20)


if __name__ == "__main__":
    unittest.main()
