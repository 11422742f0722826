#!/usr/bin/env python3
"""Made-up results (failures that left values behind, ties, noise, a single solver, missing metrics, unequal work) go through
`taut report`, and other code recomputes every cell of the answer from the raw rows.

    answer_test.py BINARIES
"""

import collections
import csv
import json
import math
import os
import re
import sqlite3
import statistics
import subprocess
import sys
import tempfile
import unittest

TAUT = MADE_UP = ""
SEEDS = range(1, 25)
# Metric: kind of the last row, and the value as which smaller values count.
METRICS = {"stretch.rms": ("mean", 1e-3), "motion.error": ("mean", 0.01), "penetration.peak": ("largest", 1e-6),
           "face.peak": ("largest", 1e-6), "step.error": ("mean", 1e-6), "tunnelling.events": ("sum", 0)}
BUDGETS = [0.1e-3, 0.5e-3, 1e-3, 4e-3, 16e-3]
Raw = collections.namedtuple("Raw", "key scene solver work dt status values text")


def ended(status):
    return status in ("ok", "unsettled")


def raw_rows(folder):
    """Every stored case; its values include numbers that a failure left behind."""
    base = sqlite3.connect(os.path.join(folder, "results", "results.db"))
    values = collections.defaultdict(dict)
    for case, name, value in base.execute("select case_id, name, value from numbers join metrics using (metric_id)"):
        if value is not None:
            values[case][name] = value
    rows = []
    for case, key, scene, solver, parameters, dt, status, text in base.execute(
            "select case_id, key, scene, solver, parameters, dt, status, solver_text from cases order by case_id"):
        own = json.loads(parameters)
        rows.append(Raw(key, scene, solver, (int(own.get("substeps", 1)), int(own["iterations"])), dt, status, values[case], text))
    base.close()
    return rows


def timed_rows(folder):
    """Timed rows by scene, with their median cost per simulated second."""
    scenes, path = collections.defaultdict(list), os.path.join(folder, "bench.csv")
    if not os.path.exists(path):
        return scenes
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            row["cost"] = statistics.median(map(float, row["samples"].split())) / float(row["dt"])
            row["usable"] = row["stable"] == "1"
            scenes[row["scene"]].append(row)
    return scenes


# A thousandth of the diagonal of a level sheet of one metre.
DEEPEST = 1e-3 * math.sqrt(2)
LEVELS = [0.5, 0.2, 0.1, 0.05, 0.02, 0.01]
PRICED = 0.05
SOLVE_ALL = {"admm"}  # their iterations are not sweeps


def astray(row):
    """Whether a cloth with little strain does not count, since it is not where it should be."""
    return row.values.get("motion.error", 0) > LEVELS[0]


def error_of(row, metric):
    """The error of a timed case: where the cloth is and how strained, or the strain on a scene whose motion nobody judges."""
    if metric == "stretch.rms":
        return row.values.get(metric, math.nan)
    if "motion.error" not in row.values:
        return math.nan
    strain = abs(row.values["stretch.rms"] - row.values.get("motion.strain", 0)) if "stretch.rms" in row.values else 0
    return max(row.values["motion.error"], strain, 3 * row.values.get("motion.floor", 0))


def not_counted(row, metric):
    """Reasons why a case that reaches an error cannot win: limits that its scene does not accept. A plane is never passed through."""
    if metric == "stretch.rms" and astray(row):
        return ["is not where it should be"]
    limits = {"tunnelling.events": math.inf if row.scene == "plane" else 0, "penetration.peak": DEEPEST}
    if metric == "stretch.rms":
        limits["stretch.rms"] = 0.1
    return [name for name, most in limits.items() if row.values.get(name, 0) > most]


def ratio(a, b):
    """Cost of a over cost of b, as the median over blocks of two samples each."""
    sums = [[sum(map(float, row["samples"].split()[i:i + 2])) for i in range(0, 8, 2)] for row in (a, b)]
    return math.exp(statistics.median(math.log(x / y) for x, y in zip(*sums))) * float(b["dt"]) / float(a["dt"])


class Table:
    """A table of the answer: its rows by label, and the last row separately."""

    def __init__(self, json_table):
        self.columns = [c["name"] for c in json_table["columns"]][1:]
        notes = {(n["row"], n["column"]): n for n in json_table["notes"]}
        rows = []
        for i, row in enumerate(json_table["rows"]):
            rows.append((row[0], {c: (value, notes.get((i, c), {})) for c, value in zip(self.columns, row[1:])}))
        self.rows, self.last = dict(rows[:-1]), rows[-1]


