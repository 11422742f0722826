#!/usr/bin/env python3
"""taut history: finds the build, or the commit of a repository, that changed the values or the cost of a study; and its behaviour
if commits, builds, folders or ranges are faulty.

Usage: history_test.py FOLDER_OF_TAUT [TEST ...]"""

import json
import os
import pathlib
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
import unittest
import xml.etree.ElementTree

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "cli"))
from command_line import BINARIES, CommandLine, facts_of, main, rows_of  # noqa: E402

SDK = HERE.parents[1] / "experiments" / "external" / "sdk"
os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
for variable in ("TAUT_BUILD_ID", "TAUT_COMMIT"):
    os.environ.pop(variable, None)
COMMITS = 10
NAMES = {"GIT_AUTHOR_NAME": "a", "GIT_AUTHOR_EMAIL": "a@x", "GIT_COMMITTER_NAME": "a", "GIT_COMMITTER_EMAIL": "a@x"}
# The SDK's toy with a relaxation factor, a wait in every step, and a place for code that runs at its start.
TOY = ((SDK / "toy.py").read_text()
       .replace("import math\n", "import math\nimport sys\nimport time\n\nRELAXATION = 1.0\nWAIT = 0\nSPIN = 0\n# START\n")
       .replace("(length - rest) / (length * w)", "RELAXATION * (length - rest) / (length * w)")
       .replace("        for _ in range(self.sweeps):",
                "        time.sleep(WAIT)\n        sum(range(SPIN))\n        for _ in range(self.sweeps):"))


def git(folder, *words, **environment):
    return subprocess.run(["git", "-C", folder, *words], check=True, capture_output=True, text=True,
                          env=os.environ | NAMES | environment).stdout.strip()


class Repository(CommandLine):
    def setUp(self):
        super().setUp()
        self.study(rest="[axes]\niterations = [4]\n")

    def repository(self, changes, commits=COMMITS):
        """Makes a repository of a solver in Python. `changes` lists the replacements (old, new) that each commit, counted from 0, makes."""
        folder, text, made = self.folder / "repo", TOY, []
        folder.mkdir()
        git(folder, "init", "-q", "-b", "main")
        shutil.copy(SDK / "taut_solver.py", folder)
        for k in range(commits):
            for old, new in changes.get(k, []):
                self.assertIn(old, text)
                text = text.replace(old, new)
            (folder / "mine.py").write_text(text)
            (folder / "notes").write_text(f"{k}\n")
            git(folder, "add", "-A")
            day = f"2026-05-{k + 1:02d}T10:00:00Z"
            git(folder, "commit", "-q", "-m", f"change {k}", GIT_AUTHOR_DATE=day, GIT_COMMITTER_DATE=day)
            made.append(git(folder, "rev-parse", "HEAD"))
        return made

    def history(self, *words, commits=None, solver="python3 mine.py", **more):
        return self.taut("history", "./study.toml", "--git", "repo", "--commits", commits or f"HEAD~{COMMITS - 1}..HEAD",
                         "--solver", solver, "--out", "out", *words, **more)

    def found(self, *words, **more):
        return json.loads(self.history(*words, "--json", **more).out)

    def stepped(self, answer):
        """{build: values that stepped there}"""
        at = {}
        for row in rows_of(answer, "steps"):
            at.setdefault(row["build"], set()).add(row["value"])
        return at


RELAXED = {6: [("RELAXATION = 1.0", "RELAXATION = 0.94")]}


