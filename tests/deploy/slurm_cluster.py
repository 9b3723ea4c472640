"""A Slurm cluster on this machine, on loopback, for the duration of a test."""

import os
import pathlib
import shutil
import signal
import socket
import subprocess
import time

PROGRAMS = ["munged", "slurmctld", "slurmd", "sbatch", "scontrol", "unshare"]

# Several nodes on one machine, without features that containers forbid. A node counts as dead after
# ten seconds; a requeued task waits until its old credential has expired.
SETTINGS = """\
ClusterName=strahl
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
SlurmctldPort={controller_port}
SlurmctldPidFile={home}/slurmctld.pid
SlurmctldLogFile={home}/slurmctld.log
SlurmdPidFile={home}/%n.pid
SlurmdLogFile={home}/%n.log
SlurmdSpoolDir={home}/%n
SlurmdParameters=config_overrides
StateSaveLocation={home}/state
AuthType=auth/munge
AuthInfo=socket={home}/munge.socket,cred_expire=5
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/backfill
SchedulerParameters=bf_interval=1,sched_interval=2,sched_min_interval=0
SlurmctldTimeout=60
SlurmdTimeout=10
ReturnToService=2
RequeueExit=75
PartitionName=all Nodes=ALL Default=YES State=UP
"""
NODE = "NodeName={name} NodeHostname={host} NodeAddr=127.0.0.1 Port={port} CPUs=1 State=UNKNOWN\n"


def missing():
    """Returns the reason why no cluster can be started here, or nothing."""
    absent = [program for program in PROGRAMS if shutil.which(program, path=search_path()) is None]
    if absent:
        return "not installed: " + ", ".join(absent)
    if os.geteuid() != 0:
        return "only root can start a node"
    namespaces = ["unshare", "--pid", "--fork", "--kill-child", "--mount-proc", "true"]
    if subprocess.run(namespaces, capture_output=True).returncode != 0:
        return "this machine gives no PID namespaces"
    return None


def search_path():
    return os.environ.get("PATH", "") + ":/usr/sbin:/sbin"


def free_ports(count):
    sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


def until(found, what, seconds=60):
    """Calls `found` until it returns something, and returns that."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        result = found()
        if result:
            return result
        time.sleep(0.02)
    raise TimeoutError(f"after {seconds} seconds not yet: {what}")


class Cluster:
    """munge, a controller and nodes, for use in `with`."""

    def __init__(self, home, nodes, environment):
        self.home = pathlib.Path(home)
        self.names = [f"node{number}" for number in range(nodes)]
        self.processes = {}
        host = socket.gethostname().split(".")[0]
        controller_port, *ports = free_ports(nodes + 1)
        settings = SETTINGS.format(home=home, host=host, controller_port=controller_port)
        for name, port in zip(self.names, ports):
            settings += NODE.format(name=name, host=host, port=port)
        (self.home / "slurm.conf").write_text(settings)
        self.environment = environment | {"SLURM_CONF": f"{home}/slurm.conf"}
        self.environment["PATH"] += ":/usr/sbin:/sbin"

    def __enter__(self):
        try:
            self.start_munge()
            self.start_controller()
            for name in self.names:
                self.start_node(name)
            until(lambda: self.idle() == len(self.names), "all nodes are idle")
        except BaseException:
            self.stop()
            raise
        return self

    def __exit__(self, *_):
        self.stop()

    def start_munge(self):
        key = self.home / "munge.key"
        key.write_bytes(os.urandom(64))
        key.chmod(0o400)
        own = ["key", "pid", "log", "seed"]
        files = [f"--{what}-file={self.home}/munge.{what}" for what in own]
        socket_file = self.home / "munge.socket"
        self.start("munged", ["munged", "--foreground", "--force", *files, "--socket", socket_file])
        until(socket_file.exists, "munge answers")

    def start_controller(self):
        (self.home / "state").mkdir(exist_ok=True)
        self.start("slurmctld", ["slurmctld", "-D"])
        until(self.answers, "the controller answers")

    def stop_controller(self):
        """Stops the controller by SIGTERM, so that it saves its state. If killed within seconds of an
        sbatch, it loses that job."""
        self.end("slurmctld", signal.SIGTERM)

    def start_node(self, name):
        (self.home / name).mkdir(exist_ok=True)
        namespace = ["unshare", "--pid", "--fork", "--kill-child", "--mount-proc"]
        self.start(name, [*namespace, "slurmd", "-D", "-N", name])

    def kill_node(self, name):
        """Kills the node and everything on it at once, like a power failure."""
        namespace = self.processes.pop(name)
        children = pathlib.Path(f"/proc/{namespace.pid}/task/{namespace.pid}/children")
        for first in children.read_text().split():
            os.kill(int(first), signal.SIGKILL)
        namespace.wait(60)

    def start(self, name, command):
        with open(self.home / f"{name}.out", "a") as out:
            self.processes[name] = subprocess.Popen(
                command, env=self.environment, stdin=subprocess.DEVNULL, stdout=out, stderr=out
            )

    def end(self, name, how):
        process = self.processes.pop(name)
        process.send_signal(how)
        process.wait(60)

    def stop(self):
        for name in [name for name in self.names if name in self.processes]:
            self.kill_node(name)
        for name in [name for name in ["slurmctld", "munged"] if name in self.processes]:
            self.end(name, signal.SIGTERM)

    def run(self, *command, **others):
        return subprocess.run(
            command, env=self.environment, capture_output=True, text=True, timeout=60, **others
        )

    def answers(self):
        return self.run("scontrol", "ping").stdout.find("is UP") >= 0

    def idle(self):
        return self.run("scontrol", "--oneliner", "show", "nodes").stdout.count("State=IDLE ")

    def jobs(self, array):
        """Returns the state, exit code and so on of each task of an array, or of one job."""
        lines = self.run("scontrol", "--oneliner", "show", "job", array).stdout.splitlines()
        split = [dict(word.split("=", 1) for word in line.split() if "=" in word) for line in lines]
        # Tasks that have not begun may share one line, such as `4-7`.
        tasks = [(job.get("ArrayTaskId", "0"), job) for job in split]
        return {int(task): job for task, job in tasks if task.isdigit()}