class Report:
    """One made-up run: its raw results, and the answer of the program."""

    def __init__(self, seed):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([MADE_UP, folder, str(seed)], check=True)
            said = subprocess.run([TAUT, "report", os.path.join(folder, "made-up.toml"), "--out", os.path.join(folder, "results"),
                                   "--json"], check=True, capture_output=True, text=True, cwd=folder).stdout
            self.raw, self.timed = raw_rows(folder), timed_rows(folder)
            cases = {r.key: r for r in self.raw}
            self.metric = {}  # that decides, by scene
            for scene, rows in self.timed.items():
                here = [cases[row["key"]] for row in rows]
                self.metric[scene] = "motion.error" if any("motion.error" in r.values for r in here) else "stretch.rms"
                for row, case in zip(rows, here):
                    row["error"] = error_of(case, self.metric[scene])
                    row["usable"] = row["usable"] and not math.isnan(row["error"])
                    row["uncounted"] = not_counted(case, self.metric[scene]) if row["usable"] else []
                    row["usable"] = row["usable"] and not row["uncounted"]
        self.model = json.loads(said)
        self.tables = {name: Table(t) for name, t in self.model["answer"]["tables"].items()}
        self.solvers = list(dict.fromkeys(r.solver for r in self.raw))
        self.works = self.compared_works()

    def compared_works(self):
        """Work at which each solver is compared: the common work nearest to 1 x 16. Without a common work it is each solver's most
        frequent one with the common number of sweeps nearest to 16."""
        own = {s: collections.Counter(r.work for r in self.raw if r.solver == s) for s in self.solvers}

        def far(work):
            return abs(math.log(max(1, work[1]) / 16)) + math.log(max(1, work[0]))
        common = set.intersection(*(set(w) for w in own.values()))
        if common:
            return {s: min(common, key=far) for s in self.solvers}
        sweeps = set.intersection(*({w[1] for w in works} for works in own.values()))
        best = min(sweeps, key=lambda n: far((1, n)))
        return {s: max((w for w in own[s] if w[1] == best), key=lambda w: (own[s][w], -far(w))) for s in self.solvers}

    def compared(self, scene):
        """The case of each solver at the time step that most solvers ran; of equal ones, at the step nearest to 1/64 s."""
        at = collections.defaultdict(dict)
        for r in self.raw:
            if r.scene == scene and r.work == self.works[r.solver]:
                at[r.dt].setdefault(r.solver, r)
        return at[min(at, key=lambda dt: (-len(at[dt]), abs(math.log(dt * 64))))] if at else {}


def why_none(row):
    if row is None:
        return "not run"
    if ended(row.status):
        return "no value"
    return "cannot: made up" if row.status == "unsupported" else row.status


class Still(float):
    """A strain of cloth that is not where it should be: shown but not compared."""


def compared(value):
    return not isinstance(value, (str, Still))


def best_of(values, nothing):
    """The solver whose value is smaller than all others by more than a twentieth; None if there is no such solver."""
    ranked = sorted((max(v, nothing), s) for s, v in values.items())
    if len(ranked) < 2:
        return None
    (a, first), (b, _) = ranked[:2]
    return first if max(a, b) > 1.05 * min(a, b) else None