class Commits(Repository):
    def test_a_changed_relaxation_is_named_and_no_other_commit(self):
        made = self.repository(RELAXED)
        answer = self.found()
        self.assertEqual(list(self.stepped(answer)), [made[6]])
        self.assertIn("stretch.rms", self.stepped(answer)[made[6]])
        self.assertEqual(facts_of(answer)["gaps"], 0)
        self.assertFalse(facts_of(answer)["last_stepped"])
        sentence = next(row["step"] for row in rows_of(answer, "steps") if row["value"] == "stretch.rms")
        self.assertRegex(sentence, rf"^stretch\.rms of small solver:iterations=4 rose from .* to .* % at {made[6][:10]} \(2026-05-07\)$")
        rows = rows_of(answer, "values")
        self.assertEqual([row["build"] for row in rows], made)
        self.assertEqual(len({row["value"] for row in rows}), 2)

    def test_the_last_commit_that_changed_something_is_exit_1_and_a_failure_of_junit(self):
        made = self.repository(RELAXED)
        ended = self.history("--junit", "found.xml", commits="HEAD~9..HEAD~3", expect=1)
        self.assertIn(made[6][:10], ended.out)
        suite = xml.etree.ElementTree.parse(self.folder / "found.xml").getroot()[0]
        self.assertEqual((suite.get("tests"), suite.get("failures")), ("1", "1"))
        self.assertIn("stretch.rms", suite[0][0].text)
        self.history("--junit", "found.xml", commits="HEAD~9..HEAD~4")
        self.assertEqual(xml.etree.ElementTree.parse(self.folder / "found.xml").getroot()[0].get("failures"), "0")

    def test_results_are_kept_and_what_was_interrupted_goes_on(self):
        made = self.repository(RELAXED)
        process = self.start("history", "./study.toml", "--git", "repo", "--commits", "HEAD~9..HEAD", "--solver", "python3 mine.py",
                             "--out", "out")
        while not (line := process.stderr.readline()).endswith("change 4\n") and line:  # "building ... change 4"
            pass
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)
        again = self.history()
        self.assertNotIn(made[2][:10], again.err)
        self.assertIn(f"building {made[9][:10]}", again.err)
        self.assertNotIn("building", self.history().err)

    def test_a_bisection_builds_as_few_as_it_needs(self):
        made = self.repository(RELAXED, commits=17)
        (self.folder / "repo" / "untouched").write_text("mine\n")
        before = git(self.folder / "repo", "status", "--porcelain", "--branch")
        answer = self.found("--bisect", "stretch.rms", commits="HEAD~16..HEAD")
        self.assertIn(made[6][:10], facts_of(answer)["named"])
        self.assertIn("change 6", facts_of(answer)["named"])
        self.assertLessEqual(facts_of(answer)["builds"], 2 + 4)
        self.assertEqual(git(self.folder / "repo", "status", "--porcelain", "--branch"), before)
        self.assertEqual(git(self.folder / "repo", "worktree", "list").count("\n"), 0)

    def test_a_bisection_of_what_did_not_change_says_so(self):
        self.repository({}, commits=3)
        answer = self.found("--bisect", "stretch.rms", commits="HEAD~2..HEAD")
        self.assertIn("does not differ", facts_of(answer)["named"])
        self.assertEqual(facts_of(answer)["builds"], 2)

    def test_a_commit_that_does_not_build_is_a_gap_and_a_bisection_goes_round_it(self):
        made = self.repository({4: [("# START", "# BROKEN")], 6: [("# BROKEN", "# START"), ("RELAXATION = 1.0", "RELAXATION = 0.94")]})
        build = ["--build", "! grep -q BROKEN mine.py || { echo it is broken; exit 3; }"]
        answer = self.found(*build, expect=3)
        gaps = {row["build"]: row["gap"] for row in rows_of(answer, "builds") if row["gap"]}
        self.assertEqual(list(gaps), [made[4][:10], made[5][:10]])
        self.assertIn("exit code 3: it is broken", gaps[made[4][:10]])
        self.assertEqual(list(self.stepped(answer)), [made[6]])
        self.assertTrue(any("or at one of 2 builds before it" in row["step"] for row in rows_of(answer, "steps")))
        self.assertNotIn("building", self.history(*build, expect=3).err)
        self.assertIn(f"building {made[4][:10]}", self.history(*build, "--again", expect=3).err)
        shutil.rmtree(self.folder / "out")
        named = facts_of(self.found(*build, "--bisect", "stretch.rms", expect=None))["named"]
        self.assertIn(f"first changed at {made[6][:10]}", named)
        self.assertIn("or at one of the 2 commits", named)

    def test_a_solver_that_no_longer_introduces_itself_is_a_gap(self):
        self.repository({3: [("# START", "sys.exit('no more')")]}, commits=5)
        answer = self.found(commits="HEAD~4..HEAD", solver="mine:cmd='python3 mine.py'", expect=3)
        gaps = {row["subject"]: row["gap"] for row in rows_of(answer, "builds") if row["gap"]}
        self.assertEqual(list(gaps), ["change 3", "change 4"])
        self.assertIn("its solver does not answer: exit code 1 during 'hello': no more", gaps["change 3"])

    def test_a_solver_that_ends_within_a_step_is_a_step_of_its_status(self):
        made = self.repository({3: [("        time.sleep(WAIT)", "        t > 0.3 and sys.exit('no more')\n        time.sleep(WAIT)")]}, commits=5)
        answer = self.found(commits="HEAD~4..HEAD")
        self.assertEqual(self.stepped(answer), {made[3]: {"status"}})
        self.assertIn("ok to crash", rows_of(answer, "steps")[0]["step"])


