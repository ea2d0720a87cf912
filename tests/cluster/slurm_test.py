#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""slurm_test.py CINCH SUBMIT: a study and a fuzz campaign as array jobs of a real Slurm on this machine.

Tasks and a node daemon are killed in the middle, what merge names is submitted again, and the result is that of a run
without shards. Skips, saying so, where Slurm cannot run. Everything that is started ends with the test."""
import contextlib
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

cinch, submit = map(os.path.abspath, sys.argv[1:3])
processes = []


def skip(why):
    print(f"SKIPPED: {why}")
    sys.exit(0)


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def wait_for(what, condition, seconds=180):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return
        time.sleep(0.2)
    raise TimeoutError(what)


def kill_tasks(folder):
    found = subprocess.run(["pgrep", "-f", f"slurmstepd|--out {folder}"], capture_output=True, text=True)
    for pid in found.stdout.split():
        with contextlib.suppress(ProcessLookupError):
            os.kill(int(pid), signal.SIGKILL)


class Slurm:
    """munged, slurmctld and a slurmd, in a folder of their own, on loopback."""

    def __init__(self, folder):
        self.folder = folder
        host = socket.gethostname()
        ctld, self.node_port = free_port(), free_port()
        key = folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        for name in ("state", "spool"):
            (folder / name).mkdir()
        self.conf = folder / "slurm.conf"
        self.conf.write_text(f"""
ClusterName=cinch
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ctld}
SlurmdPort={self.node_port}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket,cred_expire=10
CredType=cred/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/builtin
SchedulerParameters=sched_interval=2,batch_sched_delay=0,sched_min_interval=100000
ReturnToService=2
SlurmctldTimeout=30
SlurmdTimeout=10
InactiveLimit=0
MinJobAge=300
KillWait=2
NodeName={host} NodeAddr=127.0.0.1 Port={self.node_port} CPUs={os.cpu_count()} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
""")
        (folder / "cgroup.conf").write_text("CgroupPlugin=cgroup/v1\n")
        self.environment = dict(os.environ, SLURM_CONF=str(self.conf), CINCH=cinch)
        self.start("munged", "--foreground", "--force", f"--socket={folder}/munge.socket", f"--key-file={key}",
                   f"--pid-file={folder}/munged.pid", f"--log-file={folder}/munged.log", f"--seed-file={folder}/seed")
        wait_for("munged", (folder / "munge.socket").exists, 10)
        self.start("slurmctld", "-D", "-f", self.conf)
        self.node = self.start("slurmd", "-D", "-f", self.conf)
        wait_for("an idle node", lambda: "idle" in self.call("sinfo", "-h", "-o", "%T", check=False))

    def start(self, program, *arguments):
        log = open(self.folder / f"{program}.out", "ab")
        process = subprocess.Popen([shutil.which(program, path="/usr/sbin:/usr/bin:/sbin"), *map(str, arguments)],
                                   env=self.environment, stdout=log, stderr=log)
        processes.append(process)
        return process

    def call(self, *words, check=True):
        done = subprocess.run(words, env=self.environment, capture_output=True, text=True)
        assert not check or done.returncode == 0, (words, done.stdout, done.stderr)
        return done.stdout

    def submit(self, *words):
        said = self.call(submit, *map(str, words))
        return re.search(r"array (\d+), merge (\d+)", said).groups()

    def running(self, job):
        return self.call("squeue", "-h", "-r", "-j", job, "-t", "R", "-o", "%i", check=False).split()

    def wait(self, job, seconds=600):
        wait_for(f"job {job}", lambda: not self.call("squeue", "-h", "-j", job, check=False).strip(), seconds)

    def lose_node(self):
        """The daemon and all that it runs, at once, as when a machine is switched off; then a new one."""
        self.node.send_signal(signal.SIGKILL)
        self.node.wait()
        kill_tasks(self.folder)
        time.sleep(1)
        self.node = self.start("slurmd", "-D", "-f", self.conf)


def without_times(text):
    return re.sub(r'"seconds":[^,}]*', '"seconds":0', text)


def campaign(slurm, name, words, shards):
    """As arrays: tasks killed, the node lost, then what merge names, until all is there."""
    began = time.monotonic()
    folder = slurm.folder / name
    whole = subprocess.run([cinch, *words, "--out", str(slurm.folder / f"{name}-whole"), "--json"], capture_output=True,
                           text=True, check=True).stdout
    job, merge = slurm.submit("--shards", shards, "--", *words, "--out", folder)
    wait_for("tasks", lambda: slurm.running(job))
    time.sleep(1)
    for task in slurm.running(job)[:1]:
        slurm.call("scancel", "--signal=KILL", "--full", task, check=False)
    wait_for("tasks", lambda: slurm.running(job))
    time.sleep(1)
    slurm.lose_node()
    slurm.wait(job)
    slurm.wait(merge)
    resubmitted = 0
    while not (folder / "merged.jsonl").exists():
        said = (folder / "log" / "merge.txt").read_text()
        missing = re.search(r"--array=([\d,-]+)", said)
        assert missing, said
        resubmitted += 1
        assert resubmitted <= 3, said
        job, merge = slurm.submit("--shards", shards, f"--array={missing.group(1)}", "--", *words, "--out", folder)
        slurm.wait(job)
        slurm.wait(merge)
    assert without_times((folder / "merged.jsonl").read_text()) == without_times(whole)
    print(f"{name}: {shards} tasks, resubmitted {resubmitted} times, the same {len(whole)} bytes; "
          f"{time.monotonic() - began:.0f} s")


def main():
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # what was started ends with it
    if os.geteuid() != 0:
        skip("Slurm's daemons want to be root here")
    for program in ("munged", "slurmctld", "slurmd", "sbatch"):
        if not shutil.which(program, path="/usr/sbin:/usr/bin:/sbin"):
            skip(f"there is no {program}")
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        folder.chmod(0o755)
        try:
            began = time.monotonic()
            try:
                slurm = Slurm(folder)
            except TimeoutError as error:
                logs = "\n".join(f"{log.name}: {log.read_text()[-400:]}" for log in folder.glob("*.out"))
                skip(f"Slurm does not come up here: no {error}\n{logs}")
            print(f"Slurm is up after {time.monotonic() - began:.0f} s")
            plan = folder / "plan.json"
            plan.write_text(json.dumps({"inputs": ["santa"], "nodes": "8..64", "seeds": "0-3", "frames": 1,
                                        "leaf": 16, "methods": ["eq12", "best"]}))
            campaign(slurm, "study", ["study", str(plan)], 5)
            campaign(slurm, "fuzz", ["fuzz", "--cases", "250000", "--seed", "5"], 4)
        finally:
            kill_tasks(folder)
            for process in reversed(processes):
                with contextlib.suppress(ProcessLookupError):
                    process.terminate()
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(10)
                if process.poll() is None:
                    process.kill()


main()
