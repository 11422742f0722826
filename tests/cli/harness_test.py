#!/usr/bin/env python3
"""Faulty solvers cost one case each; results files survive kill -9, damage, shards and conflicts."""

import csv
import json
import os
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import time

import stored
from command_line import BINARIES, CommandLine, main

# They run in this order, since solvers with sweeps are estimated to take longer. The last two wait for a file go-on.
TWO_AND_HELD = ["jakobsen:precision=double", "bullet", "faulty:mode=held,variant=1", "faulty:mode=held,variant=2"]
KILLS = int(os.environ.get("TAUT_KILLS", 12))  # 200 in the target harness_kills
SANITIZED = "asan" in BINARIES.name  # its allocator ignores limits on address space


class FaultySolvers(CommandLine):
    def run_modes(self, *modes, seconds=1):
        study = self.study(solvers=["jakobsen:precision=double"] + [f"faulty:mode={mode}" for mode in modes])
        run = self.taut("run", study, "--timeout", seconds, "--memory", 300, "-j", 2, program="taut-faulty")
        self.assertIn(f"{len(modes) + 1}/{len(modes) + 1} cases", run.err)
        statuses = {r["params"].get("mode", "jakobsen"): r["status"] for r in self.records()}
        self.assertEqual(statuses["jakobsen"]["kind"], "ok")
        return statuses

    def test_each_costs_one_case(self):
        modes = ["crash", "abort", "nan", "hang", "spin", "throw", "exit", "refuse", "stable"]
        status = self.run_modes(*modes)
        self.assertEqual({mode: status[mode]["kind"] for mode in modes},
                         {"crash": "crash", "abort": "crash", "nan": "exploded", "hang": "timeout", "spin": "timeout", "throw": "error",
                          "exit": "error", "refuse": "unsupported", "stable": "ok"})
        self.assertIn("SIGSEGV", status["crash"]["reason"])
        self.assertIn("SIGABRT", status["abort"]["reason"])
        self.assertEqual(status["hang"]["reason"], "wall time")
        self.assertIn(status["spin"]["reason"], ("CPU time", "wall time"))  # the machine may be too busy for the first attempt
        self.assertEqual(status["throw"]["reason"], "faulty: threw as told")
        self.assertEqual(status["refuse"]["reason"], "refuses, as told")
        for mode in ["crash", "abort", "hang", "spin", "exit"]:
            self.assertEqual(status[mode]["step"], 4, f"{mode}: the last good step is that before the fifth")
        self.assertEqual((status["nan"]["step"], status["nan"]["vertex"]), (5, 2))

    def test_a_truth_that_its_solver_crashes_costs_that_truth(self):
        done = self.taut("verify", "any-rest", "metric-stretch", "--solver", "faulty:mode=crash", "--solver", "reference", program="taut-faulty", expect=1)
        self.assertRegex(done.out, r"broken +11\.8 +any-rest .*the check ends 0 \(1 \+- 0\): SIGSEGV")
        self.assertIn("1 broken in 1 truths", done.err)

    def test_eating_memory(self):
        if SANITIZED:
            self.skipTest("the sanitizer's allocator knows no limit on address space")
        status = self.run_modes("memory", seconds=20)["memory"]
        self.assertEqual((status["kind"], status["reason"]), ("oom", "more than the limit of 300 MB (taut run --memory raises it)"))

    def test_a_scene_that_does_not_fit_into_memory(self):
        if SANITIZED:
            self.skipTest("the sanitizer's allocator knows no limit on address space")
        study = self.study(rest='set = ["cloth.grid=[700, 700]"]\n')
        self.taut("run", study, "--memory", 100)
        record, = self.records()
        self.assertEqual((record["status"]["kind"], record["status"]["reason"]),
                         ("oom", "more than the limit of 100 MB (taut run --memory raises it)"))

    def test_none_leaves_its_process_group_or_its_folder(self):
        status = self.run_modes("exit74", "exit127", "chdir", "fork", "daemon", "fewer", "far", "forge")
        self.assertEqual({mode: s["kind"] for mode, s in status.items()},
                         {"jakobsen": "ok", "exit74": "error", "exit127": "error", "chdir": "ok", "fork": "ok", "daemon": "ok", "fewer": "error",
                          "far": "exploded", "forge": "error"})
        self.assertEqual(status["exit74"]["reason"], "exit code 74")
        self.assertEqual(status["exit127"]["reason"], "exit code 127")
        self.assertEqual(status["fewer"]["reason"], "stored 2 positions and 16 velocities of 16 vertices")
        self.assertEqual((status["far"]["reason"], status["far"]["vertex"]), ("box", 3))
        self.assertIn("key: expected 64 hexadecimal digits", status["forge"]["reason"])
        # os.walk instead of glob: folders of other tests may vanish meanwhile.
        self.assertEqual([path for path, _, files in os.walk(self.folder.parent) if "escaped" in files], [])
        for mode in ("fork", "daemon"):
            self.assertEnds(int((self.folder / f"left-by-{mode}").read_text()))

    def assertEnds(self, process):
        with self.assertRaises(ProcessLookupError, msg="a process that a case left behind lives on"):
            for _ in range(100):  # it was killed with the case, but its new parent still has to reap it
                os.kill(process, 0)
                if (pathlib.Path("/proc") / str(process) / "stat").read_text().split()[2] == "Z":
                    raise ProcessLookupError
                time.sleep(0.02)

    def test_ctrl_c_ends_what_left_its_session_too(self):
        study = self.study(solvers=["faulty:mode=daemon", "faulty:mode=held"])
        process = self.start("run", study, "-j", 2, program="taut-faulty")
        left = self.folder / "left-by-daemon"
        while not left.exists() or not left.read_text():
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=30)
        self.assertEqual(process.returncode, 130)
        self.assertEnds(int(left.read_text()))

    def test_what_is_stopped_or_ended_from_outside_has_no_result_and_runs_again(self):
        study = self.study(solvers=["jakobsen:precision=double", "faulty:mode=stop"])
        run = self.taut("run", study, "--timeout", 0.2, "-j", 2, program="taut-faulty", expect=3)
        self.assertIn("was stopped from outside; no result is stored", run.err)
        self.assertEqual([r["solver"] for r in self.records()], ["jakobsen"])
        for end in (signal.SIGKILL, signal.SIGTERM):
            study = self.study(solvers=["faulty:mode=held", "faulty:mode=stable"])
            process = self.start("run", study, program="taut-faulty")
            cases = []
            while not cases:
                cases = [p for p in self.children_of(process.pid) if b"faulty:mode=held" in b"".join(p[1])]
                time.sleep(0.02)
            os.kill(cases[0][0], end)
            said = process.communicate(timeout=60)[1]
            self.assertEqual(process.returncode, 3, said)
            self.assertIn("from outside; no result is stored", said)
            self.assertNotIn("held", [r["params"].get("mode") for r in self.records()])
        (self.folder / "go-on").touch()
        self.assertRegex(self.taut("run", study, program="taut-faulty").err, r"2/2 cases: .* 2 \(1 were stored already\)")

    def children_of(self, pid):
        found = []
        for task in pathlib.Path(f"/proc/{pid}/task").glob("*/children"):
            for child in task.read_text().split():
                try:
                    found.append((int(child), pathlib.Path(f"/proc/{child}/cmdline").read_bytes().split(b"\0")))
                except OSError:
                    pass
        return found

    def test_an_extreme_is_marked_wherever_it_shows(self):
        status = self.run_modes("stretch")["stretch"]
        self.assertEqual(status, {"kind": "extreme", "reason": "stretch", "step": 5, "vertex": 2})
        study = self.study(solvers=["faulty:mode=stretch", "faulty:mode=stable"])
        run = self.taut("run", study, "--table", "stretch.max", program="taut-faulty")
        self.assertIn("2/2 cases: ok 1, extreme 1", run.err)
        rows = {line.split()[0]: line.split()[1] for line in run.out.splitlines()[1:3]}
        self.assertEqual(rows["faulty:mode=stretch"], "extreme")
        row, = [row for row in csv.DictReader(self.taut("export", study, program="taut-faulty").out.splitlines())
                if row["mode"] == "stretch"]
        self.assertEqual(row["status"], "extreme")
        self.assertGreater(float(row["stretch.max"]), 100)  # kept, under its status
        model = json.loads(self.taut("report", study, "--json", program="taut-faulty").out)
        shown, = [status for status in model["statuses"] if status["id"] == "extreme"]
        self.assertTrue(shown["failed"])
        failures = model["answer"]["tables"]["failures"]
        self.assertIn("of 1: 1 extreme", json.dumps(failures))  # one case for each question and work
        self.assertIn("of all 2 cases of this page, 1 failed", failures["caption"])

    def test_a_value_of_a_case_that_should_rest_and_does_not_is_marked(self):
        study = self.study(solvers=["faulty:mode=restless", "faulty:mode=stable"], rest='set = ["forces.damping=1000"]\n')
        run = self.taut("run", study, "--table", "stretch.max", "--json", program="taut-faulty")
        self.assertIn("2/2 cases: ok 1, unsettled 1", run.err)
        table = json.loads(run.out)["tables"]["stretch.max"]
        self.assertEqual([(note["row"], note.get("note")) for note in table["notes"]], [(0, "~"), (1, None)])

    def test_printing_without_end(self):
        status = self.run_modes("print")["print"]
        self.assertIn(status["kind"], ("crash", "timeout"))

    def test_failures_run_again_only_on_request(self):
        study = self.study(solvers=["faulty:mode=throw", "faulty:mode=stable"])
        self.taut("run", study, program="taut-faulty")
        again = self.taut("run", study, program="taut-faulty")
        self.assertIn("(2 were stored already)", again.err)
        failed = self.taut("run", study, "--only", "failed", program="taut-faulty")
        self.assertIn("1/1 cases: error 1 (0 were stored already)", failed.err)