class Costs(Repository):
    def test_a_solver_that_waits_is_named_by_its_speed_alone(self):
        made = self.repository({3: [("WAIT = 0", "WAIT = 0.003")]}, commits=6)
        answer = self.found("--speed", commits="HEAD~5..HEAD")
        found = self.stepped(answer)
        self.assertEqual(list(found), [made[3]], rows_of(answer, "ratios"))
        self.assertLessEqual(found[made[3]], {"cpu.per_step", "wall.per_step"})

    def test_a_dearer_commit_is_bisected(self):
        made = self.repository({3: [("SPIN = 0", "SPIN = 400000")]}, commits=6)
        answer = self.found("--bisect", "cpu.per_step", commits="HEAD~5..HEAD", expect=None)
        self.assertIn(f"first changed at {made[3][:10]}", facts_of(answer)["named"])

    def test_a_machine_under_load_is_no_step(self):
        self.repository({}, commits=4)
        load = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(os.cpu_count() or 2)]
        try:
            answer = self.found("--speed", commits="HEAD~3..HEAD")
        finally:
            for process in load:
                process.kill()
                process.wait()
        self.assertEqual(self.stepped(answer), {}, rows_of(answer, "ratios"))
        self.assertEqual(len(rows_of(answer, "ratios")), 2 * 3)


