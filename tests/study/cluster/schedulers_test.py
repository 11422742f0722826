#!/usr/bin/env python3
"""128 cases in 8 shards under the real schedulers, with a node and a task that die in the middle.

The last cases of a shard wait (faulty:mode=held) until the test has interfered with it, however fast the machine is.
Slurm (slurmctld, two slurmd, munged) runs on the loopback address as the calling user, in a folder of its own.
Debian: slurmctld, slurmd, slurm-client, munge, parallel; without them the tests are skipped (77) with a message."""

import contextlib
import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "cli"))
import stored  # noqa: E402
from command_line import BINARIES, CommandLine, facts_of, rows_of  # noqa: E402

SLURM = ("slurmctld", "slurmd", "sbatch", "munged")
PROGRAM = "taut-faulty"
LONGEST = 130  # s, limit of a test, for every wait on a scheduler
os.environ["PATH"] += ":/usr/sbin:/sbin"

CONFIGURATION = """
ClusterName=taut
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket,cred_expire=5
SlurmctldPort={ports[0]}
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/%n.pid
SlurmdSpoolDir={folder}/spool/%n
StateSaveLocation={folder}/state
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
SlurmdTimeout=6
KillWait=5
ReturnToService=2
SchedulerParameters=sched_interval=1,sched_min_interval=0
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
NodeName=n1 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1]} CPUs=2 RealMemory=4000
NodeName=n2 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[2]} CPUs=2 RealMemory=4000
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


def too_long(*_):
    raise TimeoutError(f"not done within {LONGEST} s")


class Schedulers(CommandLine):
    def setUp(self):
        super().setUp()
        signal.signal(signal.SIGALRM, too_long)
        signal.alarm(LONGEST)
        self.addCleanup(signal.alarm, 0)
        os.environ["TAUT"] = str(BINARIES / PROGRAM)
        self.study(scenes=["./small.toml"],  # larger estimates run first: cases with sweeps before those that wait
                   solvers=["jakobsen:order=mesh,substeps=1", "bullet", *(f"faulty:mode=held,variant={i}" for i in range(32))],
                   rest='set = ["cloth.grid=[12, 12]"]\naxes.iterations = { from = 2, to = 49, steps = 48 }\n')

    def wait_for(self, what):
        try:
            while not (value := what()):
                time.sleep(0.2)
        except TimeoutError:
            self.fail("waited in vain: " + self.said())
        return value

    def said(self):
        logs = [*self.folder.glob("*.log"), *self.folder.glob("c/log/*"), *self.folder.glob("*.out")]
        return "".join(f"\n== {file.name}\n{file.read_text()[-1500:]}" for file in logs)

    def sessions(self):
        """Starts of shards that have stored something."""
        return sorted(row["session"] for shard in (self.folder / "c/shards").glob("*") if stored.keys(shard)
                      for row in stored.query(shard, "SELECT session FROM sessions"))

    def tasks(self, node=None):
        """Process ids of this test's `taut run`."""
        found = []
        for entry in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                words = (entry / "cmdline").read_bytes().split(b"\0")
                told = (entry / "environ").read_bytes().split(b"\0")
                here = (entry / "cwd").resolve() == self.folder / "c"
            except OSError:
                continue
            if b"run" in words and b"--shard" in words and words[0].endswith(PROGRAM.encode()) and here:
                if node is None or b"SLURMD_NODENAME=" + node.encode() in told:
                    found.append(int(entry.name))
        return found

    def let_go(self):
        """Lets waiting cases continue; later ones do not wait."""
        for folder in (self.folder, self.folder / "c"):
            (folder / "go-on").touch()

    def submit(self, *words):
        return "cluster", "submit", "./study.toml", "--folder", "c", *words

    def status(self):
        process = self.taut("cluster", "status", "c", "--json", program=PROGRAM, expect=None)
        self.assertIn(process.returncode, (0, 3), process.err)
        return json.loads(process.out)

    def unfinished(self):
        return [row for row in rows_of(self.status(), "shards") if row["state"] != "done"]

    def merged_equals_a_single_run(self):
        merged = self.taut("cluster", "merge", "c", "--out", "m", program=PROGRAM)
        single = self.taut("run", "./study.toml", "--out", "single", "-j", 2, program=PROGRAM)
        self.assertIn(self.store_digest(single).split()[1], merged.out)


