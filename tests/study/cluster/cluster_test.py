#!/usr/bin/env python3
"""A study in a cluster folder: what submit writes, shards that die, and merges that prove that nothing is missing."""

import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "cli"))
import stored  # noqa: E402
from command_line import BINARIES, CommandLine, main  # noqa: E402

QUICK = {**os.environ, "TAUT_CLUSTER_PATIENCE": "3"}
AWAKE = {**QUICK, "TAUT_TEST_AWAKE": "1"}  # where no solver has to be slow


class Cluster(CommandLine):
    MANY = "axes.iterations = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]\n"

    def submit(self, *options, study=None, folder="c", program="taut", on="parallel", **more):
        study = study or self.study(rest=self.MANY)
        return self.taut("cluster", "submit", study, "--on", on, "--folder", folder, "--dry-run", *options,
                         program=program, **more)

    def shard(self, number, *options, folder="c", expect=0, program="taut"):
        return self.taut("cluster", "run", folder, "--shard", number, *options, expect=expect, program=program, env=AWAKE)

    def status(self, folder="c", expect=0, **more):
        return json.loads(self.taut("cluster", "status", folder, "--json", expect=expect, env=QUICK, **more).out)

    def merge(self, *words, expect=0):
        process = self.taut("cluster", "merge", *words, "--json", expect=expect)
        return json.loads(process.out)

    def manifest(self, folder="c"):
        head, *cases = map(json.loads, (self.folder / folder / "manifest.jsonl").read_text().splitlines())
        return head, cases

    def whole(self, program="taut"):
        return self.store_digest(self.taut("run", "./study.toml", "--out", "whole", program=program, env=AWAKE)).split()[1]


