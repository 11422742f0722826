#!/usr/bin/env python3
"""A study in a cluster folder: the files of submit, shards that die, and merges that prove completeness."""

import json
import os
import pathlib
import re
import shutil
import signal
import struct
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "cli"))
import stored  # noqa: E402
from command_line import BINARIES, CommandLine, facts_of, main, rows_of  # noqa: E402



class Cluster(CommandLine):
    MANY = "axes.iterations = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]\n"

    def submit(self, *options, study=None, folder="c", program="taut", on="parallel", **more):
        study = study or self.study(rest=self.MANY)
        return self.taut("cluster", "submit", study, "--on", on, "--folder", folder, "--dry-run", *options,
                         program=program, **more)

    def shard(self, number, *options, folder="c", expect=0, program="taut"):
        """Runs a shard directly, as the job script would."""
        text = (self.folder / folder / "job.sh").read_text()
        words = re.search(r'run=\("\$taut" (run .*) \$\{ONLY', text)[1].split()
        shards = re.search(r'\$?\{?shard\}?\S*/(\d+)"|\{\}/(\d+)', text)
        count = shards[1] or shards[2]
        here = self.folder / folder
        done = subprocess.run([BINARIES / program, *words, "--shard", f"{number}/{count}", "--out", f"shards/{number:04}", *options], cwd=here,
                              text=True, capture_output=True)
        self.assertEqual(done.returncode, expect, done.stderr)
        return done

    def status(self, folder="c", expect=0, **more):
        return json.loads(self.taut("cluster", "status", folder, "--json", expect=expect, **more).out)

    def states(self, **more):
        rows = rows_of(self.status(**more), "shards")
        return [row["state"] for row in sorted(rows, key=lambda row: row["shard"])]

    def merge(self, *words, expect=0):
        answer = json.loads(self.taut("cluster", "merge", *words, "--json", expect=expect).out)
        return facts_of(answer) | {name: [row["case"] for row in rows_of(answer, name)] for name in ("missing", "foreign", "conflicts")}

    def planned(self, shard, folder="c"):
        return [row["id"] for row in stored.query(self.folder / folder, "SELECT id FROM planned WHERE shard = ? ORDER BY key", shard)]

    def whole(self, program="taut"):
        return self.store_digest(self.taut("run", "./study.toml", "--out", "whole", program=program)).split()[1]


