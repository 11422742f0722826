#!/usr/bin/env python3
"""`taut frontier --all` and `taut verify --assertions`: what they print and keep, and that they fail on a narrower frontier
and on another verdict. Performance profiles, compared with counts that other code makes from a session's raw samples."""

import csv
import json
import math
import pathlib
import shlex
import statistics

import stored
from command_line import CommandLine, facts_of, main, rows_of

PARAMETERS = ["time step", "sweeps", "stiffness", "mass ratio", "resolution", "speed of a collider", "size, up", "size, down",
         "distance from the origin", "bending", "wind"]
SYMPTOMS = {"NaN", "explodes", "crashes", "refuses", "tunnels", "overstretches", "freezes", "gains energy", "jitters",
            "asymmetric", "loses energy"}


class AllFrontiers(CommandLine):
    SOLVER = "xpbd:substeps=2"  # cheap

    def all(self, *words, expect=0):
        return self.taut("frontier", "--all", self.SOLVER, "--baselines", "kept", *words, expect=expect)

    def edit(self, change):
        file, = (self.folder / "kept/frontiers").iterdir()
        answer = json.loads(file.read_text())
        table = answer["tables"]["parameters"]
        rows = rows_of(answer, "parameters")
        change({row["parameter"]: row for row in rows})
        table["rows"] = [[row[column["name"]] for column in table["columns"]] for row in rows]
        file.write_text(json.dumps(answer))

    def test_every_parameter_has_its_frontier_and_a_narrower_one_is_red(self):
        self.assertIn("xpbd:substeps=2: no baseline kept/frontiers/", self.all("--check", expect=4).err)
        answer = json.loads(self.all("--json", "--update").out)
        found, beyond = rows_of(answer, "parameters"), rows_of(answer, "beyond")
        self.assertEqual([one["parameter"] for one in found], PARAMETERS)
        answered = [one for one in found if not one["lacks"]]
        self.assertGreaterEqual(len(answered), 8)
        for one in answered:
            self.assertEqual(one["downwards"], one["to"] < one["from"], one)
            if one["bad"] is None:
                self.assertEqual((one["good"], one["symptom"]), (one["to"], ""))
                continue
            self.assertTrue(set(one["symptom"].split(", ")) <= SYMPTOMS, one)
            gap = max(one["good"], one["bad"]) / min(one["good"], one["bad"]) - 1
            whole = one["parameter"] in ("sweeps", "resolution") and abs(one["good"] - one["bad"]) == 1
            self.assertTrue(gap < 0.021 or whole, one)
        # The case beyond a frontier shows the reported symptom.
        over = next(one for one in answered if "overstretches" in one["symptom"])
        sets = [word for one in beyond if one["parameter"] == over["parameter"] for word in ("--set", one["scene_setting"])]
        values = json.loads(self.taut("case", over["beyond_scene"], over["beyond_solver"], *sets, "--json").out)["values"]
        self.assertGreater(values["stretch.max"], 1)

        text = self.all("--check")
        self.assertRegex(text.err, f"{len(PARAMETERS)} frontiers compared with kept/frontiers/.*: 0 differ")
        commands = [one["command"] for one in rows_of(answer, "commands")]
        self.assertEqual(len(commands), sum(one["bad"] is not None for one in answered))
        self.assertEqual(shlex.split(commands[0])[:3], ["taut", "case", "swing"])
        for command in commands:
            self.assertIn(command, text.out)
        self.assertIn("<svg", (self.folder / facts_of(answer)["picture"]).read_text())

        # The report shows this, and the findings of `require`.
        required = self.answer("require", "./small.toml")
        study = self.study()
        self.taut("run", study)
        model = json.loads(self.taut("report", study, "--json").out)
        tables = {name: table["rows"] for name, table in model["tables"].items()}
        self.assertEqual(model["limits"]["tables"], ["required", "frontiers"])
        self.assertEqual([row[0] for row in tables["frontiers"]], PARAMETERS)
        for one, row in zip(found, tables["frontiers"]):
            self.assertIn(one["lacks"] or one["symptom"] or "the end of the range", row[1])
        (row,) = tables["required"]
        self.assertEqual(row[0], "small")
        for effect in rows_of(required, "effects"):
            if not effect["name"].startswith("("):
                self.assertIn(effect["name"], row[4] if effect["verdict"] == "drop" else row[5])

        self.edit(lambda rows: rows["time step"].update(bad=1.2 * rows["time step"]["bad"]))
        self.assertRegex(self.all("--check", expect=1).err, r"xpbd:substeps=2, time step: bad \S+ -> ")
        self.all("--update")
        self.edit(lambda rows: rows["wind"].update(symptom="freezes"))
        self.assertRegex(self.all("--check", expect=1).err, "wind: symptom freezes -> ")
        self.all("--update")
        self.edit(lambda rows: rows["wind"].update(parameter="breeze"))
        said = self.all("--check", expect=4).err
        self.assertIn("breeze is gone", said)
        self.assertIn("wind is not in the baseline", said)
        file, = (self.folder / "kept/frontiers").iterdir()
        file.write_text("{\n")
        self.assertIn(f"{file.name}: is not JSON", self.all("--check", expect=2).err)

    def test_bad_input_runs_nothing(self):
        for words in (["nobody"], ["jakobsen", "jakobsen"], ["jakobsen", "bullet", "xpbd"]):
            self.taut("frontier", "--all", *words, expect=2)
        self.taut("frontier", "hang", "jakobsen", "--check", expect=2)
        self.taut("frontier", "hang", expect=2)
        self.assertEqual(self.keys(), [])