class Answer(unittest.TestCase):
    seen = collections.Counter()

    def one(self, table, name, cells, last, label, marks):
        """Compares a table with its expected cells {row: {solver: value or text}}, its last row and its marks."""
        self.assertEqual(set(table.rows), set(cells), name)
        for row, values in list(cells.items()) + [(None, last)]:
            shown = table.last[1] if row is None else table.rows[row]
            for solver, (value, note) in shown.items():
                with self.subTest(table=name, row=row, solver=solver):
                    wanted = values[solver]
                    if isinstance(wanted, str):
                        self.assertEqual(value, wanted)
                    else:
                        number = value[1] if isinstance(value, list) else value
                        self.assertAlmostEqual(number, wanted, delta=1e-12 + 1e-9 * abs(wanted))
                        self.seen[name] += 1
                    if marks is not None:
                        self.assertEqual(note.get("best", False), marks(values) == solver)
        self.assertTrue(table.last[0] == label or len(cells) == 1, f"{table.last[0]}, not {label}")

    def last_row(self, cells, columns, kind, nothing):
        """The last row by its definition, and its label."""
        having = [c for c in columns if any(compared(row[c]) for row in cells.values())]
        common = [row for row in cells.values() if all(compared(row[c]) for c in having) and
                  (nothing == 0 or kind != "mean" or any(row[c] >= nothing for c in having))]
        last = {}
        for c in columns:
            texts = {"is elsewhere" if isinstance(row[c], Still) else row[c] for row in cells.values()}
            if c not in having:
                last[c] = texts.pop() if len(texts) == 1 else "no value"
            elif not common:
                last[c] = f"{sum(compared(row[c]) for row in cells.values())} of {len(cells)}"
            elif kind == "largest":
                last[c] = max(row[c] for row in common)
            elif kind == "sum" or len(common) == 1:
                last[c] = sum(row[c] for row in common)
            else:
                raised = [[max(row[d], nothing) if nothing else row[d] for row in common] for d in having]
                mine = [max(row[c], nothing) if nothing else row[c] for row in common]
                positive = all(v > 0 for column in raised for v in column)
                last[c] = math.exp(statistics.fmean(map(math.log, mine))) if positive else statistics.fmean(mine)
        if not common:
            return last, "no scene has all: scenes with a value"
        return last, f"{kind} of {len(common)} scene{'' if len(common) == 1 else 's'}"

    def values_at_equal_work(self, report, metric):
        kind, nothing = METRICS[metric]
        cells, still = {}, set()
        for scene in dict.fromkeys(r.scene for r in report.raw):
            here, row = report.compared(scene), {}
            for solver in report.columns:
                case = here.get(solver)
                value = case.values.get(metric) if case and ended(case.status) else None
                row[solver] = why_none(case) if value is None else value
                if metric == "stretch.rms" and solver in SOLVE_ALL:
                    row[solver] = "does not sweep"
                    continue
                if value is not None and metric == "stretch.rms" and astray(case):
                    row[solver] = Still(value)
                    still.add((scene, solver))
            if any(not isinstance(v, str) for v in row.values()):
                cells[scene] = row
        if not cells:
            self.assertNotIn(metric, report.tables)
            return
        table = report.tables[metric]
        last, label = self.last_row(cells, report.columns, kind, nothing)

        self.one(table, metric, cells, last, label, lambda row: None)  # costs of sweeps differ, so that no solver is marked
        for scene, row in table.rows.items():
            for solver, (value, note) in row.items():
                self.assertEqual(note.get("state") == "astray", (scene, solver) in still)
        self.seen["astray"] += len(still)
        for scene, row in table.rows.items():  # each cell links to its case
            for solver, case in report.compared(scene).items():
                if metric != "stretch.rms" or solver not in SOLVE_ALL:
                    self.assertTrue(case.key.startswith(row[solver][1]["key"]), metric)
        if len(set(report.works.values())) > 1:
            self.assertTrue(all("note" in note for row in table.rows.values() for v, note in row.values() if not isinstance(v, str)))
            self.seen["unequal work"] += 1

    def steps(self, report):
        cells = {}
        for scene in dict.fromkeys(r.scene for r in report.raw):
            tried = {s: {(r.work, r.dt): r for r in report.raw if (r.scene, r.solver) == (scene, s)} for s in report.solvers}
            here = [s for s in report.solvers if len({dt for _, dt in tried[s]}) >= 3]
            shared = set.intersection(*(set(tried[s]) for s in here)) if here else set()
            steps = sorted({dt for _, dt in shared})
            if len(steps) < 3 or steps[-1] < 4 * steps[0]:
                continue
            row = {s: "not run" for s in report.columns}
            for s in here:
                row[s] = "below 4.17\u00a0ms"
                for dt in steps:
                    if not all(ended(tried[s][at].status) for at in shared if at[1] == dt):
                        break
                    row[s] = dt
            cells[scene] = row
        if not cells:
            self.assertNotIn("largest_step", report.tables)
            return
        last, label = self.last_row(cells, report.columns, "mean", 0)
        self.one(report.tables["largest_step"], "largest_step", cells, last, label, lambda row: None)

    def failures(self, report):
        """Failures among the cases that all solvers of a scene ran, summed over scenes on which all ran something."""
        cells, of = {}, collections.Counter()
        for scene in dict.fromkeys(r.scene for r in report.raw):
            asked = {s: {(r.work, r.dt): r.status for r in report.raw if (r.scene, r.solver) == (scene, s)} for s in report.columns}
            shared = set.intersection(*(set(own) for own in asked.values() if own))
            if not shared:
                continue
            cells[scene] = {s: sum(not ended(own[at]) and own[at] != "unsupported" for at in shared) if own else "not run"
                            for s, own in asked.items()}
            of.update({(scene, s): len(shared) for s, own in asked.items() if own})
        if not cells:
            self.assertNotIn("failures", report.tables)
            return
        table = report.tables["failures"]
        whole = [scene for scene, row in cells.items() if "not run" not in row.values()]
        last = {s: sum(cells[scene][s] for scene in whole) if whole else "not run" for s in report.columns}
        self.one(table, "failures", cells, last, f"sum of {len(whole)} scene{'' if len(whole) == 1 else 's'}",
                 lambda row: best_of({s: v for s, v in row.items() if not isinstance(v, str)}, 0))
        for scene, row in table.rows.items():
            for solver, (value, note) in row.items():
                if not isinstance(value, str):
                    self.assertEqual(int(note["note"].split(":")[0].split()[1]), of[scene, solver])
        cases = {r.key: (r.scene, r.solver, r.status) for r in report.raw}
        for rows in report.timed.values():
            for row in rows:
                cases.setdefault(row["key"], (row["scene_id"], row["solver"], row["status"]))
        of = collections.Counter((scene, solver) for scene, solver, _ in cases.values())
        # The page shows the same counts in another place.
        for scene in report.model["scenes"]:
            for solver, statuses in scene.get("statuses", {}).items():
                self.assertEqual(sum(statuses.values()), of[scene["id"], solver])

    def costs(self, report):
        scenes = report.timed
        if not scenes:
            self.assertFalse({"price", "equal_cost", "setting"} & set(report.tables))
            return
        who = {scene: list(dict.fromkeys(r["solver"] for r in rows)) for scene, rows in scenes.items()}

        def within(scene, solver, budget):
            rows = [r for r in scenes[scene] if r["solver"] == solver and r["usable"] and r["cost"] <= budget * 60]
            return min(rows, key=lambda r: (r["error"], r["cost"]), default=None)

        def cheapest(scene, solver):
            rows = [r for r in scenes[scene] if r["solver"] == solver and r["usable"] and r["error"] <= PRICED]
            return min(rows, key=lambda r: r["cost"], default=None)
        def label(scene):
            return scene if report.metric[scene] == "motion.error" else f"{scene} (by strain alone)"
        budget = next((b for b in BUDGETS if all(within(s, v, b) for s in scenes for v in who[s])), BUDGETS[-1])
        for name, choose, value, lacking, nothing in (
                ("equal_cost", lambda s, v: within(s, v, budget), "error", "nothing that cheap", 0.01),
                ("price", cheapest, "cost", "not reached", 0), ("setting", cheapest, None, "none", 0)):
            table, cells = report.tables[name], {}
            for scene in scenes:
                row = {}
                for solver in report.columns:
                    case = choose(scene, solver)
                    row[solver] = ("not timed" if solver not in who[scene] else lacking) if case is None else case[value or "cost"]
                    if case:
                        self.assertTrue(case["key"].startswith(table.rows[label(scene)][solver][1]["key"]), f"{name}: {scene}, {solver}")
                cells[label(scene)] = row
            if name == "setting":
                self.setting(report, table, cheapest)
                continue
            last, of_all = self.last_row(cells, report.columns, "mean", nothing)
            marks = None if name == "price" else lambda row: best_of({s: v for s, v in row.items() if not isinstance(v, str)}, 0.01)
            self.one(table, name, cells, last, of_all, marks)
            if name == "price":
                bounds = {label(scene): {v for v in report.columns if self.is_bound(scenes[scene], cheapest(scene, v))} for scene in scenes}
                noises = {label(scene): float(rows[0]["noise"]) for scene, rows in scenes.items()}
                for scene, row in table.rows.items():
                    self.price_marks(row, noises[scene], bounds[scene])
                    for solver, (value, note) in row.items():
                        self.assertEqual("at most" in note.get("note", ""), solver in bounds[scene])
                common = [scene for scene, row in cells.items() if all(not isinstance(row[c], str) for c in report.columns
                          if any(not isinstance(other[c], str) for other in cells.values()))]
                self.price_marks(table.last[1], max(float(rows[0]["noise"]) for rows in scenes.values()),
                                 set().union(*(bounds[scene] for scene in common)))

    def is_bound(self, rows, case):
        """Whether no setting of the case's solver with less cost or less work was tried, so that its cost is an upper bound."""
        def work(row):
            own = dict(part.split("=") for part in row["setting"].split(":", 1)[-1].split(",") if "=" in part)
            return int(own.get("substeps", 1)) * int(own["iterations"])
        if case is None or work(case) == 1:
            return False
        return not any(work(r) < work(case) or (r["stable"] == "1" and r["cost"] < case["cost"]) for r in rows
                       if r["solver"] == case["solver"])

    def price_marks(self, row, noise, bounds):
        """Intervals contain their middle. A cost is only marked if it is lower beyond tolerance and noise and no other is a bound."""
        numbers = {s: v for s, (v, _) in row.items() if isinstance(v, list)}
        for low, mid, high in numbers.values():
            self.assertLessEqual(low, mid)
            self.assertLessEqual(mid, high)
        marked = [s for s, (_, note) in row.items() if note.get("best")]
        ranked = sorted(numbers, key=lambda s: numbers[s][1])
        if len(ranked) < 2:
            self.assertEqual(marked, [])
            return
        over = numbers[ranked[1]][1] / numbers[ranked[0]][1]
        self.assertTrue(marked in ([], [ranked[0]]))
        if over < 0.9 * (1 + max(noise, 0.05)):  # the middle of the ratio differs from the ratio of medians
            self.assertEqual(marked, [], f"{over}, noise {noise}")
            self.seen["not marked"] += 1
        if any(s in bounds for s in ranked[1:]):
            self.assertEqual(marked, [])
        elif over > 2.5:  # samples of a case vary by at most half
            self.assertEqual(marked, ranked[:1], f"{over}, noise {noise}")
            self.seen["marked"] += 1

    def winners(self, report):
        """The map of the cheapest solvers: solver, setting, cost, the next solver and its ratio, and solvers that are excluded."""
        if not report.timed:
            self.assertNotIn("winners", report.model)
            return
        rows = {row["title"]: row for row in report.model["winners"]["rows"]}
        self.assertEqual(list(rows), list(report.timed))
        self.assertEqual(report.model["winners"]["levels"], LEVELS)
        for scene, timed in report.timed.items():
            self.assertEqual(rows[scene]["by"], "motion" if report.metric[scene] == "motion.error" else "nothing")
            self.assertEqual(len(rows[scene]["cells"]), len(LEVELS))
            for level, cell in zip(LEVELS, rows[scene]["cells"]):
                with self.subTest(scene=scene, level=level):
                    self.winner(timed if report.metric[scene] == "motion.error" else [], level, cell)

    def winner(self, timed, level, cell):
        best = {}  # by solver
        for row in sorted((r for r in timed if r["usable"] and r["error"] <= level), key=lambda r: -r["cost"]):
            best[row["solver"]] = row
        ranked = sorted(best.values(), key=lambda r: r["cost"])
        excluded = collections.defaultdict(list)  # reasons, of solvers that only reach the error with what does not count
        for r in timed:
            if ranked and r["uncounted"] and r["error"] <= level and r["cost"] < ranked[0]["cost"] and r["solver"] not in best:
                excluded[r["solver"]].append(r["uncounted"])
        self.assertEqual({p["solver"]: True for p in cell.get("excluded", [])}, {s: True for s in excluded})
        for one in cell.get("excluded", []):
            self.assertTrue(any(all(name in one["why"] for name in why) for why in excluded[one["solver"]]), one)
            self.seen["excluded"] += 1
        if not ranked:
            self.assertNotIn("cheapest", cell)
            self.assertTrue(cell["why"])
            self.seen["nobody"] += 1
            return
        noise, first = float(timed[0]["noise"]), ranked[0]

        def holds(one, row):
            self.assertEqual(one["solver"], row["solver"])
            self.assertTrue(row["key"].startswith(one["case"]))
            self.assertAlmostEqual(one["cost"][1], row["cost"], delta=1e-9 * row["cost"])
            self.assertAlmostEqual(one["error"], row["error"], delta=1e-12)
            self.assertEqual(one.get("at_most", False), self.is_bound(timed, row))
        holds(cell["cheapest"][0], first)
        alike, told = {c["solver"] for c in cell["cheapest"]}, []
        for row in ranked[1:]:
            over = ratio(row, first)
            if row["solver"] in alike:  # cannot be told apart, or its cost is an upper bound
                self.assertTrue(over < 2.5 or self.is_bound(timed, row), f"{over}, noise {noise}")
            else:
                self.assertGreater(over, max(1.05, 1 + noise))
                self.assertFalse(self.is_bound(timed, row))
                told.append(row)
        self.seen["alike"] += len(alike) > 1
        self.assertEqual("next" in cell, bool(told))
        if told:
            holds(cell["next"], told[0])
            low, middle, high = cell["times"]
            self.assertAlmostEqual(middle, ratio(told[0], first), delta=1e-9 * middle)
            self.assertLessEqual(low, middle)
            self.assertLessEqual(middle, high)
            self.seen["won"] += len(alike) == 1

    def said(self, report):
        """Counts and ratios in the sentences agree with the map, and every number is a link."""
        cells = [cell for row in report.model.get("winners", {}).get("rows", []) for cell in row["cells"]]
        if not cells:
            return
        titles = {s["id"]: s["title"] for s in report.model["solvers"]}
        won = collections.defaultdict(list)
        for cell in cells:
            if len(cell.get("cheapest", [])) == 1:
                won[titles[cell["cheapest"][0]["solver"]]].append(cell)
        whole = " ".join("".join(part["text"] for part in sentence) for sentence in report.model["winners"]["sentences"])
        for sentence in report.model["winners"]["sentences"]:
            for part in sentence:
                if any(c.isdigit() for c in part["text"]):
                    self.assertTrue(part.get("map") or part["case"] in {c["key"] for c in report.model["cases"]}, part)
        for solver, own in won.items():
            self.assertRegex(whole, f"{solver} is cheapest in {len(own)}\\b")
            times = sorted(cell["times"][1] for cell in own if "next" in cell)
            if times:
                said = re.search(f"{solver} is cheapest in [^,;]*, by ([0-9.]+)(?: to ([0-9.]+))? times", whole)
                for text, value in zip(said.groups(), (times[0], times[-1])):
                    if text:
                        self.assertAlmostEqual(float(text), value, delta=0.051 * value)
        self.assertIn(f"{len(cells)} cells", whole)
        self.seen["said"] += 1

    def setting(self, report, table, cheapest):
        """The setting that reaches the error on most scenes; of equal ones, the cheapest on average."""
        for solver, (value, note) in table.last[1].items():
            reached = collections.defaultdict(list)
            for rows in report.timed.values():
                for r in rows:
                    if r["solver"] == solver and r["usable"] and r["error"] <= PRICED:
                        reached[r["setting"]].append(r)
            if not reached:
                self.assertIn(value, ("none", "not timed", "no value"))
                continue
            best = max(reached.values(), key=lambda rows: (len(rows), -statistics.fmean(math.log(r["cost"]) for r in rows)))
            self.assertIn(True, [r["key"].startswith(note["key"]) for r in best], solver)
            self.assertTrue(len(report.timed) == 1 or note["note"].endswith(f", {len(best)} of {len(report.timed)}"), note)
            self.seen["setting"] += 1

    def test_every_cell_is_what_the_raw_rows_say(self):
        for seed in SEEDS:
            with self.subTest(seed=seed):
                report = Report(seed)
                timed = dict.fromkeys(r["solver"] for rows in report.timed.values() for r in rows)
                report.columns = report.solvers + [s for s in timed if s not in report.solvers]
                for table in report.tables.values():
                    self.assertEqual(table.columns, report.columns)
                for metric in METRICS:
                    self.values_at_equal_work(report, metric)
                self.steps(report)
                self.failures(report)
                self.costs(report)
                self.winners(report)
                self.said(report)
                self.seen["one solver"] += len(report.columns) == 1
        for what in (*METRICS, "largest_step", "failures", "price", "equal_cost", "setting", "marked", "not marked",
                     "one solver", "unequal work", "astray",
                     "won", "alike", "nobody", "excluded", "said"):
            self.assertGreater(self.seen[what], 0, f"no made-up run shows: {what}")


if __name__ == "__main__":
    TAUT, MADE_UP = (os.path.join(os.path.abspath(sys.argv[1]), name) for name in ("taut", "taut_made_up"))
    unittest.main(argv=sys.argv[:1])