class Submit(Cluster):
    def test_a_folder_is_whole_in_itself(self):
        (self.folder / "disc.toml").write_text('summary = "A"\n[cloth]\nmesh = "m/disc.obj"\narea_density = 0.1\n'
                                               '[time]\ndt = "1/64"\nduration = 0.1\n')
        (self.folder / "m").mkdir()
        (self.folder / "m/disc.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        study = self.study(scenes=["./small.toml", "./disc.toml", "hang"], rest='set = ["time.duration=0.1"]\n')
        self.submit("--shards", 2, study=study, on="slurm")
        digest = self.whole()
        elsewhere = self.folder / "elsewhere"
        elsewhere.mkdir()
        shutil.move(self.folder / "c", elsewhere / "c")
        for file in ("small.toml", "disc.toml", "m"):
            (self.folder / file).rename(self.folder / ("gone-" + file))
        for number in (1, 2):
            self.shard(number, folder="elsewhere/c")
        self.assertEqual(self.merge("elsewhere/c", "--out", "merged")["store"], digest)
        for file in (elsewhere / "c").glob("*"):
            if file.is_file():
                self.assertNotIn(str(self.folder), file.read_text(), file)
                self.assertNotIn(str(BINARIES), file.read_text(), file)
        self.assertEqual(len((elsewhere / "c/README").read_text().splitlines()), 5)

    def test_shards_hold_equal_work_not_equal_numbers(self):
        study = self.study(rest='set = ["cloth.grid=[40, 40]", "time.duration=20"]\naxes.iterations = [64, 1, 2, 3, 4, 5, 6, 7]\n')
        self.submit("--shards", 2, study=study)
        _, cases = self.manifest()
        large = next(case for case in cases if "iterations=64" in case["id"])
        self.assertEqual([case for case in cases if case["shard"] == large["shard"]], [large])
        self.assertEqual([case["key"] for case in cases], list(dict.fromkeys(case["key"] for case in cases)))

    def test_hours_decide_the_number_of_shards(self):
        study = self.study(rest='set = ["cloth.grid=[100, 100]", "time.duration=40"]\naxes.iterations = [40, 41, 42, 43]\n')
        one = json.loads(self.submit("--hours", 20, "--json", study=study).out)
        more = json.loads(self.submit("--hours", 0.4, "--json", study=study, folder="d").out)
        self.assertEqual(one["shards"], 1)
        self.assertGreater(more["shards"], 1)
        self.assertLessEqual(more["minutes"], 0.4 * 60)
        self.assertIn("a single case may take 10 minutes", self.submit("--hours", 0.1, folder="e", expect=2).err)
        self.assertFalse((self.folder / "e").exists())

    def test_the_scheduler_is_called_in_the_folder(self):
        """With programs of their names that note what they are told; Slurm and GNU parallel themselves: schedulers_test.py."""
        (self.folder / "bin").mkdir()
        for name in ("sbatch", "parallel"):
            (self.folder / "bin" / name).write_text(f'#!/bin/bash\necho "$PWD $TAUT $*" >{self.folder}/told\nexit $ANSWER\n')
            (self.folder / "bin" / name).chmod(0o755)
        (self.folder / "hosts").write_text("2/near\nfar\n")
        options = "--jobs 100% --termseq TERM,20000,KILL,25"
        resumed = f"--joblog joblog --resume --resume-failed {BINARIES}/taut cluster run . --shard {{}} -j 1 ::: 1 2\n"
        for on, words, told in [
                ("slurm", [], "job.sh\n"), ("parallel", [], f"{options} {resumed}"),
                ("parallel", ["--node-file", "hosts", "--sshlogin", "a,4/b"],
                 f"{options} --sshloginfile ./nodes --workdir {self.folder}/c {resumed}")]:
            words = ["cluster", "submit", self.study(rest=self.MANY), "--on", on, "--shards", 2, "--folder", "c", *words]
            environment = {**os.environ, "PATH": f"{self.folder}/bin:{os.environ['PATH']}", "ANSWER": "0"}
            environment.pop("TAUT", None)
            self.taut(*words, "--dry-run", env=environment)
            self.assertFalse((self.folder / "told").exists())
            shutil.rmtree(self.folder / "c")
            self.taut(*words, env=environment)
            self.assertEqual((self.folder / "told").read_text(), f"{self.folder}/c {BINARIES}/taut {told}")
            if "hosts" in words:
                self.assertEqual((self.folder / "c/nodes").read_text(), "2/near\nfar\na\n4/b\n")
            for program, here in [("refused or failed", {"ANSWER": "1"}), ("is not installed here", {"PATH": str(self.folder)})]:
                shutil.rmtree(self.folder / "c")
                self.assertIn(program, self.taut(*words, env={**environment, **here}, expect=2).err)
                self.assertTrue((self.folder / "c/manifest.jsonl").exists(), "the folder is whole: it can be started elsewhere")
            shutil.rmtree(self.folder / "c")
            (self.folder / "told").unlink()

    def test_bad_input_writes_nothing(self):
        study = self.study(rest=self.MANY)
        for options, said in [(["--shards", 13], "the study has only 12 cases"), (["--shards", 0], "--shards"),
                              (["--shards", 1001], "--shards"), (["--shards", 2, "--hours", 1], "--shards"),
                              (["--preset", "none"], "no preset 'none'"), (["--on", "pbs"], "unknown scheduler 'pbs'"),
                              (["--on", "slurm", "--sshlogin", "a"], "Slurm knows its nodes")]:
            on = [] if "--on" in options else ["--on", "parallel"]
            process = self.taut("cluster", "submit", study, *on, "--folder", "c", "--dry-run", *options, expect=None)
            self.assertNotEqual(process.returncode, 0)
            self.assertIn(said, process.err)
            self.assertFalse((self.folder / "c").exists(), options)
        self.submit("--shards", 2, study=study)
        self.assertIn("already there", self.submit(study=study, expect=2).err)
        (self.folder / "up.toml").write_text('summary = "A"\n[cloth]\nmesh = "../x.obj"\narea_density = 0.1\n[time]\ndt = "1/64"\nduration = 1\n')
        (self.folder.parent / "x.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        self.addCleanup((self.folder.parent / "x.obj").unlink)
        self.assertIn("up.toml:3:", self.submit(study=self.study("up-study.toml", ["./up.toml"]), folder="u", expect=2).err)
        self.assertFalse((self.folder / "u").exists())


class Shards(Cluster):
    def test_status_follows_and_the_merge_equals_a_single_run(self):
        self.submit("--shards", 3)
        status = self.status(expect=3)
        self.assertEqual([one["state"] for one in status["shards"]], ["waiting"] * 3)
        self.assertEqual(status["command"], "cd c && ./job.sh 1 2 3")
        for number in (1, 2):
            self.shard(number)
        status = self.status(expect=3)
        self.assertEqual([one["state"] for one in status["shards"]], ["done", "done", "waiting"])
        lacking = [case["id"] for case in self.manifest()[1] if case["shard"] == 3]
        merged = self.merge("c", "--out", "m", expect=3)
        self.assertEqual((merged["merged"], merged["missing"]), (False, [f"{one} (shard 3)" for one in sorted(lacking, key=self.key_of())]))
        self.assertFalse((self.folder / "m").exists())
        self.shard(3)
        self.assertEqual(self.status()["command"], "")
        merged = self.merge("c", "--out", "m")
        self.assertEqual((merged["merged"], merged["store"]), (True, self.whole()))
        again = self.merge("c", "--out", "m")
        self.assertEqual(again["store"], merged["store"])
        self.assertEqual(len(self.keys("m")), 12, "none twice")
        table = self.taut("run", "./study.toml", "--out", "m", "--table", "stretch.rms")
        self.assertIn("(12 were stored already)", table.err)

    def key_of(self):
        keys = {case["id"]: case["key"] for case in self.manifest()[1]}
        return lambda one: keys[one]

    def test_a_merge_that_allows_missing_marks_the_report(self):
        self.submit("--shards", 2)
        self.shard(1)
        merged = self.merge("c", "--out", "m", "--allow-missing", expect=3)
        self.assertTrue(merged["merged"])
        model = json.loads(self.taut("report", "./study.toml", "--out", "m", "--json").out)
        self.assertIn(f"merged although {len(merged['missing'])} planned cases were missing", json.dumps(model["left_out"]))
        self.shard(2)
        self.merge("c", "--out", "m")
        model = json.loads(self.taut("report", "./study.toml", "--out", "m", "--json").out)
        self.assertNotIn("left_out", model)

    def test_a_shard_that_does_not_exist(self):
        self.submit("--shards", 3)
        for number in (0, 4, -1):
            self.assertIn("has shards 1 to 3", self.shard(number, expect=2).err)
        self.assertFalse((self.folder / "c/shards").exists())

    def change_manifest(self, change, digest=True):
        head, cases = self.manifest()
        change(head, cases)
        lines = "".join(json.dumps(case, separators=(",", ":")) + "\n" for case in cases)
        if digest:
            import hashlib
            head["digest"] = hashlib.sha256(lines.encode()).hexdigest()
        (self.folder / "c/manifest.jsonl").write_text(json.dumps(head) + "\n" + lines)

    def test_a_manifest_of_another_build_or_a_damaged_one(self):
        self.submit("--shards", 2)
        good = (self.folder / "c/manifest.jsonl").read_text()
        self.change_manifest(lambda head, cases: head.update(build="0" * 64))
        self.assertIn("planned by build 0000000000, this is ", self.shard(1, expect=2).err)
        self.change_manifest(lambda head, cases: cases.pop(), digest=False)
        self.assertIn("do not match its digest", self.taut("cluster", "status", "c", expect=2).err)
        (self.folder / "c/manifest.jsonl").write_text(good)
        self.change_manifest(lambda head, cases: cases[4].update(shard=3))
        self.assertIn("manifest.jsonl:6:", self.shard(1, expect=2).err)
        (self.folder / "c/manifest.jsonl").write_text(good)
        scene = self.folder / "c/scenes/1/small.toml"
        scene.write_text(scene.read_text().replace("mass = 0.1", "mass = 0.2"))
        self.assertIn("is not the scene that was planned", self.shard(1, expect=2).err)
        self.assertFalse((self.folder / "c/shards").exists())

    def test_foreign_records_are_named_and_nothing_is_merged(self):
        self.submit("--shards", 2)
        for number in (1, 2):
            self.shard(number)
        other = self.study("other.toml", rest="axes.iterations = [20, 21]\n")
        self.submit("--shards", 1, study=other, folder="d")
        self.shard(1, folder="d")
        mine = (self.folder / "c/shards/0001/results.db").read_bytes()
        shutil.copy(self.folder / "d/shards/0001/results.db", self.folder / "c/shards/0001/results.db")
        merged = self.merge("c", "--out", "m", expect=2)
        self.assertEqual(len(merged["foreign"]), 2)
        self.assertIn("iterations=20", merged["foreign"][0] + merged["foreign"][1])
        self.assertIn("not planned (another study or build)", merged["foreign"][0])
        (self.folder / "c/shards/0001/results.db").write_bytes(mine)
        merged = self.merge("c", "d", "--out", "m", expect=2)
        self.assertEqual(len(merged["foreign"]), 14, "each planned by one folder alone")
        self.assertFalse((self.folder / "m").exists())

    def test_conflicting_records_are_named_and_nothing_is_merged(self):
        study = self.study(solvers=["faulty:mode=random,at=3"], rest="axes.variant = [1, 2, 3]\n")
        for folder in ("c", "d"):
            self.submit("--shards", 1, study=study, folder=folder, program="taut-faulty")
            self.shard(1, folder=folder, program="taut-faulty")
        merged = self.merge("c", "d", "--out", "m", expect=6)
        self.assertEqual(len(merged["conflicts"]), 3)
        self.assertIn("c/shards/0001 and d/shards/0001 have different results", merged["conflicts"][0])
        self.assertFalse((self.folder / "m").exists())
        # The same within one shard: what a start found that another one had found otherwise.
        for key in self.keys("c/shards/0001"):
            stored.change(self.folder / "c/shards/0001", "INSERT INTO conflicts VALUES (?, 'another', '', '')", key)
        merged = self.merge("c", "--out", "m", expect=6)
        self.assertEqual(len(merged["conflicts"]), 3)
        self.assertIn("two results in c/shards/0001", merged["conflicts"][0])

    def test_failures_are_named_and_run_again(self):
        study = self.study(solvers=["faulty:mode=crash", "faulty:mode=stable"])
        self.submit("--shards", 1, study=study, program="taut-faulty")
        self.shard(1, program="taut-faulty")
        status = self.status(program="taut-faulty")
        self.assertEqual([one["id"].split()[-1] for one in status["failed"]], ["faulty:mode=crash"])
        self.assertIn("crash (SIGSEGV", status["failed"][0]["status"])
        text = self.taut("cluster", "status", "c", program="taut-faulty").out
        self.assertIn("failures again: taut cluster run c --shard 1 --only failed", text)
        again = self.shard(1, "--only", "failed", program="taut-faulty")
        self.assertIn("1/1 cases", again.err)


class Bench(Cluster):
    def cores_of_a_worker(self, solver, **environment):
        worker = self.start("bench", "--worker", "./small.toml", solver, stdin=subprocess.PIPE, env={**os.environ, **environment})
        self.addCleanup(worker.communicate)
        self.assertEqual(worker.stdout.readline(), "ready\n")
        return os.sched_getaffinity(worker.pid)

    def test_in_a_slurm_job_a_sample_stays_on_a_core_for_each_thread(self):
        mine = os.sched_getaffinity(0)
        if len(mine) < 2:
            self.skipTest("one core")
        self.assertEqual(self.cores_of_a_worker("jakobsen"), mine)
        for solver, cores in [("jakobsen", 1), ("bullet", 1), ("jakobsen:threads=2", 2)]:
            pinned = self.cores_of_a_worker(solver, SLURM_JOB_ID="1")
            self.assertEqual((len(pinned), pinned <= mine), (cores, True), solver)

    def test_a_job_of_several_nodes_or_a_part_of_one_does_not_time(self):
        for name, value, said in [("SLURM_JOB_NUM_NODES", "2", "sbatch --nodes=1"), ("SLURM_CPUS_ON_NODE", "1", "sbatch --exclusive")]:
            if name == "SLURM_CPUS_ON_NODE" and os.cpu_count() == 1:
                continue
            refused = self.taut("bench", self.study(), env={**os.environ, "SLURM_JOB_ID": "1", name: value}, expect=2)
            self.assertIn(said, refused.err)
            self.assertFalse((self.folder / "results").exists())


class Starts(Cluster):
    """Two starts of one shard, starts that die, disks that are full."""

    def slow(self, cases=8, on="parallel"):
        study = self.study(solvers=["faulty:mode=slow"], rest='set = ["time.duration=2.5"]\n'
                           f"axes.variant = {list(range(cases))}\n")
        self.submit("--shards", 1, study=study, program="taut-faulty", on=on)

    def begin(self, **more):
        process = self.start("cluster", "run", "c", "--shard", 1, program="taut-faulty", env=QUICK, **more)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def packed(self):
        return sum(len(stored.keys(shard)) for shard in (self.folder / "c/shards").glob("*"))

    def wait_for(self, what):
        for _ in range(300):
            if what():
                return
            time.sleep(0.05)
        self.fail("waited in vain")

    def single(self):
        return self.whole(program="taut-faulty")

    def test_two_at_once(self):
        self.slow()
        first = self.begin()
        self.wait_for(self.packed)
        second = self.shard(1, program="taut-faulty", expect=2)
        self.assertIn("is being run on", second.err)
        status = self.status(expect=3, program="taut-faulty")
        self.assertEqual(status["shards"][0]["state"], "running")
        self.assertGreater(status["seconds"], 0, "it runs, so the end can be foreseen")
        self.assertLess(status["seconds"], 120, "of some seven")
        first.communicate(timeout=60)
        self.assertEqual(first.returncode, 0)
        self.assertEqual(self.merge("c", "--out", "m")["store"], self.single())

    def test_two_that_start_together(self):
        self.slow()
        both = [self.begin(), self.begin()]
        for process in both:
            process.communicate(timeout=60)
        self.assertEqual(sorted(process.returncode for process in both), [0, 2])
        self.assertEqual(self.merge("c", "--out", "m")["store"], self.single())

    def test_killed_and_started_again(self):
        self.slow()
        first = self.begin()
        self.wait_for(self.packed)
        first.send_signal(signal.SIGKILL)
        first.communicate()
        status = self.status(expect=3, program="taut-faulty")
        self.assertEqual((status["shards"][0]["state"], status["start"]), ("lost", [1]))
        again = self.shard(1, program="taut-faulty")
        self.assertNotIn("(0 were stored already)", again.err)
        self.assertIn("were stored already", again.err)
        self.assertEqual(self.merge("c", "--out", "m")["store"], self.single())

    def test_terminated_and_started_again(self):
        self.slow(cases=6)
        first = self.begin()
        self.wait_for(self.packed)
        first.send_signal(signal.SIGTERM)
        first.communicate(timeout=20)
        self.assertEqual(first.returncode, 130)
        self.assertEqual(self.status(expect=3, program="taut-faulty")["shards"][0]["state"], "stopped")
        begun = time.monotonic()
        self.shard(1, program="taut-faulty")
        self.assertEqual(self.merge("c", "--out", "m")["store"], self.single())
        self.assertLess(time.monotonic() - begun, 30)

    def vanished(self, words, place, inner="", **more):
        """A case loses its folder and is killed, as by an out-of-memory killer: what the run says then."""
        process = self.start(*words, program="taut-faulty", **more)
        self.addCleanup(process.kill)
        self.wait_for(lambda: list(place.glob(inner + "*/heartbeat")))
        folder = next(place.glob(inner + "*/heartbeat")).resolve().parent
        shutil.rmtree(folder)
        for entry in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
            try:
                if str(folder).encode() in entry.read_bytes().split(b"\0"):
                    os.kill(int(entry.parent.name), signal.SIGKILL)
            except OSError:  # another process, which has ended
                pass
        _, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 2, err)
        return err

    def test_a_case_whose_folder_vanishes_is_no_result(self):
        self.slow(cases=2)
        scratch = self.folder / "scratch"
        scratch.mkdir()
        for words in (["cluster", "run", "c", "--shard", 1], ["run", "./study.toml", "--out", "whole", "-j", 1]):
            said = self.vanished(words, scratch, env={**QUICK, "TMPDIR": str(scratch)}, inner="*/")
            self.assertIn("vanished while its case was running", said)
        status = self.status(expect=3, program="taut-faulty")
        self.assertEqual((status["done"], status["failed"]), (0, []), "what nobody saw end is stored as nothing")
        self.assertEqual(self.keys("whole"), [])
        self.shard(1, program="taut-faulty")
        self.assertEqual(self.merge("c", "--out", "m")["store"], self.single())

    def job(self):
        """The job script of shard 1 as a task of Slurm's, with a scontrol that only notes what it is told."""
        (self.folder / "bin").mkdir()
        (self.folder / "bin/scontrol").write_text(f'#!/bin/bash\necho "$*" >{self.folder}/told\n')
        (self.folder / "bin/scontrol").chmod(0o755)
        job = subprocess.Popen(["bash", "job.sh"], cwd=self.folder / "c", stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                               env={**QUICK, "PATH": f"{self.folder}/bin:{os.environ['PATH']}", "SLURM_ARRAY_JOB_ID": "7",
                                    "SLURM_ARRAY_TASK_ID": "1", "TAUT": str(BINARIES / "taut-faulty")})
        self.addCleanup(job.communicate)
        self.addCleanup(job.kill)
        self.wait_for(self.packed)
        return job

    def test_a_task_that_is_preempted_stops_and_one_out_of_time_queues_itself_again(self):
        for signal_sent, code, told in [(signal.SIGTERM, 130, None), (signal.SIGUSR1, 0, "requeue 7_1\n")]:
            with self.subTest(signal_sent.name):
                self.slow(cases=4, on="slurm")
                job = self.job()
                job.send_signal(signal_sent)
                self.assertEqual(job.wait(timeout=20), code)
                self.assertEqual((self.folder / "told").read_text() if (self.folder / "told").exists() else None, told)
                status = self.status(expect=3, program="taut-faulty")
                self.assertEqual(status["shards"][0]["state"], "stopped", "its beats end: nobody waits for it")
                self.assertIn(status["done"], (1, 2, 3))
            for made in ("c", "bin"):
                shutil.rmtree(self.folder / made)

    def test_clocks_that_differ_by_hours(self):
        self.slow()
        first = self.begin()
        self.wait_for(self.packed)
        hours = time.time() - 7 * 3600
        for beats in (self.folder / "c/shards/0001/beats").iterdir():
            os.utime(beats, (hours, hours))
        self.assertEqual(self.status(expect=3, program="taut-faulty")["shards"][0]["state"], "running")
        self.assertIn("is being run on", self.shard(1, program="taut-faulty", expect=2).err)
        first.send_signal(signal.SIGKILL)
        first.communicate()
        future = time.time() + 7 * 3600
        for beats in (self.folder / "c/shards/0001/beats").iterdir():
            os.utime(beats, (future, future))
        self.assertEqual(self.status(expect=3, program="taut-faulty")["shards"][0]["state"], "lost")

    def mounted(self, script):
        """Runs a shell script with a small file system of its own at ./disk; skips where none can be mounted."""
        mount = "mkdir -p disk && mount -t tmpfs -o size=300k tmpfs disk && "
        for tool in ("unshare", "mount"):
            if not shutil.which(tool):
                self.skipTest(f"{tool} is missing")
        process = subprocess.run(["unshare", "--mount", "--map-root-user", "bash", "-c", mount + script], cwd=self.folder,
                                 text=True, capture_output=True, env=QUICK | {"TAUT": str(BINARIES / "taut")})
        if "unshare:" in process.stderr or "mount:" in process.stderr:
            self.skipTest("no file system can be mounted here: " + process.stderr.strip())
        return process

    def test_a_full_and_a_read_only_file_system(self):
        self.submit("--shards", 1)
        full = self.mounted('cp -r c disk && dd if=/dev/zero of=disk/fill bs=1k count=180 2>/dev/null; '
                            'dd if=/dev/zero of=disk/more bs=1k count=60 2>/dev/null; "$TAUT" cluster run disk/c --shard 1; echo code $?; '
                            'rm disk/fill disk/more; "$TAUT" cluster run disk/c --shard 1 2>/dev/null; "$TAUT" cluster merge disk/c --out m')
        self.assertIn("No space left on device", full.stderr)
        self.assertIn("code 2", full.stdout)
        self.assertIn("12/12 cases", full.stdout)
        self.assertIn("store " + self.whole(), full.stdout)
        locked = self.mounted('cp -r c disk && mount -o remount,ro disk && "$TAUT" cluster run disk/c --shard 1; echo code $?')
        self.assertIn("Read-only file system", locked.stderr)
        self.assertIn("code 2", locked.stdout)


main()
