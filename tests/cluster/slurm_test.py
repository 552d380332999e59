"""The arrays of scripts/cluster/slurm.sh on a real Slurm with two nodes, of which one dies
with its task in the middle, and another task's process is killed. Exit code 77: Slurm or
munge is missing."""
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest

import slurm_cluster

if slurm_cluster.missing():
    print(f"skipped: {', '.join(slurm_cluster.missing())} not found; "
          "scripts/install_dependencies.sh --slurm installs Slurm and munge", file=sys.stderr)
    sys.exit(77)

from support import FAST, HPM_MVS, TIME_FACTOR, CliTest, map_files

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHARDS = 3
VIEWS = 9
# A view takes long enough to be met in the middle, and one thread is what a node has.
OPTIONS = [
    option.replace("num_iterations=1", "num_iterations=40").replace("threads=2", "threads=1")
    .replace("geom_passes=1", "geom_passes=2")
    for option in FAST
]


class Slurm(CliTest):
    def setUp(self):
        self.dense = self.workspace(views=VIEWS, width=64, height=48)
        folder = self.dense.parent / "slurm"
        folder.mkdir(mode=0o700)
        self.cluster = slurm_cluster.Cluster(folder)
        self.addCleanup(self.cluster.stop)
        self.seen = {}

    def submit(self, program=HPM_MVS):
        output = self.cluster.call(
            str(ROOT / "scripts/cluster/slurm.sh"), str(SHARDS), str(self.dense), *OPTIONS,
            HPM_MVS=str(program), HPM_WAIT="0.2", SBATCH_OPTIONS="--cpus-per-task=1",
        )
        return output.split()

    def fail(self, message=None):
        jobs = self.cluster.call("scontrol", "show", "job", "--all")
        super().fail(f"{message}\n{jobs}\n{self.cluster.logs()}\n"
                   + "\n".join(text[-2000:] for text in self.task_logs()))

    def task_logs(self):
        return [path.read_text() for path in sorted(self.cluster.folder.glob("slurm-*.out"))]

    def look_at_maps(self):
        """No map that was once there is written again."""
        for path in (self.dense / "stereo").rglob("*.bin"):
            try:
                status = path.stat()
            except FileNotFoundError:
                continue  # only another stage needed it
            identity = (status.st_ino, status.st_mtime_ns)
            if self.seen.setdefault(path, identity) != identity:
                self.fail(f"{path} was written twice")

    def wait_until(self, condition, what, seconds=180):
        deadline = time.monotonic() + seconds * TIME_FACTOR
        while not condition():
            self.look_at_maps()
            if time.monotonic() > deadline:
                self.fail(f"not reached: {what}")
            time.sleep(0.02)

    def hpm_of(self, node, job):
        """The process of a task of the job that works on a view on the node."""
        for task, (state, where) in self.cluster.tasks().items():
            log = self.cluster.folder / f"slurm-{task}.out"
            if task.split("_")[0] == job and (state, where) == ("RUNNING", node):
                lines = re.findall(r"Processing view", log.read_text() if log.exists() else "")
                pids = [pid for pid in self.cluster.processes(node) if self.is_hpm(pid)]
                # The second one: something has been finished that must not be done again.
                if len(lines) >= 2 and pids:
                    return task, pids[0]
        return None

    @staticmethod
    def is_hpm(pid):
        try:
            return os.readlink(f"/proc/{pid}/exe") == os.path.realpath(HPM_MVS)
        except OSError:
            return False

    def meet(self, node, job):
        found = []

        def met():
            found.append(self.hpm_of(node, job))
            return found[-1] is not None

        self.wait_until(met, f"a task of {job} is in the middle on {node}")
        return found[-1]

    def states(self, job):
        return {task: state for task, (state, _) in self.cluster.tasks().items()
                if task.split("_")[0] == job}

    def test_all_maps_come_once_though_a_node_and_a_process_die(self):
        whole = self.dense.parent / "whole"
        shutil.copytree(self.dense, whole)
        self.assert_exit(self.run_tool(whole, *OPTIONS), 0)
        expected = map_files(whole)

        first, *others = jobs = self.submit()
        self.assertEqual(len(jobs), 4)  # three stages and the end
        killed_task, pid = self.meet("near", first)
        os.kill(pid, signal.SIGKILL)
        lost_task, _ = self.meet("far", first)
        self.cluster.kill_node("far")
        self.assertNotEqual(killed_task, lost_task)
        self.wait_until(lambda: len(self.states(first)) == SHARDS
                        and set(self.states(first).values()) == {"COMPLETED"},
                        "the other node finishes the stage")
        self.cluster.start_node("far")
        self.wait_until(lambda: all(set(self.states(job).values()) == {"COMPLETED"} for job in others),
                        "all jobs end")

        self.look_at_maps()
        logs = "\n".join(self.task_logs())
        self.assertIn("killed by signal 9", logs)
        self.assertIn("Restarts=1", self.cluster.call("scontrol", "show", "job", lost_task))
        status = subprocess.run(
            [HPM_MVS, "status", "--workspace_path", str(self.dense), *OPTIONS],
            stdout=subprocess.PIPE, text=True, timeout=120,
        )
        self.assertEqual(status.returncode, 0, status.stdout)
        # The last job has removed what only stages needed.
        self.assertEqual(list((self.dense / "stereo/hpm_mvs").rglob("*.bin")), [])
        self.assert_same_maps(map_files(self.dense), expected)
        self.assert_no_partial_files(self.dense)
        # Worked on twice is only what was in work when it died.
        self.assertLessEqual(len(re.findall("Processing view", logs)), 3 * VIEWS + 2)

    def test_what_waits_for_a_failed_stage_does_not_wait_for_ever(self):
        failing = self.cluster.folder / "failing"
        failing.write_text(f'#!/bin/sh\n[ "$1" = status ] || exit 5\nexec "{HPM_MVS}" "$@"\n')
        failing.chmod(0o755)
        first, *others = self.submit(failing)
        self.wait_until(lambda: set(self.states(first).values()) == {"FAILED"}
                        and all(set(self.states(job).values()) == {"CANCELLED"} for job in others),
                        "all jobs end")


if __name__ == "__main__":
    unittest.main()