class OneFrontier(CommandLine):
    """Theory counts growth at any pace. A short run sees only fast growth, so its bracket lies above the theory."""

    def test_theory_is_inside_the_bracket_or_as_far_off_as_its_nearer_end(self):
        for seconds in (16, 0.1):
            facts = self.answer("frontier", "chain", "mass-spring:substeps=1", "--duration", seconds, "--from", 0.003, "--to", 0.006)["facts"]
            theory, stable, unstable = (facts[name]["value"] for name in ("theory", "stable", "unstable"))
            said = facts["theory"]["note"].partition(":")[0]
            if seconds == 16:
                self.assertTrue(stable <= theory <= unstable, facts)
                self.assertEqual(said, "inside the bracket")
            else:
                self.assertLess(theory, stable)
                self.assertEqual(said, f"measured +{100 * (stable / theory - 1):.2g} % from it")


class Assertions(CommandLine):
    def test_a_verdict_that_changes_is_red(self):
        kept = pathlib.Path(__file__).parents[2] / "results/baselines/assertions.json"
        answer = json.loads(kept.read_text())
        rows = rows_of(answer, "assertions")
        listed = self.answer("list", "assertions")
        self.assertEqual([(c["name"], c["summary"], c["verdict"]) for c in rows_of(listed, "assertions")],
                         [(c["section"], c["assertion"], c["verdict"]) for c in rows])
        names = [column["name"] for column in answer["tables"]["assertions"]["columns"]]
        answer["tables"]["assertions"]["rows"][4][names.index("verdict")] = "does not hold"
        (self.folder / "kept").mkdir()
        (self.folder / "kept/assertions.json").write_text(json.dumps(answer))
        said = self.taut("verify", "--assertions", "--baselines", "kept", expect=1)
        self.assertIn(f'{rows[4]["assertion"]}: verdict does not hold -> ', said.err)
        self.assertIn("1 changed", said.err)
        self.taut("verify", "--update", expect=2)
        self.taut("verify", "--assertions", "--section", "8", "--update", expect=2)