class Signals(CommandLine):
    """A bare run that is ended in any phase, and a report that is ended, leave nothing in the folder for temporary files."""

    def setUp(self):
        super().setUp()
        for folder in ("data/scenes", "data/studies", "temporary"):
            (self.folder / folder).mkdir(parents=True)
        (self.folder / "small.toml").rename(self.folder / "data/scenes/small.toml")
        for name, axes in [("small", "iterations = [1, 2]"), ("small-map", 'iterations = [1, 2]\ntime.dt = ["1/64", "1/32"]')]:
            (self.folder / f"data/studies/{name}.toml").write_text(
                f'question = "?"\nscenes = ["small"]\nsolvers = ["jakobsen", "bullet"]\n[axes]\n{axes}\n[preset.quick]\nset = []\n'.replace(
                    "set = []", 'set = ["time.duration=0.25"]') + '[[plot]]\nkind = "stability"\n')
        (self.folder / "data/main-job.toml").write_text(
            'preset = "quick"\nstudies = ["small"]\nmaps = ["small-map"]\nbench = "small"\n')
        self.env = {**os.environ, "TAUT_DATA": str(self.folder / "data"), "TMPDIR": str(self.folder / "temporary")}

    def end_at(self, marker, stop, *words):
        process = self.start(*words, env=self.env)
        said = ""
        while marker not in said:
            line = process.stderr.readline()
            self.assertTrue(line, f"it ended before '{marker}':\n{said}")
            said += line
        process.send_signal(stop)
        _, rest = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, said + rest)
        self.assertEqual(list((self.folder / "temporary").iterdir()), [])

    def test_a_bare_run_ends_in_each_of_its_phases(self):
        for marker in ["[1/", "timing", "part 4 of 6: solvers"]:
            for stop in (signal.SIGINT, signal.SIGTERM):
                with self.subTest(marker, stop=stop):
                    shutil.rmtree(self.folder / "results", ignore_errors=True)
                    self.end_at(marker, stop, "run", "-j", 1)

    def test_a_report_that_is_ended_leaves_no_folder_and_no_part_of_a_page(self):
        self.taut("run", "small", env=self.env)
        more = []  # more scenes to film, so that work is left when the first line is printed
        for k in range(6):
            shutil.copy(self.folder / "data/scenes/small.toml", self.folder / f"data/scenes/small-{k}.toml")
            more += ["--film", f"small-{k}"]
        for stop in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
            for films in self.folder.glob("results/**/films"):
                shutil.rmtree(films)  # existing films would not be made again
            self.end_at("small", stop, "report", "small", *more)
            for file in self.folder.glob("*report*"):  # it had just been written
                self.assertEqual(file.name, "report.html")
                self.assertTrue(file.read_text().rstrip().endswith("</html>"))
                file.unlink()


