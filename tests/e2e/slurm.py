"""A Slurm cluster of emulated nodes on this machine, with a folder and ports of its own.

Its daemons are those of Debian's slurm-wlm and munge, started here and ended by their ids. It needs
root, as slurmd does.
"""

import os
import shutil
import signal
import socket
import subprocess
import time
from pathlib import Path

PROGRAMS = {name: shutil.which(name, path=os.environ["PATH"] + ":/usr/sbin")
            for name in ("munged", "slurmctld", "slurmd", "sbatch", "scontrol", "squeue")}


def missing():
    """Why there can be no cluster here; empty where there can."""
    absent = [name for name, path in PROGRAMS.items() if path is None]
    if absent:
        return f"{', '.join(absent)} not installed (deploy/install_packages.sh --with-tests)"
    return "" if os.geteuid() == 0 else "slurmd needs root"


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


class Cluster:
    """`nodes` nodes of one core each, named n1, n2, ..."""

    def __init__(self, folder, nodes=2):
        self.folder = Path(folder)
        self.folder.mkdir(mode=0o755)
        self.nodes = [f"n{number}" for number in range(1, nodes + 1)]
        self.processes = []
        self.environment = dict(os.environ, SLURM_CONF=str(self.folder / "slurm.conf"))
        try:
            self._start()
        except BaseException:
            self.end()
            raise

    def _spawn(self, *arguments):
        with open(self.folder / f"{Path(arguments[0]).name}-{len(self.processes)}.log", "wb") as log:
            self.processes.append(subprocess.Popen(
                [str(argument) for argument in arguments], stdin=subprocess.DEVNULL, stdout=log,
                stderr=log, env=self.environment, start_new_session=True))

    def _start(self):
        munge = self.folder / "munge"
        munge.mkdir(mode=0o711)
        (munge / "key").write_bytes(os.urandom(128))
        (munge / "key").chmod(0o600)
        self._spawn(PROGRAMS["munged"], "--foreground", "--force", f"--socket={munge}/socket",
                    f"--key-file={munge}/key", f"--pid-file={munge}/pid",
                    f"--log-file={munge}/log", f"--seed-file={munge}/seed", "--num-threads=2")
        controller, *ports = free_ports(1 + len(self.nodes))
        for name in ("state", "spool", *(f"spool/{node}" for node in self.nodes)):
            (self.folder / name).mkdir()
        host = socket.gethostname()
        lines = ["ClusterName=reident", f"SlurmctldHost={host}(127.0.0.1)",
                 f"SlurmctldPort={controller}", "SlurmUser=root", "SlurmdUser=root",
                 "AuthType=auth/munge", f"AuthInfo=socket={munge}/socket",
                 f"StateSaveLocation={self.folder}/state", f"SlurmdSpoolDir={self.folder}/spool/%n",
                 f"SlurmctldPidFile={self.folder}/slurmctld.pid",
                 f"SlurmdPidFile={self.folder}/%n.pid",
                 f"SlurmctldLogFile={self.folder}/slurmctld.log",
                 f"SlurmdLogFile={self.folder}/%n.log", "ProctrackType=proctrack/linuxproc",
                 "TaskPlugin=task/none", "SelectType=select/cons_tres",
                 "SelectTypeParameters=CR_CPU", "ReturnToService=2", "JobRequeue=1",
                 "SchedulerParameters=sched_interval=1,batch_sched_delay=0,bf_interval=1",
                 "MpiDefault=none"]
        for node, port in zip(self.nodes, ports):
            lines.append(f"NodeName={node} NodeHostname={host} NodeAddr=127.0.0.1 Port={port} "
                         "CPUs=1 State=UNKNOWN")
        lines.append("PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP "
                     "OverSubscribe=NO")
        (self.folder / "slurm.conf").write_text("\n".join(lines) + "\n")
        (self.folder / "cgroup.conf").write_text("CgroupPlugin=cgroup/v1\n")
        self.wait(lambda: (munge / "socket").exists(), "munged has its socket")
        self._spawn(PROGRAMS["slurmctld"], "-D")
        for node in self.nodes:
            self._spawn(PROGRAMS["slurmd"], "-D", "-N", node)
        self.wait(lambda: self.command("scontrol", "show", "nodes").count("State=IDLE") ==
                  len(self.nodes), "all nodes are idle")

    def wait(self, condition, what, deadline_s=60):
        end = time.monotonic() + deadline_s
        while not condition():
            if time.monotonic() > end:
                logs = "\n".join(f"---- {log.name}\n{log.read_text(errors='replace')[-600:]}"
                                 for log in sorted(self.folder.glob("*.log")))
                raise AssertionError(f"after {deadline_s} s still not: {what}\n{logs}")
            time.sleep(0.1)  # poll

    def command(self, name, *arguments):
        done = subprocess.run([PROGRAMS[name], *map(str, arguments)], env=self.environment,
                              capture_output=True, text=True, timeout=60, check=False)
        return done.stdout

    def running(self):
        """Ids of the tasks that run, such as 12_3, with their nodes."""
        lines = self.command("squeue", "--noheader", "--states=RUNNING", "--format=%i %N")
        return dict(line.split() for line in lines.splitlines() if len(line.split()) == 2)

    def idle(self):
        """Whether no task is left. Those that were requeued begin without the two minutes that
        Slurm waits."""
        lines = self.command("squeue", "--noheader", "--array", "--format=%i %r").splitlines()
        for task, reason in (line.split(None, 1) for line in lines):
            if reason.strip() == "BeginTime":
                self.command("scontrol", "update", f"JobId={task}", "StartTime=now")
        return not lines

    def end(self):
        for process in reversed(self.processes):
            if process.poll() is None:
                process.terminate()
        for process in reversed(self.processes):
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