class BadInput(Repository):
    def test_ranges_that_make_no_sense(self):
        self.repository({}, commits=3)
        git(self.folder / "repo", "branch", "side", "HEAD~1")
        for commits, said in [("HEAD..HEAD~2", "wrong way round"), ("nobody..HEAD", "'nobody' is not a commit of"), ("HEAD", "expected A..B"),
                              ("HEAD..HEAD", "the same commit"), ("HEAD~1...HEAD", "expected A..B"), ("--all..HEAD", "is not a commit"),
                              ("..HEAD", "expected A..B")]:
            with self.subTest(commits):
                self.assertIn(said, self.taut("history", "./study.toml", "--git", "repo", f"--commits={commits}", "--solver", "python3 mine.py",
                                              "--out", "out", expect=2).err)
        self.assertFalse((self.folder / "out" / "checkouts").exists())

    def test_folders_that_are_no_repository(self):
        for folder, said in [("nowhere", "no such folder"), (".", "not a repository")]:
            self.assertIn(said, self.taut("history", "./study.toml", "--git", folder, "--commits", "A..B", "--solver", "python3 mine.py",
                                          expect=2).err)

    def test_a_build_that_hangs_is_a_gap(self):
        self.repository({}, commits=2)
        start = time.time()
        answer = self.found("--build", "sleep 100 & sleep 100",
                            "--build-timeout", "1", commits="HEAD~1..HEAD", expect=4)
        self.assertLess(time.time() - start, 30)
        self.assertEqual([row["gap"] for row in rows_of(answer, "builds")], ["its build takes more than 1 s"] * 2)

    def test_a_build_that_takes_too_much_disk_is_a_gap(self):
        self.repository({}, commits=2)
        answer = self.found("--build", "for i in 1 2 3; do head -c 400000 /dev/zero >big$i; done", "--disk", "0.001", commits="HEAD~1..HEAD",
                            expect=4)
        self.assertTrue(all("of disk, more than" in row["gap"] for row in rows_of(answer, "builds")), rows_of(answer, "builds"))

    def test_files_that_change_after_the_build_are_said(self):
        self.repository({5: [("# START", "open('notes', 'a').write('more')")]}, commits=7)
        answer = self.found(commits="HEAD~6..HEAD", expect=3)
        gaps = {row["subject"]: row["gap"] for row in rows_of(answer, "builds") if row["gap"]}
        self.assertEqual(list(gaps), ["change 5", "change 6"])
        self.assertIn("changed after its build", gaps["change 5"])

    def test_a_broken_checkout_is_made_anew_and_never_the_one_around_it(self):
        git(self.folder, "init", "-q", "-b", "main")
        (self.folder / "mine").write_text("of the user\n")
        git(self.folder, "add", "mine")
        git(self.folder, "commit", "-q", "-m", "of the user")
        (self.folder / "mine").write_text("not yet committed\n")
        self.repository({}, commits=2)
        self.history(commits="HEAD~1..HEAD")
        checkout = next(p for p in (self.folder / "out" / "checkouts").iterdir() if p.is_dir())
        (checkout / ".git" / "HEAD").write_text("nonsense")
        with sqlite3.connect(self.folder / "out" / "results.db") as store:
            store.execute("delete from ran")
        self.history(commits="HEAD~1..HEAD", env=os.environ | {"GIT_DIR": str(self.folder / ".git")})
        self.assertEqual((self.folder / "mine").read_text(), "not yet committed\n")
        self.assertEqual(git(self.folder, "log", "--format=%s"), "of the user")

    def test_a_disk_that_is_nearly_full_is_said_before_and_while_it_builds(self):
        self.repository({}, commits=2)
        place = self.folder / "out"
        place.mkdir()
        if os.geteuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=230m", "tmpfs", place], capture_output=True).returncode != 0:
            self.skipTest("only root mounts a small disk")
        try:
            for fills in ("head -c 100000000 /dev/zero >big; sleep 100", "true"):
                ended = self.history("--build", fills, commits="HEAD~1..HEAD", expect=2)
                self.assertRegex(ended.err, r"MB are left on this disk; a build needs 200")
            next(place.glob("checkouts/*/big")).unlink()
            self.history(commits="HEAD~1..HEAD")
        finally:
            subprocess.run(["umount", place], check=True)

    def test_hooks_of_the_repository_are_not_started(self):
        self.repository({}, commits=2)
        for name in ("post-checkout", "reference-transaction", "post-index-change"):
            hook = self.folder / "repo" / ".git" / "hooks" / name
            hook.parent.mkdir(exist_ok=True)
            hook.write_text(f"#!/bin/sh\ntouch {self.folder}/started\n")
            hook.chmod(0o755)
        git(self.folder / "repo", "config", "core.fsmonitor", f"touch {self.folder}/started")
        self.history(commits="HEAD~1..HEAD")
        self.assertFalse((self.folder / "started").exists())

    def test_programs_that_the_configuration_names_are_not_started(self):
        """A signature to be shown, a filter, a pager, an editor of diffs, an include: whatever git would start for it."""
        self.repository({}, commits=2)
        repo = self.folder / "repo"
        start = self.folder / "start.sh"
        start.write_text(f"#!/bin/sh\ntouch {self.folder}/started\nexit 1\n")
        start.chmod(0o755)
        (repo / ".gitattributes").write_text("* filter=mine diff=mine\n")
        git(repo, "add", ".gitattributes")
        git(repo, "commit", "-q", "-m", "change 2")
        signed = f"tree {git(repo, 'rev-parse', 'HEAD^{tree}')}\nparent {git(repo, 'rev-parse', 'HEAD')}\nauthor a <a@x> 1778400000 +0000\ncommitter a <a@x> 1778400000 +0000\n" \
                 "gpgsig -----BEGIN PGP SIGNATURE-----\n \n x\n -----END PGP SIGNATURE-----\n\nsigned\n"
        (self.folder / "commit").write_text(signed)
        git(repo, "update-ref", "refs/heads/main", git(repo, "hash-object", "-t", "commit", "-w", "--literally", self.folder / "commit"))
        more = self.folder / "more.config"
        more.write_text(f"[core]\n\tfsmonitor = {start}\n\tsshCommand = {start}\n\tpager = {start}\n[diff]\n\texternal = {start}\n")
        for key, value in [("log.showSignature", "true"), ("gpg.program", start), ("filter.mine.smudge", start), ("filter.mine.process", start),
                           ("filter.mine.required", "true"), ("include.path", more), ("diff.mine.command", start), ("core.alternateRefsCommand", start),
                           ("pager.log", start), ("uploadpack.packObjectsHook", start), ("remote.origin.url", f"ext::{start}"),
                           ("remote.origin.uploadpack", start), ("protocol.ext.allow", "always")]:
            git(repo, "config", key, str(value))
        hook = {"GIT_CONFIG_COUNT": "1", "GIT_CONFIG_KEY_0": "core.fsmonitor", "GIT_CONFIG_VALUE_0": str(start), "GIT_EXTERNAL_DIFF": str(start)}
        self.history(commits="HEAD~2..HEAD", env=os.environ | hook)
        self.assertFalse((self.folder / "started").exists())

    def test_a_commit_of_which_objects_are_missing_is_a_gap(self):
        made = self.repository({1: [("RELAXATION = 1.0", "RELAXATION = 0.99")]}, commits=3)
        repo = self.folder / "repo"
        lost = git(repo, "rev-parse", f"{made[1]}:notes")
        (repo / ".git/objects" / lost[:2] / lost[2:]).unlink()
        git(repo, "config", "extensions.partialClone", "origin")
        git(repo, "config", "core.repositoryFormatVersion", "1")
        git(repo, "config", "remote.origin.url", f"ext::touch {self.folder}/started")
        git(repo, "config", "remote.origin.promisor", "true")
        git(repo, "config", "protocol.ext.allow", "always")
        answer = self.found(commits="HEAD~2..HEAD", expect=1)  # a value changed in or after the gap
        gaps = {row["subject"]: row["gap"] for row in rows_of(answer, "builds") if row["gap"]}
        self.assertEqual(list(gaps), ["change 1"])
        self.assertIn("git cannot check it out", gaps["change 1"])
        self.assertFalse((self.folder / "started").exists())

    def test_a_commit_that_is_missing_is_a_gap_and_so_is_one_without_its_tree(self):
        made = self.repository({}, commits=5)
        repo = self.folder / "repo"
        for lost in (made[2], git(repo, "rev-parse", f"{made[3]}^{{tree}}")):
            (repo / ".git/objects" / lost[:2] / lost[2:]).unlink()
        answer = self.found(commits=f"{made[0]}..{made[4]}", expect=3)
        self.assertEqual([row["subject"] for row in rows_of(answer, "builds")],
                         ["change 0", "a commit that is missing", "change 3", "change 4"])
        gaps = {row["subject"]: row["gap"] for row in rows_of(answer, "builds") if row["gap"]}
        self.assertEqual(list(gaps), ["a commit that is missing", "change 3"])

    def test_a_program_that_only_the_store_names_is_not_started(self):
        self.repository({0: [("# START", f"open({str(self.folder / 'started')!r}, 'a').write('x')")]}, commits=2)
        self.history(commits="HEAD~1..HEAD")
        (self.folder / "started").unlink()
        self.taut("history", "./study.toml", "--out", "out")
        self.assertFalse((self.folder / "started").exists())


