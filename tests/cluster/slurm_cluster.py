"""A Slurm of its own on this machine, for tests: munged, slurmctld and as many slurmd as
nodes are asked for, all of the user who starts them, in one folder, without a service of
the system. Ports are free ones, so that it runs beside another Slurm."""
import ctypes
import os
import pathlib
import pwd
import secrets
import shutil
import signal
import socket
import subprocess
import time

# Debian has the daemons where only root's search path looks.
_PATH = os.environ.get("PATH", "") + os.pathsep + "/usr/sbin" + os.pathsep + "/sbin"
NEEDED = ("munged", "slurmctld", "slurmd", "sbatch", "scontrol", "squeue", "scancel", "sinfo")

_LIBC = ctypes.CDLL(None)
_PR_SET_PDEATHSIG = 1


def _end_with_the_test():
    """A test that is killed, as after too long, must leave no daemons."""
    _LIBC.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


_CONFIGURATION = """\
ClusterName=hpm
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
# A job that is put back waits until its credential has expired: 120 s, at least 5.
AuthInfo=socket={folder}/munge.socket,cred_expire=5
StateSaveLocation={folder}/state
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdSpoolDir={folder}/spool.%n
SlurmdPidFile={folder}/slurmd.%n.pid
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
# A node that comes back is used again, whatever it was given up for.
ReturnToService=2
SlurmdTimeout={node_timeout}
KillWait=1
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=0
{nodes}
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def missing():
    """The programs of Slurm and munge that this machine has not got."""
    return [name for name in NEEDED if shutil.which(name, path=_PATH) is None]


def _free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


class Cluster:
    def __init__(self, folder, nodes=("near", "far"), cpus=1, node_timeout=4):
        self.folder = pathlib.Path(folder)
        self.environment = {
            **{name: value for name, value in os.environ.items()
               if not name.startswith(("SLURM", "SBATCH", "MUNGE"))},
            "PATH": _PATH,
            "SLURM_CONF": str(self.folder / "slurm.conf"),
        }
        self._daemons = {}
        host = socket.gethostname().split(".")[0]
        ports = _free_ports(1 + len(nodes))
        (self.folder / "slurm.conf").write_text(_CONFIGURATION.format(
            host=host, ports=ports, folder=self.folder, node_timeout=node_timeout,
            user=pwd.getpwuid(os.getuid()).pw_name,
            nodes="\n".join(
                f"NodeName={node} NodeHostname={host} NodeAddr=127.0.0.1 Port={port} CPUs={cpus}"
                for node, port in zip(nodes, ports[1:])
            ),
        ))
        (self.folder / "state").mkdir()
        key = self.folder / "munge.key"
        key.touch(0o600)
        key.write_bytes(secrets.token_bytes(128))
        # The folder is this user's alone, what munged else warns of does not matter.
        self._start("munged", "munged", "--foreground", "--force", f"--key-file={key}",
                    f"--socket={self.folder}/munge.socket", f"--pid-file={self.folder}/munged.pid",
                    f"--seed-file={self.folder}/munge.seed", f"--log-file={self.folder}/munged.log")
        self._wait_until((self.folder / "munge.socket").exists, "munged opens its socket")
        self._start("slurmctld", "slurmctld", "-D", "-c")
        for node in nodes:
            self.start_node(node)
        self._wait_until(lambda: self.call("sinfo", "-h", "-t", "idle", "-o", "%D").strip()
                         == str(len(nodes)), "all nodes are idle")

    def _start(self, name, *command, **environment):
        with open(self.folder / f"{name}.out", "ab") as out:
            self._daemons[name] = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT,
                env={**self.environment, **environment}, start_new_session=True,
                preexec_fn=_end_with_the_test,
            )

    def _wait_until(self, condition, what, seconds=60):
        deadline = time.monotonic() + seconds
        while not condition():
            dead = [name for name, process in self._daemons.items() if process.poll() is not None]
            if dead or time.monotonic() > deadline:
                raise RuntimeError(f"not reached: {what}; ended: {dead}\n{self.logs()}")
            time.sleep(0.05)

    def start_node(self, node):
        (self.folder / f"spool.{node}").mkdir(exist_ok=True)
        # The helpers that it starts for jobs inherit the variable, by which they are found.
        self._start(node, "slurmd", "-D", "-N", node, HPM_TEST_NODE=node)

    def processes(self, node):
        """Ids of all that would end with the node: its slurmd, helpers of it and jobs."""
        marks = {f"HPM_TEST_NODE={node}".encode(), f"SLURMD_NODENAME={node}".encode()}
        configuration = f"SLURM_CONF={self.environment['SLURM_CONF']}".encode()
        found = []
        for path in pathlib.Path("/proc").glob("[0-9]*/environ"):
            try:
                variables = set(path.read_bytes().split(b"\0"))
            except OSError:
                continue  # it has ended, or is another user's
            if configuration in variables and marks & variables:
                found.append(int(path.parent.name))
        return found

    def kill_node(self, node):
        """What a power failure does: nothing of the node goes on, nobody is told."""
        while pids := self.processes(node):
            for pid in pids:
                try:
                    os.kill(pid, signal.SIGKILL)
                except ProcessLookupError:
                    pass
            daemon = self._daemons.pop(node, None)
            if daemon:
                daemon.wait()
            time.sleep(0.01)

    def call(self, *command, **environment):
        """The output of a command of Slurm, or of a script that calls some."""
        result = subprocess.run(
            command, env={**self.environment, **environment}, cwd=self.folder,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=120,
        )
        if result.returncode != 0:
            raise RuntimeError(f"{command} ended with {result.returncode}: {result.stderr}")
        return result.stdout

    def tasks(self):
        """State and node of each task that was ever given, by job and index: '5_0', '7'."""
        tasks = {}
        for line in self.call("scontrol", "show", "job", "--oneliner", "--all").splitlines():
            fields = dict(word.split("=", 1) for word in line.split() if "=" in word)
            if "JobState" in fields:
                job = fields.get("ArrayJobId", fields["JobId"])
                index = "_" + fields["ArrayTaskId"] if "ArrayTaskId" in fields else ""
                tasks[job + index] = (fields["JobState"], fields.get("NodeList", "(null)"))
        return tasks

    def logs(self):
        texts = []
        for path in sorted(self.folder.glob("*.out")):
            texts.append(f"--- {path.name}\n{path.read_text(errors='replace')[-4000:]}")
        return "\n".join(texts)

    def stop(self):
        for node in [name for name in self._daemons if name not in ("munged", "slurmctld")]:
            self.kill_node(node)
        for process in self._daemons.values():
            process.kill()
            process.wait()
        self._daemons = {}