class Input(CommandLine):
    def refuse(self, scene, says):
        done = self.taut("case", scene, "jakobsen", expect=2)
        self.assertIn(says, done.err)
        self.assertNotIn("terminate", done.err)

    def test_files_that_are_none(self):
        os.mkfifo(self.folder / "pipe.toml")
        os.mkfifo(self.folder / "pipe.obj")
        self.refuse("./pipe.toml", "pipe.toml: no such scene file")
        for mesh, says in [("/dev/zero", "/dev/zero: is not a regular file"), ("/proc/self/mem", "/proc/self/mem: cannot be read"),
                           ("pipe.obj", "pipe.obj: is not a regular file"), ("none.obj", "none.obj: cannot be read: No such file")]:
            (self.folder / "mesh.toml").write_text(f'[cloth]\nmesh = "{mesh}"\nmass = 1\n')
            self.refuse("./mesh.toml", "./mesh.toml:2:8: 'mesh' in [cloth] cannot be used: ")
            self.refuse("./mesh.toml", says)

    def test_a_pipe_is_never_waited_for(self):
        (self.folder / "results/runs").mkdir(parents=True)
        for pipe in ("pipe.pc2", "pipe.npy", "pipe.toml", "results/runs/results.db"):
            os.mkfifo(self.folder / pipe)
        study = self.study()
        for words in (["external", "score", "./small.toml", "pipe.pc2"], ["external", "score", "./small.toml", "pipe.npy"],
                      ["run", "./pipe.toml"], ["case", "./small.toml", "jakobsen", "--set", 'cloth.mesh="pipe.npy"'],
                      ["run", study], ["export", study], ["report", study], ["cluster", "merge", "results/runs"]):
            self.assertRegex(self.taut(*words, expect=2).err, "is not a regular file|no such study file", words)

    def test_documents_without_bottom(self):
        for name, text in [("keys", ".".join(["a"] * 60_000) + " = 1\n"), ("tables", "[" + ".".join(["a"] * 60_000) + "]\n"),
                           ("arrays", "a = " + "[" * 60_000 + "]" * 60_000), ("inline", "a = " + "{a = " * 60_000 + "1" + "}" * 60_000)]:
            with self.subTest(name):
                (self.folder / "deep.toml").write_text(text)
                self.refuse("./deep.toml", "deep.toml:1:")
        (self.folder / "large.toml").write_text("#" * (17 << 20))
        self.refuse("./large.toml", "is larger than 16 MiB")

    def test_a_study_has_no_line_breaks_in_its_texts(self):
        study = self.study(rest='[[plot]]\nkind = "stability"\ntitle = "x\\n`id`"\n')
        refused = self.taut("run", study, expect=2)
        self.assertIn("study.toml:6:9: a text of a study holds no line breaks", refused.err)


