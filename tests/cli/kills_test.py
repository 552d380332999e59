"""kill -9 at random moments: what lies under a final name is whole and right at any time,
and resuming gives the bytes of a straight run. HPM_KILLS=<n> says how many times,
HPM_KILLS_SEED from which random numbers; a few by default."""
import os
import random
import subprocess
import time
import unittest

from support import CliTest, map_files

NUM_KILLS = int(os.environ.get("HPM_KILLS", "8"))
SEED = int(os.environ.get("HPM_KILLS_SEED", "1"))
OPTIONS = ["--Hpm.num_iterations=2", "--PatchMatchStereo.num_threads=2"]


class Kills(CliTest):
    def start(self, workspace):
        process = subprocess.Popen(
            self.command(workspace, *OPTIONS), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
        )
        self.addCleanup(process.stderr.close)
        return process

    def finish(self, workspace, expected):
        self.assert_exit(self.run_tool(workspace, *OPTIONS), 0)
        self.assert_no_partial_files(workspace)
        self.assert_same_maps(map_files(workspace), expected)

    def test_kill_and_resume_give_the_bytes_of_a_straight_run(self):
        straight = self.workspace(width=64, height=48)
        begin = time.monotonic()
        self.assert_exit(self.run_tool(straight, *OPTIONS), 0)
        seconds = time.monotonic() - begin
        expected = map_files(straight)

        numbers = random.Random(SEED)
        workspace = self.workspace(width=64, height=48)
        num_kills = num_finished = 0
        while num_kills < NUM_KILLS:
            process = self.start(workspace)
            try:
                error = process.communicate(timeout=numbers.uniform(0, seconds))[1]
            except subprocess.TimeoutExpired:
                process.kill()
                process.communicate()
                num_kills += 1
                for name, data in map_files(workspace).items():
                    self.assertTrue(data == expected[name], f"kill {num_kills}: {name}")
                continue
            # It was faster.
            self.assertEqual(process.returncode, 0, error)
            num_finished += 1
            self.finish(workspace, expected)
            workspace = self.workspace(width=64, height=48)
        self.finish(workspace, expected)
        print(f"{num_kills} kills, {num_finished} runs that ended before, seed {SEED}")


if __name__ == "__main__":
    unittest.main()