class Slurm(Schedulers):
    def setUp(self):
        super().setUp()
        lacking = [name for name in SLURM if not shutil.which(name)]
        if lacking:
            self.skipTest("not installed: " + ", ".join(lacking))
        self.daemons = {}
        for name in ("spool/n1", "spool/n2", "state"):
            (self.folder / name).mkdir(parents=True)
        os.chmod(self.folder, 0o700)
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(64))
        key.chmod(0o400)
        user = subprocess.run(["id", "-un"], capture_output=True, text=True, check=True).stdout.strip()
        conf = self.folder / "slurm.conf"
        conf.write_text(CONFIGURATION.format(host=socket.gethostname().split(".")[0], user=user, folder=self.folder,
                                             ports=free_ports(3)))
        os.environ["SLURM_CONF"] = str(conf)
        self.addCleanup(os.environ.pop, "SLURM_CONF")
        self.addCleanup(self.end)
        self.daemon("munged", "--foreground", "--force", *(f"--{what}={self.folder}/munge.{end}" for what, end in (
            ("key-file", "key"), ("socket", "socket"), ("pid-file", "pid"), ("log-file", "log"), ("seed-file", "seed"))))
        self.daemon("slurmctld", "-D")
        for node in ("n1", "n2"):
            self.daemon("slurmd", "-D", "-N", node, name=node)
        for _ in range(100):
            if "2 idle" in " ".join(self.ask("sinfo", "-h", "-o", "%D %t").split()):
                return
            dead = [name for name, process in self.daemons.items() if process.poll() is not None]
            if dead:
                break
            time.sleep(0.2)
        self.skipTest("Slurm does not start here: " + self.said())

    def daemon(self, *words, name=None):
        with open(self.folder / f"{name or words[0]}.out", "w") as out:
            self.daemons[name or words[0]] = subprocess.Popen(words, stdout=out, stderr=out, start_new_session=True)

    def end(self):
        signal.alarm(10)
        with contextlib.suppress(TimeoutError):
            self.ask("scancel", "--signal=KILL", "--user", str(os.geteuid()))
        signal.alarm(0)
        for pid in self.tasks():
            os.kill(pid, signal.SIGKILL)
        for process in reversed(self.daemons.values()):
            process.kill()
            process.wait()

    def ask(self, *words):
        return subprocess.run(words, capture_output=True, text=True).stdout

    def power_off(self, node):
        """Kills the node's daemon and everything that it runs, all at once."""
        mine = [int(entry.name) for entry in pathlib.Path("/proc").glob("[0-9]*")
                if self.told(entry, f"SLURMD_NODENAME={node}")]
        self.daemons[node].kill()
        self.daemons[node].wait()
        steps = {step for step in map(self.parent, mine) if self.is_step(step)}
        for pid in [*steps, *mine]:
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass

    def parent(self, pid):
        try:
            return int(pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])
        except OSError:
            return 0

    def is_step(self, pid):
        file = pathlib.Path(f"/proc/{pid}/comm")
        return file.exists() and file.read_text().startswith("slurmstepd")

    def told(self, entry, variable):
        try:
            told = (entry / "environ").read_bytes().split(b"\0")
        except OSError:
            return False
        return variable.encode() in told and f"SLURM_CONF={self.folder}/slurm.conf".encode() in told

    def test_a_node_and_a_task_die_in_the_middle(self):
        out = self.taut(*self.submit("--on", "slurm", "--shards", 8), program=PROGRAM).out
        self.assertRegex(out, r"cases +128")
        self.wait_for(lambda: len(self.sessions()) >= 3 and self.tasks("n1") and self.tasks("n2"))
        job = self.ask("squeue", "-h", "-t", "R", "-w", "n2", "-o", "%F_%a").split()[0]
        self.ask("scontrol", "requeue", job)  # as a preemption does: SIGTERM, then back into the queue
        self.wait_for(lambda: self.tasks("n1") and self.tasks("n2"))
        os.kill(self.tasks("n2")[0], signal.SIGKILL)
        self.power_off("n1")
        self.assertRegex(self.taut("cluster", "merge", "c", "--out", "m", program=PROGRAM, expect=3).out, r"merged +no")
        self.let_go()
        self.wait_for(lambda: not self.ask("squeue", "-h").strip())
        self.assertIn("requeue", (self.folder / "slurmctld.log").read_text().lower())
        self.assertEqual([row["state"] for row in self.unfinished()], ["begun"], f"the killed task's shard, nothing else\n{self.said()}")
        subprocess.run(["bash", "-c", facts_of(self.status())["start"]], cwd=self.folder, check=True, capture_output=True)
        self.wait_for(lambda: not self.ask("squeue", "-h").strip())
        self.assertEqual(self.unfinished(), [])
        self.merged_equals_a_single_run()

    def test_the_signal_before_a_time_limit_queues_the_shard_again(self):
        self.taut(*self.submit("--on", "slurm", "--shards", 1), program=PROGRAM)
        self.wait_for(lambda: self.sessions() and self.tasks())
        self.ask("scancel", "--batch", "--signal=USR1", "1_1")  # as --signal=B:USR1@60 does
        self.wait_for(lambda: len(self.sessions()) == 2)
        self.let_go()
        self.wait_for(lambda: not self.ask("squeue", "-h").strip())
        self.assertEqual(len(self.sessions()), 2, "it was queued again and went on: " + self.said())
        self.merged_equals_a_single_run()