class Store(CommandLine):
    MANY = 'axes.iterations = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]\n'

    def test_a_second_run_reuses_everything(self):
        study = self.study(rest=self.MANY)
        first = self.taut("run", study)
        second = self.taut("run", study)
        self.assertIn("(12 were stored already)", second.err)
        self.assertEqual(self.store_digest(first), self.store_digest(second))

    def test_kill_9_at_random_moments_then_resume(self):
        study = self.study(solvers=["faulty:mode=slow"], rest=f"axes.variant = {list(range(3 * KILLS))}\n")
        whole = self.store_digest(self.taut("run", study, "--out", "whole", "-j", 8, program="taut-faulty"))
        moments = random.Random(1)
        hits = 0
        for _ in range(KILLS):
            process = self.start("run", study, "-j", 2, program="taut-faulty")
            time.sleep(moments.uniform(0, 0.8))
            hits += process.poll() is None
            process.kill()
            process.communicate()
            self.assertEqual([tuple(row) for row in stored.query(self.folder / "results/runs", "PRAGMA integrity_check")] or [("ok",)], [("ok",)])
        self.assertGreater(hits, KILLS // 2, "most kills have to hit a run that has not ended")
        resumed = self.taut("run", study, program="taut-faulty")
        self.assertEqual(self.store_digest(resumed), whole)
        self.assertEqual(len(self.keys()), 3 * KILLS, "none lost, none counted twice")
        self.assertEqual([file.name for file in (self.folder / "results/runs").glob("results.db*")], ["results.db"])

    def test_ctrl_c_then_resume(self):
        study = self.study(solvers=TWO_AND_HELD)
        process = self.start("run", study, "-j", 1, program="taut-faulty")
        while not self.keys():
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 130, said)
        self.assertIn("goes on where this one stopped", said)
        self.assertLess(len(self.keys()), 4)
        (self.folder / "go-on").touch()
        self.taut("run", study, program="taut-faulty")
        self.assertEqual(len(self.keys()), 4)

    def test_a_run_that_ignores_hangups_goes_on(self):
        study = self.study(solvers=TWO_AND_HELD)
        for ignored, code in ((False, 130), (True, 0)):
            process = self.start("run", study, "-j", 1, "--out", f"ignored-{ignored}", program="taut-faulty", preexec_fn=(
                (lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN)) if ignored else None))
            while "[1/4]" not in (line := process.stderr.readline()):
                self.assertTrue(line, "it ended")
            process.send_signal(signal.SIGHUP)
            if ignored:
                (self.folder / "go-on").touch()
            _, said = process.communicate(timeout=30)
            self.assertEqual(process.returncode, code, said)

    def test_two_runs_share_a_folder(self):
        study = self.study(solvers=["faulty:mode=held"], rest="axes.variant = [0, 1, 2, 3, 4, 5]\n")
        scratch = self.folder / "scratch"
        scratch.mkdir()
        both = [self.start("run", study, "-j", 3, program="taut-faulty", env={**os.environ, "TMPDIR": str(scratch)})]
        while not [*scratch.glob("*/*/heartbeat")]:
            time.sleep(0.01)
        both.append(self.start("run", study, "-j", 3, program="taut-faulty"))
        (self.folder / "go-on").touch()
        for process in both:
            _, said = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 0, said)
        self.assertEqual(len(self.keys()), 6)
        self.assertEqual(stored.query(self.folder / "results/runs", "SELECT * FROM conflicts"), [])
        self.assertEqual([*scratch.iterdir()], [])

    def test_a_run_that_is_stopped_for_a_while_goes_on(self):
        study = self.study(solvers=["faulty:mode=slow"], rest="axes.variant = [0, 1, 2, 3, 4, 5]\n")
        process = self.start("run", study, "-j", 2, program="taut-faulty")
        for _ in range(3):
            time.sleep(0.3)
            process.send_signal(signal.SIGSTOP)
            self.keys()  # others can read meanwhile
            process.send_signal(signal.SIGCONT)
        _, said = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0, said)
        self.assertEqual(len(self.keys()), 6)

    def test_an_interrupted_bench_keeps_the_stored_one(self):
        study = self.study(solvers=["faulty:mode=slow"], rest="axes.variant = [0, 1]\n")
        self.taut("bench", study, "--rounds", 1, "--seconds", 0.01, program="taut-faulty")
        def timed():
            return [tuple(row) for row in stored.query(self.folder / "results/runs", "SELECT * FROM benches JOIN timings USING (bench_id) JOIN samples USING (timing_id)")]
        before = timed()
        self.assertEqual(len(before), 4)
        for stop in (signal.SIGINT, signal.SIGTERM):
            process = self.start("bench", study, "--rounds", 1000, program="taut-faulty")
            while "timing" not in (line := process.stderr.readline()):
                self.assertTrue(line, "it ended")
            time.sleep(0.5)
            process.send_signal(stop)
            process.communicate(timeout=30)
            self.assertEqual(process.returncode, 130)
            self.assertEqual(timed(), before)

    def test_a_bench_interrupted_before_it_times_stores_nothing(self):
        process = self.start("bench", self.study(solvers=TWO_AND_HELD), program="taut-faulty")
        while not self.keys():
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 130, said)
        self.assertEqual(stored.query(self.folder / "results/runs", "SELECT * FROM benches"), [])

    def test_output_that_cannot_be_written(self):
        with open("/dev/full", "w") as full:
            process = subprocess.run([BINARIES / "taut", "case", "./small.toml", "jakobsen", "--json"], cwd=self.folder,
                                     stdout=full, stderr=subprocess.PIPE, text=True, timeout=60)
        self.assertEqual(process.returncode, 2, process.stderr)
        self.assertIn("cannot be written", process.stderr)

    def test_without_standard_descriptors_nothing_is_lost(self):
        def closed():
            for descriptor in (0, 1, 2):
                os.close(descriptor)
        run = subprocess.run([BINARIES / "taut", "run", self.study()], cwd=self.folder, preexec_fn=closed, timeout=60)
        self.assertEqual(run.returncode, 2, "its output cannot be written")
        self.assertEqual([r["status"]["kind"] for r in self.records()], ["ok"])
        case = [BINARIES / "taut", "case", "./small.toml", "jakobsen", "--trajectory"]
        subprocess.run([*case, "closed.npy"], cwd=self.folder, preexec_fn=closed, timeout=60)
        subprocess.run([*case, "open.npy"], cwd=self.folder, stdout=subprocess.DEVNULL, timeout=60, check=True)
        self.assertEqual((self.folder / "closed.npy").read_bytes(), (self.folder / "open.npy").read_bytes())

    def test_limits_have_a_largest_value(self):
        study = self.study()
        for words in (["run", study, "--timeout"], ["advise", "hang", "--error", "1%", "--patience"], ["require", "hang", "--patience"],
                      ["bench", study, "--seconds"], ["bench", "scaling", "--limit"]):
            for value in ("1e300", "1e18", "inf", "1000001"):
                self.assertIn("at most 1e6", self.taut(*words, value, expect=2).err)
        self.taut("run", study, "--timeout", 1e6)
        self.assertEqual([r["status"]["kind"] for r in self.records()], ["ok"])

    def test_damaged_cases_are_reported_and_run_again(self):
        study = self.study(rest=self.MANY)
        digest = self.store_digest(self.taut("run", study))
        results = self.folder / "results/runs"
        first, second, third = self.keys()[:3]
        stored.change(results, "UPDATE numbers SET value = 1e9 WHERE case_id = (SELECT case_id FROM cases WHERE key = ?)", first)
        stored.change(results, "DELETE FROM numbers WHERE case_id = (SELECT case_id FROM cases WHERE key = ?)", second)
        stored.change(results, "UPDATE cases SET passes = '{' WHERE key = ?", third)
        again = self.taut("run", study)
        self.assertEqual(again.err.count("damaged case"), 3, again.err)
        self.assertIn("(9 were stored already)", again.err)
        self.assertEqual(self.store_digest(again), digest)
        self.assertEqual(len(self.keys()), 12)

    def test_a_damaged_file_is_reported_set_aside_and_begun_anew(self):
        study = self.study(rest=self.MANY)
        digest = self.store_digest(self.taut("run", study))
        file = self.folder / "results/runs/results.db"
        whole = file.read_bytes()
        for damaged in (b"no database" + whole[11:], whole[:4096] + b"\x55" * (len(whole) - 4096), whole[:len(whole) // 2]):
            with self.subTest(damaged[:4]):
                file.write_bytes(damaged)
                self.assertIn("results.db: damaged", self.taut("export", study, expect=2).err)
                self.assertEqual(file.read_bytes(), damaged, "who reads leaves it alone")
                again = self.taut("run", study)
                self.assertRegex(again.err, "results/runs/results.db: damaged, set aside as .*; begun anew")
                self.assertEqual(self.store_digest(again), digest)
                aside, = file.parent.glob("results.db.damaged-*")
                self.assertEqual(aside.read_bytes(), damaged)
                aside.unlink()

    def test_a_file_that_vanishes_or_is_locked_is_said(self):
        study = self.study(solvers=TWO_AND_HELD)
        process = self.start("run", study, "-j", 1, program="taut-faulty")
        while not self.keys():
            time.sleep(0.02)
        (self.folder / "results/runs/results.db").unlink()
        (self.folder / "go-on").touch()
        _, said = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 2, said)
        self.assertRegex(said.splitlines()[-1], "^results/runs/results.db: cannot (write|open): ")

    def test_shards_merge_and_a_missing_one_is_named(self):
        study = self.study(rest=self.MANY)
        whole = self.store_digest(self.taut("run", study))
        for i in (1, 2, 3):
            self.taut("run", study, "--shard", f"{i}/3", "--out", f"shard{i}")
        # Keys depend on the build. With twelve cases, one in 43 builds leaves a shard empty; leaving that one out would miss nothing.
        absent = max((1, 2, 3), key=lambda i: len(self.keys(f"shard{i}")))
        others = [f"shard{i}" for i in (1, 2, 3) if i != absent]
        partial = self.taut("cluster", "merge", *others, "--out", "partial", expect=3)
        self.assertIn(f"(shard {absent})", partial.out)
        self.assertFalse((self.folder / "partial").exists())
        merged = self.taut("cluster", "merge", "shard1", "shard2", "shard3", "--out", "merged")
        self.assertRegex(merged.out, r"there +12\b")
        self.assertEqual(self.store_digest(merged), whole)
        again = self.taut("cluster", "merge", *others, "--out", "merged")
        self.assertEqual(self.store_digest(again), whole, "what is there already is not missing")

    def test_a_slurm_array_is_a_shard(self):
        study = self.study(rest=self.MANY)
        for task in (0, 1):
            self.taut("run", study, env={**os.environ, "SLURM_ARRAY_TASK_ID": str(task), "SLURM_ARRAY_TASK_MIN": "0",
                                         "SLURM_ARRAY_TASK_COUNT": "2"})
        self.assertEqual(len(self.keys()), 12)

    def test_another_result_under_the_same_key_is_an_alarm(self):
        study = self.study(solvers=["faulty:mode=random,at=3"])
        self.taut("run", study, "--out", "a", program="taut-faulty")
        self.taut("run", study, "--out", "b", program="taut-faulty")
        merged = self.taut("cluster", "merge", "a", "b", "--out", "c", expect=6)
        self.assertIn("a and b have different results", merged.out)
        self.assertFalse((self.folder / "c").exists())

    def test_a_folder_that_cannot_be_written(self):
        study = self.study(rest=self.MANY)
        (self.folder / "file").write_text("")
        run = self.taut("run", study, "--out", "file/results", expect=2)
        self.assertIn("cannot create", run.err)
        if os.geteuid() != 0:
            (self.folder / "locked").mkdir(mode=0o500)
            self.assertIn("Permission denied", self.taut("run", study, "--out", "locked", expect=2).err)

    FILE_BYTES = 120_000  # a limit on file sizes that an empty results file meets, but not the manifest of 1000 cases

    def test_a_session_that_cannot_be_recorded_leaves_nothing(self):
        study = self.study(rest="axes.iterations = { from = 1, to = 1000, steps = 1000 }\n")

        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (self.FILE_BYTES, self.FILE_BYTES))
        full = self.taut("run", study, expect=2, preexec_fn=limit)
        self.assertRegex(full.err, "^results/runs/results.db: cannot write: File too large\n$")
        self.assertEqual(stored.query(self.folder / "results/runs", "SELECT session FROM sessions UNION SELECT key FROM planned"), [])

    def test_a_results_folder_that_is_moved_away_loses_nothing_finished(self):
        study = self.study(solvers=TWO_AND_HELD)
        goes_on = self.folder / "go-on"
        goes_on.touch()
        whole = self.store_digest(self.taut("run", study, "--out", "whole", "-j", 4, program="taut-faulty"))
        goes_on.unlink()
        process = self.start("run", study, "-j", 1, program="taut-faulty")
        while not self.keys():
            time.sleep(0.02)
        (self.folder / "results/runs").rename(self.folder / "moved")
        goes_on.touch()
        _, said = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 2, said)
        self.assertIn("results/runs/", said.splitlines()[-1])
        kept = len(self.keys("moved"))
        self.assertGreater(kept, 0)
        again = self.taut("run", study, "--out", "moved", program="taut-faulty")
        self.assertIn(f"({kept} were stored already)", again.err)
        self.assertEqual(self.store_digest(again), whole)

    def test_results_that_are_read_only_can_be_read_and_not_added_to(self):
        place = self.folder / "disk"
        place.mkdir()
        if os.geteuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "tmpfs", place], capture_output=True).returncode != 0:
            self.skipTest("needs a file system of its own")
        self.addCleanup(subprocess.run, ["umount", place])
        study = self.study(rest=self.MANY)
        self.taut("run", study, "--out", "disk/results")
        subprocess.run(["mount", "-o", "remount,ro", place], check=True)
        before = sorted(place.rglob("*"))
        for more in (self.MANY, "axes.iterations = [100]\n"):
            refused = self.taut("run", self.study(rest=more), "--out", "disk/results", expect=2)
            self.assertRegex(refused.err, "^disk/results/.*: cannot (write|create): Read-only file system\n$")
        study = self.study(rest=self.MANY)
        rows = self.taut("export", study, "--out", "disk/results").out.splitlines()
        self.assertEqual(len(rows), 13)
        self.taut("plot", study, "--out", "disk/results", "--kind", "convergence", "-o", "figures")
        json.loads(self.taut("report", study, "--out", "disk/results", "--json").out)
        self.assertEqual(sorted(place.rglob("*")), before)

    def test_a_clock_that_jumps_changes_nothing(self):
        if SANITIZED:
            self.skipTest("the sanitizer wants to be the first that is preloaded")
        study = self.study(solvers=["faulty:mode=slow"], rest='set = ["time.duration=2.5"]\naxes.variant = [0, 1]\n')  # takes seconds, in which the clock is read often
        whole = self.store_digest(self.taut("run", study, "--out", "whole", program="taut-faulty"))
        clock = self.folder / "clock.so"  # a path in LD_PRELOAD ends at a space
        clock.symlink_to(BINARIES / "libjumping_clock.so")
        jumping = {**os.environ, "LD_PRELOAD": str(clock)}
        years = {subprocess.run(["date", "+%Y"], env=jumping, capture_output=True, check=True).stdout for _ in range(2)}
        years.add(time.strftime("%Y\n").encode())
        self.assertGreater(len(years), 1, "the clock has to jump")
        run = self.taut("run", study, "--timeout", 30, program="taut-faulty", env=jumping)
        self.assertEqual(self.store_digest(run), whole)
        self.assertNotIn("timeout", {record["status"]["kind"] for record in self.records()})
        self.assertIn("(2 were stored already)", self.taut("run", study, program="taut-faulty", env=jumping).err)
        self.assertRegex(self.taut("cluster", "merge", "results/runs", "--out", "merged", env=jumping).out, r"there +2\b")

    def test_two_hosts_that_write_one_file_on_a_network_file_system_are_refused(self):
        if SANITIZED:
            self.skipTest("the sanitizer wants to be the first that is preloaded")
        disk = self.folder / "network.so"  # a path in LD_PRELOAD ends at a space
        disk.symlink_to(BINARIES / "libnetwork_disk.so")
        zeus, ares = ({**os.environ, "LD_PRELOAD": str(disk), "HOST_NAME": name} for name in ("zeus", "ares"))
        study = self.study(solvers=TWO_AND_HELD)
        mark = self.folder / "results/runs/results.db.writer"
        process = self.start("run", study, "-j", 1, program="taut-faulty", env=zeus)
        while not self.keys():
            time.sleep(0.02)
        self.assertEqual(mark.read_text(), f"zeus {process.pid}\n")
        refused = self.taut("run", study, program="taut-faulty", env=ares, expect=2)
        self.assertIn("results.db: host zeus writes it too, and between hosts the locks of NFS are not reliable", refused.err)
        self.taut("export", study, program="taut-faulty", env=ares, expect=3)  # reading is allowed
        (self.folder / "go-on").touch()
        self.taut("run", study, program="taut-faulty", env=zeus)  # and so is a second process of the same host
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0)
        self.assertFalse(mark.exists())
        mark.write_text("zeus 999999999\n")  # of a process that was killed
        self.taut("run", study, program="taut-faulty", env=ares, expect=2)
        self.assertIn("(4 were stored already)", self.taut("run", study, program="taut-faulty", env=zeus).err)
        self.taut("run", study, program="taut-faulty", env=ares)
        mark.write_text("zeus \n")  # cut off by a full disk: names no process
        self.taut("run", study, program="taut-faulty", env=zeus)
        self.assertFalse(mark.exists())

    def test_a_program_that_vanishes_is_no_result(self):
        study = self.study(solvers=TWO_AND_HELD)
        mine = self.folder / "taut-faulty"
        shutil.copy(BINARIES / "taut-faulty", mine)
        process = self.start("run", study, "-j", 1, program=mine)  # an absolute path is used unchanged
        while not self.keys():
            time.sleep(0.05)
        mine.unlink()
        (self.folder / "go-on").touch()
        _, said = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 2, said)
        self.assertIn("cannot be executed", said)
        self.assertEqual({record["status"]["kind"] for record in self.records()}, {"ok"})

    def test_a_full_disk_loses_nothing_finished(self):
        place = self.folder / "disk"
        place.mkdir()
        if os.geteuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "tmpfs", place], capture_output=True).returncode != 0:
            self.skipTest("needs a small file system")
        self.addCleanup(subprocess.run, ["umount", place])
        study = self.study(rest="axes.iterations = { from = 1, to = 60, steps = 60 }\n")
        whole = self.store_digest(self.taut("run", study))
        for kilobytes in range(300, 348, 8):  # each time the disk is full at another moment of a case
            subprocess.run(["mount", "-o", f"remount,size={kilobytes}k", place], check=True)
            run = self.taut("run", study, "--out", "disk/results", expect=2)
            self.assertIn("No space left", run.err)
            self.assertEqual({record["status"]["kind"] for record in self.records("disk/results")}, {"ok"},
                             "a full disk is no property of a case")
            kept = len(self.keys("disk/results"))
            self.assertGreater(kept, 0)
            shutil.copytree(place / "results", self.folder / "moved")
            moved = self.taut("run", study, "--out", "moved")
            self.assertIn(f"({kept} were stored already)", moved.err)
            self.assertEqual(self.store_digest(moved), whole)
            shutil.rmtree(self.folder / "moved")
            shutil.rmtree(place / "results")


if __name__ == "__main__":
    main()