class Submit(Cluster):
    def test_a_folder_is_whole_in_itself(self):
        (self.folder / "disc.toml").write_text('summary = "A"\n[cloth]\nmesh = "m/disc.obj"\narea_density = 0.1\n'
                                               '[[collider]]\ntype = "mesh"\nfile = "m/body.obj"\nframes = "m/body.npy"\nfps = 30\n'
                                               '[time]\ndt = "1/64"\nduration = 0.1\n')
        (self.folder / "m").mkdir()
        (self.folder / "m/disc.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        (self.folder / "m/body.obj").write_text("v 0 0 9\nv 1 0 9\nv 0 1 9\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
        header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (2, 4, 3), }".ljust(117) + b"\n"
        places = 2 * (0, 0, 9, 1, 0, 9, 0, 1, 9, 0, 0, 10)
        (self.folder / "m/body.npy").write_bytes(b"\x93NUMPY\x01\x00" + struct.pack(f"<H{len(header)}s24d", len(header), header, *places))
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
            if file.is_file() and file.name != "results.db":
                self.assertNotIn(str(self.folder), file.read_text(), file)
                self.assertNotIn(str(BINARIES), file.read_text(), file)
        self.assertEqual(len((elsewhere / "c/README").read_text().splitlines()), 5)

    def test_hours_decide_the_number_of_shards(self):
        study = self.study(rest='set = ["cloth.grid=[100, 100]", "time.duration=40"]\naxes.iterations = { from = 30, to = 61, steps = 32 }\n')
        one = facts_of(json.loads(self.submit("--hours", 100, "--json", study=study).out))
        more = facts_of(json.loads(self.submit("--hours", 2, "--json", study=study, folder="d").out))
        self.assertEqual(one["shards"], 1)
        self.assertGreater(more["shards"], 1)
        self.assertLessEqual(more["minutes"], 120)
        self.assertIn("a single case may take 10 minutes", self.submit("--hours", 0.1, folder="e", expect=2).err)
        self.assertFalse((self.folder / "e").exists())

    def test_the_scheduler_is_called_in_the_folder(self):
        """Tests with fake schedulers that log their arguments; schedulers_test.py uses the real Slurm and GNU parallel."""
        (self.folder / "bin").mkdir()
        for name in ("sbatch", "parallel"):
            (self.folder / "bin" / name).write_text(f'#!/bin/bash\necho "$PWD $TAUT $*" >{self.folder}/told\nexit $ANSWER\n')
            (self.folder / "bin" / name).chmod(0o755)
        (self.folder / "hosts").write_text("2/near\nfar\n")
        options = "--env TAUT --env ONLY --jobs 100% --termseq TERM,20000,KILL,25"
        run = "bash ./job.sh --shard {} ::: 0001 0002\n"
        resumed = f"--joblog joblog --resume --resume-failed {run}"
        for on, words, told in [
                ("slurm", [], "job.sh\n"), ("parallel", [], f"{options} {resumed}"),
                ("parallel", ["--node-file", "hosts", "--sshlogin", "a,4/b"],
                 f"{options} --sshloginfile ./nodes --workdir {self.folder}/c {resumed}")]:  # for the whole study
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
                self.assertTrue((self.folder / "c/results.db").exists(), "the folder is whole: it can be started elsewhere")
            shutil.rmtree(self.folder / "c")
            (self.folder / "told").unlink()

    def test_a_name_is_no_mark_no_pattern_and_no_command(self):
        """Neither the arguments of GNU parallel that a shell reads nor Slurm's directives contain any text of a study."""
        parallel = shutil.which("parallel")
        names = ["a@RUN@b", "@SHARDS@", "a b", "{}", "{#} {= s:a:b: =}", "$(touch canary)", "`touch canary`;touch canary", "it's \"odd\" \\",
                 "#SBATCH x", "\u00e4 {}", "a\nb", "a\tb\x1b"]
        for name in names:
            self.study(rest=self.MANY)
            (self.folder / "study.toml").rename(self.folder / f"{name}.toml")
            for on in ("slurm", "parallel"):
                self.submit("--shards", 2, study=f"./{name}.toml", on=on)
                text = (self.folder / "c/job.sh").read_text()
                self.assertEqual(subprocess.run(["bash", "-n", "c/job.sh"], cwd=self.folder).returncode, 0, text)
                if on == "slurm":
                    self.assertRegex(text, r"\A#!/bin/bash\n#SBATCH --job-name=taut-[\w.-]+\n#SBATCH --array=1-2\n")
                start = "sbatch" if on == "slurm" else "./job.sh"
                self.assertIn(start, facts_of(self.status(expect=3))["start"])
                if on == "slurm":
                    shutil.rmtree(self.folder / "c")
            if parallel:
                done = subprocess.run(["./job.sh"], cwd=self.folder / "c", env={**os.environ, "TAUT": str(BINARIES / "taut")}, text=True, capture_output=True)
                self.assertEqual(done.returncode, 0, name + done.stderr)
                self.status()
            shutil.rmtree(self.folder / "c")
            self.assertEqual(list(self.folder.rglob("canary")), [], name)
        if not parallel:
            self.skipTest("not installed: GNU parallel; its scripts were written and not run")

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
        self.assertIn("already exists", self.submit(study=study, expect=2).err)
        (self.folder / "up.toml").write_text('summary = "A"\n[cloth]\nmesh = "../x.obj"\narea_density = 0.1\n[time]\ndt = "1/64"\nduration = 1\n')
        (self.folder.parent / "x.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        self.addCleanup((self.folder.parent / "x.obj").unlink)
        self.assertIn("up.toml:3:", self.submit(study=self.study("up-study.toml", ["./up.toml"]), folder="u", expect=2).err)
        self.assertIn("lies in this folder or below", self.submit(study=self.study("far.toml", [str(self.folder / "small.toml")]), folder="u", expect=2).err)
        self.assertFalse((self.folder / "u").exists())


class Shards(Cluster):
    def test_status_follows_and_the_merge_equals_a_single_run(self):
        self.submit("--shards", 3)
        self.assertEqual(self.states(expect=3), ["waiting"] * 3)
        self.assertEqual(facts_of(self.status(expect=3))["start"], "cd c && ./job.sh 1 2 3")
        for number in (1, 2):
            self.shard(number)
        self.assertEqual(self.states(expect=3), ["done", "done", "waiting"])
        merged = self.merge("c", "--out", "m", expect=3)
        self.assertEqual((merged["merged"], merged["missing"]), (False, [f"{one} (shard 3)" for one in self.planned(3)]))
        self.assertFalse((self.folder / "m").exists())
        self.shard(3)
        self.assertNotIn("start", facts_of(self.status()))
        merged = self.merge("c", "--out", "m")
        self.assertEqual((merged["merged"], merged["store"]), (True, self.whole()))
        again = self.merge("c", "--out", "m")
        self.assertEqual(again["store"], merged["store"])
        self.assertEqual(len(self.keys("m")), 12, "none twice")
        table = self.taut("run", "./study.toml", "--out", "m", "--table", "stretch.rms")
        self.assertIn("(12 were stored already)", table.err)

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

    def test_another_build_is_refused_by_the_job_script(self):
        self.submit("--shards", 2)
        other = self.folder / "other"
        other.write_text("#!/bin/bash\necho program 0000000000\n")
        other.chmod(0o755)
        job = subprocess.run(["bash", "job.sh", "1"], cwd=self.folder / "c", env={**os.environ, "TAUT": str(other)}, text=True, capture_output=True)
        self.assertEqual(job.returncode, 2)
        self.assertIn("is not the build that planned this", job.stdout)

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
        # The same within one shard: one start found other values than an earlier start.
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
        failed, = rows_of(status, "failed")
        self.assertIn("faulty:mode=crash", failed["case"])
        self.assertIn("crash (SIGSEGV", failed["status"])
        self.assertEqual(facts_of(status)["again"], "export ONLY=failed; cd c && ./job.sh 1")
        self.assertIn("1/1 cases", self.shard(1, "--only", "failed", program="taut-faulty").stderr)


class Bench(Cluster):
    def cores_of_a_worker(self, solver, **environment):
        worker = self.start("bench", "--worker", "./small.toml", solver, stdin=subprocess.PIPE, env={**os.environ, **environment})
        self.addCleanup(worker.communicate)
        self.assertEqual(worker.stdout.readline(), "ready 2\n")
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


class Tasks(Cluster):
    """Slurm tasks that are preempted, out of time or killed."""

    def packed(self):
        return sum(len(stored.keys(shard)) for shard in (self.folder / "c/shards").glob("*"))

    def job(self):
        """Runs the job script of shard 1 as a Slurm task, with a scontrol that only logs its arguments."""
        (self.folder / "bin").mkdir()
        (self.folder / "bin/scontrol").write_text(f'#!/bin/bash\necho "$*" >{self.folder}/told\n')
        (self.folder / "bin/scontrol").chmod(0o755)
        job = subprocess.Popen(["bash", "job.sh"], cwd=self.folder / "c", stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                               start_new_session=True,
                               env={**os.environ, "PATH": f"{self.folder}/bin:{os.environ['PATH']}", "SLURM_ARRAY_JOB_ID": "7",
                                    "SLURM_ARRAY_TASK_ID": "1", "TAUT": str(BINARIES / "taut-faulty")})
        self.addCleanup(job.communicate)
        self.addCleanup(job.kill)
        for _ in range(300):
            if self.packed():
                return job
            time.sleep(0.05)
        self.fail("waited in vain")

    def test_a_task_that_is_preempted_stops_one_out_of_time_queues_itself_again_and_all_go_on(self):
        study = self.study(solvers=["jakobsen", "bullet", "faulty:mode=held"])  # in this order: the larger estimate first
        (self.folder / "go-on").touch()
        whole = self.whole(program="taut-faulty")
        goes_on = self.folder / "c/go-on"
        for sent, code, told in [(signal.SIGTERM, 130, None), (signal.SIGUSR1, 0, "requeue 7_1\n"), (signal.SIGKILL, -9, None)]:
            with self.subTest(sent.name):
                self.submit("--shards", 1, study=study, program="taut-faulty", on="slurm")
                job = self.job()
                os.killpg(job.pid, sent) if sent == signal.SIGKILL else job.send_signal(sent)
                self.assertEqual(job.wait(timeout=20), code)
                self.assertEqual((self.folder / "told").read_text() if (self.folder / "told").exists() else None, told)
                self.assertEqual(self.states(expect=3, program="taut-faulty"), ["begun"])
                (self.folder / "c/shards/0001/results.db.writer").write_text("zeus 7\n")
                goes_on.touch()
                self.assertIn("were stored already", self.shard(1, program="taut-faulty").stderr)
                self.assertEqual(self.merge("c", "--out", "m")["store"], whole)
            for made in ("c", "bin", "m", "told"):
                shutil.rmtree(self.folder / made, ignore_errors=True)
            (self.folder / "told").unlink(missing_ok=True)


main()