class Builds(Repository):
    def test_builds_that_are_named_are_in_the_order_of_their_times(self):
        for build, relaxation in [("1.1@2026-03-01", "0.97"), ("1.0@2026-01-01", "1.0"), ("1.2@2026-06-01T10:00:00Z", "0.97")]:
            text = TOY.replace("RELAXATION = 1.0", f"RELAXATION = {relaxation}")
            (self.folder / "mine.py").write_text(text)
            shutil.copy(SDK / "taut_solver.py", self.folder)
            self.study(solvers=["mine:cmd='python3 mine.py'"])
            self.taut("run", "./study.toml", "--build-id", build, "--out", "out")
        answer = self.answer("history", "./study.toml", "--out", "out")
        self.assertEqual([row["build"] for row in rows_of(answer, "builds")], ["1.0", "1.1", "1.2"])
        self.assertEqual(list(self.stepped(answer)), ["1.1"])
        with sqlite3.connect(self.folder / "out" / "results.db") as store:
            values = store.execute("select build, value from history where metric = 'stretch.rms' order by made").fetchall()
            current = store.execute("select distinct build from results where study = 'study'").fetchall()
        self.assertEqual([build for build, _ in values], ["1.0", "1.1", "1.2"])
        self.assertEqual(values[1][1], values[2][1])
        self.assertEqual(current, [("1.2",)])
        page = self.taut("report", "./study.toml", "--out", "out", "--no-media", "--json", env=os.environ | {"TAUT_BUILD_ID": "1.2"})
        history = json.loads(page.out)["history"][0]
        self.assertEqual([build["id"] for build in history["builds"]], ["1.0", "1.1", "1.2"])
        step = history["rows"][0]["steps"][0]
        self.assertEqual((step["at"], step["before"], step["now"]), (1, "1.0", "1.1"))
        self.assertTrue(any(value["value"] == "stretch.rms" for value in step["values"]))

    def test_the_build_stands_in_place_of_where_the_program_lies(self):
        keys = []
        for place in ("one", "two"):
            (self.folder / place).mkdir()
            for name, text in [("mine.py", TOY), ("taut_solver.py", (SDK / "taut_solver.py").read_text())]:
                (self.folder / place / name).write_text(text)
            self.study(solvers=[f"mine:cmd='python3 {self.folder}/{place}/mine.py'"])
            ran = self.taut("run", "./study.toml", "--build-id", "7", "--out", "out")
            keys.append(self.keys("out"))
            self.assertEqual("(1 were stored already)" in ran.err, place == "two", ran.err)
        self.assertEqual(keys[0], keys[1])
        self.taut("run", "./study.toml", "--build-id", "8", "--out", "out")
        self.assertEqual(len(self.keys("out")), 2)

    def test_builds_of_taut_share_what_nothing_changed(self):
        for commit in ("a" * 40 + "@2026-01-01", "b" * 40 + "@2026-02-01"):
            self.taut("run", "./study.toml", "--out", "out", env=os.environ | {"TAUT_COMMIT": commit})
        answer = self.answer("history", "./study.toml", "--out", "out")
        self.assertEqual([(row["build"], row["shared"]) for row in rows_of(answer, "builds")], [("a" * 10, 0), ("b" * 10, 1)])
        self.assertEqual(rows_of(answer, "steps"), [])
        self.assertEqual(len(self.keys("out")), 1)

    def test_builds_without_a_result_are_exit_3_and_without_anything_4(self):
        self.assertIn("4", str(self.taut("history", "./study.toml", "--out", "out", expect=4).returncode))
        for commit in "ab":
            self.taut("run", "./study.toml", "--out", "out", env=os.environ | {"TAUT_COMMIT": commit})
        self.taut("history", "./study.toml", "--out", "out", expect=0)
        with sqlite3.connect(self.folder / "out" / "results.db") as store:
            store.execute("insert into ran select study, build, 'small other', '0' from ran")
        self.taut("history", "./study.toml", "--out", "out", expect=3)

    def test_names_that_are_none(self):
        for build in ("", "a b", "a@yesterday", "it's", "a@2026-13-45x", "x" * 200):
            self.assertIn("build", self.taut("run", "./study.toml", f"--build-id={build}", "--out", "out", expect=2 if build else None).err)

    def test_a_step_does_not_rest_on_what_is_damaged(self):
        for build, relaxation in [("1", "1.0"), ("2", "0.9")]:
            (self.folder / "mine.py").write_text(TOY.replace("RELAXATION = 1.0", f"RELAXATION = {relaxation}"))
            shutil.copy(SDK / "taut_solver.py", self.folder)
            self.study(solvers=["mine:cmd='python3 mine.py'"])
            self.taut("run", "./study.toml", "--build-id", build, "--out", "out")
        self.assertEqual(list(self.stepped(self.answer("history", "./study.toml", "--out", "out", expect=1))), ["2"])
        with sqlite3.connect(self.folder / "out" / "results.db") as store:
            store.execute("update numbers set value = value * 1.5 where case_id = (select max(case_id) from cases)")
        ended = self.taut("history", "./study.toml", "--out", "out", "--json", expect=0)
        self.assertEqual(rows_of(json.loads(ended.out), "steps"), [])
        self.assertIn("does not match its digest", ended.err)

    def test_the_figure(self):
        for commit in "ab":
            self.taut("run", "./study.toml", "--out", "out", env=os.environ | {"TAUT_COMMIT": commit})
        self.taut("history", "./study.toml", "--out", "out", "--plot", "drawn.svg")
        self.assertIn("jakobsen", (self.folder / "drawn.csv").read_text())
        self.assertTrue((self.folder / "drawn.svg").read_text().rstrip().endswith("</svg>"))

    def test_a_thousand_builds_of_sixty_cases_in_seconds(self):
        builds, cases, values = 1000, 60, 30
        self.taut("run", "./study.toml", "--out", "out")
        with sqlite3.connect(self.folder / "out" / "results.db") as store:
            columns = [row[1] for row in store.execute("pragma table_info(cases)") if row[1] not in ("case_id", "key", "id", "result_digest")]
            record = dict(zip(columns, store.execute(f"select {', '.join(columns)} from cases").fetchone(), strict=True))
            names = [row[0] for row in store.execute("select metric_id from metrics limit ?", [values])]
            store.execute("delete from builds")
            store.execute("delete from ran")
            every = [(b, c, b * cases + c + 10) for b in range(builds) for c in range(cases)]
            store.executemany("insert into builds values ('study', ?, ?, ?, '', '', '')",
                              [(f"{b:040x}", f"2026-01-01T{b // 60:02d}:{b % 60:02d}:00Z", b) for b in range(builds)])
            marks = ", ".join("?" * (len(columns) + 4))
            store.executemany(f"insert into cases (case_id, key, id, result_digest, {', '.join(columns)}) values ({marks})",
                              [(n, f"{n:064x}", f"small s{c}", f"{n:064x}", *record.values()) for _, c, n in every])
            store.executemany("insert into ran values ('study', ?, ?, ?)", [(f"{b:040x}", f"small s{c}", f"{n:064x}") for b, c, n in every])
            store.executemany("insert into numbers values (?, ?, ?)", [(n, m, 1.0 + c) for _, c, n in every for m in names])
        store.close()
        best = 99.0
        for _ in range(3):  # CPU time, as other tests run at the same time
            start = os.times()
            ended = self.taut("history", "./study.toml", "--out", "out")
            end = os.times()
            best = min(best, end.children_user + end.children_system - start.children_user - start.children_system)
        self.assertIn("1000", ended.out)
        print(f"{builds} builds of {cases} cases with {values} values: {best:.2f} s", file=sys.stderr)
        self.assertLess(best, 6, "s of CPU; 2.5 to 2.7 on a slow core")


