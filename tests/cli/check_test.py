#!/usr/bin/env python3
"""Regressions: a baseline passes only against the study that made it; otherwise the check reports what moved."""

import json
import re
import shlex
import xml.etree.ElementTree

from command_line import SCENE, CommandLine, main, rows_of


class Check(CommandLine):
    def setUp(self):
        super().setUp()
        self.study(solvers=["jakobsen", "bullet"], rest="[axes]\niterations = [1, 4]\n")
        self.baseline = self.folder / "results/baselines/study"

    def update(self, why="the first one"):
        return self.taut("baseline", "update", "./study.toml", "--why", why)

    def check(self, expect, *more):
        return self.taut("check", "./study.toml", *more, expect=expect).out

    def edit(self, solver, change):
        """Passes the rows of one solver's baseline through `change`."""
        file = self.baseline / f"{solver}.jsonl"
        rows = change([json.loads(line) for line in file.read_text().splitlines()])
        file.write_text("".join(json.dumps(row) + "\n" for row in rows))

    def files(self):
        return {file.name: (file.read_bytes(), file.stat().st_mtime_ns) for file in self.baseline.iterdir()}

    def test_nothing_compared_never_passes(self):
        self.assertIn("nothing to compare with", self.check(4))
        self.assertIn("nothing to compare with", self.taut("check", expect=4).out)
        self.assertFalse((self.folder / "results").exists(), "nothing is run or written")
        self.update()
        self.assertIn("nothing to compare with", self.check(4, "--baselines", "elsewhere"))

    def test_the_same_run_passes_and_an_update_then_writes_nothing(self):
        self.update()
        for _ in range(2):
            self.assertRegex(self.check(0), r"study +passed +4 +\d+ +0 +0")
        before = self.files()
        self.assertIn("nothing was written", self.update().out)
        self.assertEqual(self.files(), before)
        self.taut("baseline", "diff", "./study.toml")

    def test_an_update_needs_a_reason(self):
        self.taut("baseline", "update", "./study.toml", expect=2)
        self.taut("baseline", "update", "./study.toml", "--why", " ", expect=2)
        self.assertFalse(self.baseline.exists())
        self.update("gravity was wrong")
        self.assertIn("- gravity was wrong (4 cases)", (self.baseline / "why.md").read_text())

    def test_a_moved_value_is_named_with_the_command_that_reproduces_it(self):
        self.update()

        def plant(rows):
            rows[0]["values"]["stretch.max"] *= 1.5
            return rows
        self.edit("jakobsen", plant)
        out = self.check(1, "--junit", "check.xml", "--all")
        self.assertRegex(out, r"value moved +small \S+ +stretch.max \S+ -> \S+ \(by \S+, allowed \S+\) +taut case")
        self.assertRegex(out, r"jakobsen +other values +1 +1 +0 +\./small\.toml stretch\.max, \S+ -> \S+ % +-33.3")
        self.assertLess(out.index("allowed"), out.index("-33.3"), "all in all last, where it is read")
        said = json.loads(self.check(1, "--json"))
        self.assertEqual([(m["value"], m["cases"], m["less"]) for m in rows_of(said, "moved")], [("other values", 1, 1)])
        change, = rows_of(said, "findings")
        self.assertEqual(change["value"], "stretch.max")
        self.assertAlmostEqual(change["before"] / change["now"], 1.5, 6)
        self.taut(*shlex.split(change["command"])[1:])
        suites = xml.etree.ElementTree.parse(self.folder / "check.xml").getroot()
        self.assertEqual([suites[0].get("tests"), suites[0].get("failures")], ["4", "1"])
        self.taut("baseline", "diff", "./study.toml", expect=1)
        bullet = self.files()["bullet.jsonl"]
        self.update("the plant is pulled out")
        self.check(0)
        self.assertEqual(self.files()["bullet.jsonl"], bullet, "only rows that moved are written")

    def test_what_moved_is_counted_judged_and_led_by_the_worst(self):
        self.update()

        def scale(*factors):
            def plant(rows):
                for row, by in zip(rows, factors):
                    row["values"] |= {name: by * row["values"][name] for name in ("stretch.rms", "energy.kinetic")}
                return rows
            return plant
        self.edit("jakobsen", scale(2, 1.25))  # now smaller: better
        self.edit("bullet", scale(0.25, 1))    # now four times as large
        out = self.check(1)
        self.assertLessEqual(len(out.splitlines()), 25)
        row = r"%s +%s +2 +%d +%d +\./small\.toml, (\S+) -> (\S+) %% +%s +%s\n"
        self.assertRegex(out, row % ("jakobsen", "RMS stretch", 2, 0, r"\S+", "less is better"))
        before, now = map(float, re.search((row % ("bullet", "RMS stretch", 0, 1, "300", "less is better")).replace(" +2 ", " +1 "), out).groups())
        self.assertAlmostEqual(now / before, 4, delta=0.05)
        self.assertRegex(out, r"other values +2 +2 +0 .*energy\.kinetic")
        self.assertRegex(out, r"study +moved +4 +\d+ +6 ")
        self.assertIn('taut baseline update ./study.toml --why "..."', out)
        changes = [abs(m["relative"]) for m in rows_of(json.loads(self.check(1, "--json")), "moved")]
        self.assertEqual(changes, sorted(changes, reverse=True), "the largest change first")
        self.edit("bullet", lambda rows: rows[:1] + [rows[1] | {"status": "exploded", "reason": "energy"}])
        out = self.check(1)
        self.assertLess(out.index("exploded (energy) -> ok"), out.index("RMS stretch"), "no change of a value is worse than a status")
        moved = {(m["solver"], m["value"]): m for m in rows_of(json.loads(self.check(1, "--json")), "moved")}
        self.assertEqual({key: (m["cases"], m["less"], m["more"]) for key, m in moved.items()},
                         {("bullet", "status"): (1, None, None), ("bullet", "RMS stretch"): (1, 0, 1), ("bullet", "other values"): (1, 0, 1),
                          ("jakobsen", "RMS stretch"): (2, 2, 0), ("jakobsen", "other values"): (2, 2, 0)})

    def test_a_hundred_changes_are_told_in_twenty_five_lines(self):
        self.study(solvers=["jakobsen", "bullet", "xpbd", "mass-spring"], rest="[axes]\niterations = [1, 2, 3, 4]\n"
                   "'cloth.grid' = [[3, 3], [4, 4], [5, 5]]\n")
        self.update()
        for solver in ("jakobsen", "bullet", "xpbd", "mass-spring"):
            if (self.baseline / f"{solver}.jsonl").exists():
                self.edit(solver, lambda rows: [row | {"values": {k: v and 2 * v for k, v in row["values"].items()}} for row in rows[1:]])
        out = self.check(1)
        self.assertLessEqual(len(out.splitlines()), 25, out)
        self.assertRegex(out, r"jakobsen +case new +1 ")
        self.assertGreater(len(self.check(1, "--all").splitlines()), 100)

    def test_a_change_of_status_is_a_regression(self):
        self.update()
        self.edit("bullet", lambda rows: [rows[0] | {"status": "exploded", "reason": "energy"}] + rows[1:])
        self.assertIn("status exploded (energy) -> ok", self.check(1))

    def test_a_baseline_that_does_not_match_the_study_exits_4(self):
        self.update()
        self.edit("bullet", lambda rows: rows[1:])
        self.assertIn("new: the baseline does not have this case", self.check(4))
        self.update("complete again")
        self.edit("bullet", lambda rows: [rows[0] | {"id": "another name"}] + rows[1:])
        self.assertIn("renamed: the baseline calls it 'another name'", self.check(4))
        self.update("complete again")
        self.study(solvers=["jakobsen", "bullet"], rest="[axes]\niterations = [1]\n")
        self.assertIn("missing: the study does not have this case", self.check(4))
        self.study(solvers=["jakobsen"], rest="[axes]\niterations = [1, 4]\n")
        self.assertRegex(self.check(4), r"bullet +solver missing +1 +solver bullet +the baseline has this solver")
        self.update("one solver less")
        self.assertFalse((self.baseline / "bullet.jsonl").exists())
        (self.folder / "small.toml").write_text(SCENE.replace("mass = 0.1", "mass = 0.2"))
        self.assertIn("the scene changed", self.check(4))

    FRONTIER = """
[[frontier]]
scene = "./small.toml"
solver = "mass-spring:substeps=1"
of = "dt"
from = 0.0001
to = 0.5
tolerance = 0.1
"""

    def with_frontier(self):
        self.baseline.mkdir(parents=True)
        (self.baseline / "frontiers.toml").write_text(self.FRONTIER)
        self.update()

    def test_a_frontier_that_moves_is_a_regression_though_every_case_passes(self):
        self.with_frontier()
        self.assertRegex(self.check(0), r"study +passed +5 ")

        def plant(rows):
            rows[0]["values"]["frontier.unstable"] *= 1.2
            return rows
        self.edit("mass-spring", plant)
        change, = rows_of(json.loads(self.check(1, "--json")), "findings")
        self.assertRegex(change["case"] + ": " + change["change"], r"frontier of dt: frontier.unstable \S+ -> ")
        self.assertIn("unstable from", self.taut(*shlex.split(change["command"])[1:]).out)
        (self.baseline / "frontiers.toml").unlink()
        self.check(4)
        (self.baseline / "frontiers.toml").write_text(self.FRONTIER.replace("of =", "off ="))
        self.assertIn("did you mean 'of'?", self.taut("check", "./study.toml", expect=2).err)

    def test_a_baseline_of_an_earlier_taut_is_said(self):
        self.update()
        self.edit("bullet", lambda rows: [rows[0] | {"status": "exploded (energy)"}] + rows[1:])
        said = self.taut("check", "./study.toml", expect=2).err
        self.assertRegex(said, r"bullet.jsonl:1:.* is of an earlier taut: remove the file, and `taut baseline update` writes it anew")
        (self.baseline / "bullet.jsonl").unlink()
        self.update()
        self.check(0)

    def test_ten_planted_regressions_are_caught_and_a_no_op_is_green(self):
        self.with_frontier()
        self.check(0)
        sound = {file.name: file.read_text() for file in self.baseline.iterdir()}

        def value(name, change):
            def plant(rows):
                rows[0]["values"][name] = change(rows[0]["values"][name])
                return rows
            return plant

        def field(name, text):
            return lambda rows: [rows[0] | {name: text}] + rows[1:]
        plants = [
            ("a sweep converges 0.1 % slower", "jakobsen", value("stretch.max", lambda x: x * 1.001), 1),
            ("the frontier is shifted", "mass-spring", value("frontier.stable", lambda x: x / 1.1), 1),
            ("NaN at one cell", "bullet", value("stretch.rms", lambda _: None), 1),
            ("more motion at rest", "bullet", value("jitter.rms", lambda x: (x or 0) + 1e-3), 1),
            ("a value is deleted", "bullet", lambda rows: [rows[0]["values"].pop("stretch.max") and rows[0]] + rows[1:], 4),
            ("it explodes", "jakobsen", field("status", "exploded"), 1),
            ("more work for the same result", "jakobsen", field("projections", 1), 1),
            ("a case is missing", "jakobsen", lambda rows: rows[1:], 4),
            ("a case is renamed", "bullet", field("id", "another"), 4),
            ("the scene changed", "bullet", field("content", "0" * 64), 4),
            ("a solver is missing", "mass-spring", lambda _: [], 4),
        ]
        for name, solver, plant, code in plants:
            with self.subTest(name):
                self.edit(solver, plant)
                self.check(code)
                (self.baseline / f"{solver}.jsonl").write_text(sound[f"{solver}.jsonl"])
        self.check(0)

    def test_a_case_that_does_not_repeat_is_flaky_and_never_compared_by_value(self):
        self.study(solvers=["faulty:mode=random,at=3", "faulty:mode=stable"])

        def taut(*words, expect=0):
            return self.taut(*words, program="taut-faulty", expect=expect)
        said = taut("baseline", "update", "./study.toml", "--why", "the first one").err
        self.assertEqual(said.count("does not repeat bit for bit"), 1, said)
        rows = [json.loads(line) for line in (self.baseline / "faulty.jsonl").read_text().splitlines()]
        self.assertEqual(sorted(row.get("flaky", False) for row in rows), [False, True])
        for place in ("one", "two"):
            taut("check", "./study.toml", "--out", place)
        self.edit("faulty", lambda rows: [row | {"status": "exploded", "reason": "energy"} for row in rows])
        taut("check", "./study.toml", expect=1)

    def test_another_toolchain_is_said_and_fails_under_strict_env(self):
        self.update()
        (self.baseline / "toolchain.txt").write_text("an abacus\n")
        self.check(0)
        process = self.taut("check", "./study.toml", "--strict-env", expect=5)
        self.assertIn("an abacus", process.err)

    def test_a_baseline_that_cannot_be_written_prints_nothing(self):
        (self.folder / "taken").write_text("")
        refused = self.taut("baseline", "update", self.study(), "--why", "a test", "--baselines", "taken", "--json", expect=2)
        self.assertEqual(refused.out, "")
        self.assertIn("taken", refused.err)

    def test_a_damaged_baseline_is_named_by_file_and_line(self):
        self.update()
        (self.baseline / "bullet.jsonl").write_text("{\n")
        process = self.taut("check", "./study.toml", expect=2)
        self.assertIn("bullet.jsonl:1:1: not a baseline row", process.err)
        (self.baseline / "tolerances.toml").write_text("[default]\nrelativ = 1\n")
        process = self.taut("check", "./study.toml", expect=2)
        self.assertIn("did you mean 'relative'?", process.err)


if __name__ == "__main__":
    main()