class Parallel(Schedulers):
    def setUp(self):
        super().setUp()
        version = subprocess.run(["parallel", "--version"], capture_output=True, text=True) if shutil.which("parallel") else None
        if not version or "GNU" not in version.stdout:
            self.skipTest("not installed: GNU parallel")

    def goes_on(self, job):
        if job.poll() is not None:
            self.fail(f"ended with {job.returncode} before a task died\n{''.join(job.communicate())}\n{self.said()}")
        return True

    def end(self, job):
        job.kill()
        for pid in self.tasks():
            os.kill(pid, signal.SIGKILL)
        signal.alarm(10)
        with contextlib.suppress(TimeoutError):
            job.communicate()

    def test_a_task_dies_and_the_rest_is_resumed(self):
        ssh = self.folder / "ssh"  # fake ssh without a daemon: runs the command on this machine
        ssh.write_text('#!/bin/bash\nwhile [[ $1 == -* ]]; do shift; done\nhost=$1; shift; [[ $1 != -- ]] || shift\necho "$host" >>' +
                       f'{self.folder}/hosts.log\nexport SHELL=/bin/bash  # as a login does; GNU parallel starts nothing without it, and exits 0\n'
                       'exec bash -c "$*"\n')
        ssh.chmod(0o755)
        environment = {**os.environ, "PARALLEL_SSH": str(ssh), "JOBS": "1"}
        job = self.start(*self.submit("--on", "parallel", "--shards", 8, "--sshlogin", "1/near,1/far"), program=PROGRAM, env=environment)
        self.addCleanup(self.end, job)
        victim = self.wait_for(lambda: self.goes_on(job) and len(self.sessions()) >= 2 and self.tasks())[0]
        os.kill(victim, signal.SIGKILL)
        self.let_go()
        out, err = job.communicate()
        self.assertNotEqual(job.returncode, 0, "a shard that died is a failed job")
        self.assertEqual(set((self.folder / "hosts.log").read_text().split()), {"near", "far"})
        self.assertEqual(len(self.unfinished()), 1, f"{out}\n{err}")
        before = len(self.sessions())
        subprocess.run(["./job.sh"], cwd=self.folder / "c", env=environment, check=True, capture_output=True)
        self.assertEqual(self.unfinished(), [])
        self.assertEqual(len(self.sessions()), before + 1, "only the shard that died was run again")
        self.merged_equals_a_single_run()


if __name__ == "__main__":
    result = unittest.main(argv=[sys.argv[0], *sys.argv[2:]], exit=False, verbosity=2).result
    for test, why in result.skipped:
        print(f"skipped: {test}: {why}")
    sys.exit(1 if not result.wasSuccessful() else 77 if len(result.skipped) == result.testsRun else 0)