class Kept(CommandLine):
    """check --speed and bench --against"""

    def setUp(self):
        super().setUp()
        self.study(rest="[axes]\niterations = [4, 8]\n")

    def slow_build(self):
        """A program that runs every sample of taut's workers and reports twice the time."""
        folder = self.folder / "slow"
        folder.mkdir()
        program = folder / "taut"
        program.write_text(f"""#!{sys.executable}
import subprocess, sys
worker = subprocess.Popen([{str(BINARIES / "taut")!r}, *sys.argv[1:]], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
print(worker.stdout.readline(), end="", flush=True)
for line in sys.stdin:
    worker.stdin.write(line)
    worker.stdin.flush()
    said = worker.stdout.readline()
    if line.split()[0] in ("time", "pilot_run"):
        said = " ".join(str(FACTOR * float(word)) for word in said.split()) + "\\n"
    print(said, end="", flush=True)
""".replace("FACTOR", "0.5"))
        program.chmod(0o755)
        return folder

    def test_a_build_that_was_faster_is_exit_1_and_the_same_one_is_not(self):
        faster = self.slow_build()
        ended = self.taut("bench", "./study.toml", "--against", faster, "--json", "--out", "out", expect=1)
        rows = rows_of(json.loads(ended.out), "against")
        self.assertEqual(len(rows), 2)
        for row in rows:
            self.assertGreater(row["ratio"][1], 1.6)
            self.assertIn("dearer", row["verdict"])
        self.taut("bench", "--keep-build", "before", "--out", "out")
        ended = self.taut("bench", "./study.toml", "--against", "before", "--json", "--out", "out")
        for row in rows_of(json.loads(ended.out), "against"):
            self.assertNotIn("dearer", row["verdict"])

    def test_check_times_beside_the_kept_build(self):
        self.taut("baseline", "update", "./study.toml", "--why", "first", "--baselines", "kept", "--out", "out")
        self.assertIn("none is kept in", self.taut("check", "./study.toml", "--baselines", "kept", "--out", "out", "--speed",
                                                            expect=2).err)
        self.taut("bench", "--keep-build", "before", "--out", "out")
        answer = self.answer("check", "./study.toml", "--baselines", "kept", "--out", "out", "--speed")
        self.assertEqual(len(rows_of(answer, "speed")), 2)
        self.taut("check", "./study.toml", "--baselines", "kept", "--out", "out", "--speed", "--against", self.slow_build(), expect=1)
        self.taut("check", "./study.toml", "--baselines", "kept", "--out", "out")  # values alone have not changed


if __name__ == "__main__":
    main()