class Profiles(CommandLine):
    LEVELS = [0.5, 0.2, 0.1, 0.05, 0.02, 0.01]

    def shares(self):
        results = self.folder / "results/runs"
        ratios, scenes = {}, {}
        for row in stored.query(results, "SELECT * FROM timings JOIN benches USING (bench_id) ORDER BY timing_id"):
            (solver, dt, status), = [tuple(r) for r in stored.query(results, "SELECT solver, dt, status FROM cases WHERE key = ?", row["key"])]
            of = dict(stored.query(results, "SELECT metric, value FROM results WHERE key = ?", row["key"]))
            error = None
            if of.get("motion.error") is not None:
                error = max(of["motion.error"], abs(of["stretch.rms"] - (of.get("motion.strain") or 0)), 3 * of["motion.floor"])
            samples = [cpu for cpu, in stored.query(results, "SELECT cpu FROM samples WHERE timing_id = ?", row["timing_id"])]
            fine = status in ("ok", "unsettled") and not row["failure"] and error is not None
            ratios[solver] = []
            scenes.setdefault(row["scene"], {}).setdefault(solver, []).append((statistics.median(samples) / dt, error if fine else math.inf))
        for tried in scenes.values():
            fewest = min(map(len, tried.values()))
            for solver, all_of in tried.items():
                places = [k * (len(all_of) - 1) // (fewest - 1) for k in range(fewest)] if fewest > 1 else [0]
                tried[solver] = [all_of[k] for k in places]
            for level in self.LEVELS:
                price = {solver: min((cost for cost, error in tried.get(solver, []) if error <= level), default=math.inf)
                         for solver in ratios}
                if min(price.values()) < math.inf:
                    for solver in ratios:
                        ratios[solver].append(price[solver] / min(price.values()))
        return ratios

    def test_plot_and_page_show_what_the_raw_samples_give(self):
        study = self.study(scenes=["swing:links.shear=false"], solvers=["jakobsen", "bullet"], rest="[axes]\niterations = [1, 4, 16, 64]\n")
        self.taut("bench", study)
        # Set the costs arbitrarily, and let the accurate settings of Bullet fail to be timed.
        results = self.folder / "results/runs"
        for place, row in enumerate(stored.query(results, "SELECT timing_id, solver FROM timings JOIN cases USING (key) ORDER BY timing_id")):
            bullet = row["solver"] == "bullet"
            stored.change(results, "UPDATE samples SET cpu = ? WHERE timing_id = ?",
                          (1 + place % 4) * (3e-6 if bullet and place % 4 else 4e-6), row["timing_id"])
            if bullet and place % 4 > 0:  # the others reach no small error
                stored.change(results, "UPDATE timings SET failure = 'no clock' WHERE timing_id = ?", row["timing_id"])
        stored.seal_benches(results)
        ratios = self.shares()
        self.assertGreaterEqual(len(next(iter(ratios.values()))), 2)
        self.assertTrue(any(math.isinf(r) for of in ratios.values() for r in of), "a failure")
        self.taut("plot", study, "--kind", "profile", "-o", "figures")
        rows = list(csv.DictReader(next((self.folder / "figures").glob("*.csv")).read_text().splitlines()))
        self.assertEqual({row["solver"] for row in rows}, set(ratios))
        for row in rows:
            of = ratios[row["solver"]]
            within = sum(r <= float(row["factor"]) * (1 + 1e-9) for r in of) / len(of)
            self.assertAlmostEqual(float(row["share"]), within, 12, row)
        self.taut("run", study)
        model = json.loads(self.taut("report", study, "--json").out)
        table = model["tables"]["cost-profiles"]
        titles = [column["heading"] for column in table["columns"][1:-1]]
        factors = [1.0 if title == "the cheapest" else float(title.split()[1]) for title in titles]
        titles = {"jakobsen": "Jakobsen", "bullet": "Bullet"}
        for solver, of in ratios.items():
            row = next(row for row in table["rows"] if row[0].startswith(titles[solver]))
            for factor, cell in zip(factors + [1e300], row[1:]):
                self.assertAlmostEqual(cell, sum(r <= factor * (1 + 1e-9) for r in of) / len(of), 12, msg=(table, of))


if __name__ == "__main__":
    main()
