#!/usr/bin/env python3
"""Programs as solvers: the SDKs' toys give jakobsen's results, hostile programs cost only their own case and leave no process,
and the probe names errors.

Usage: external_test.py FOLDER_OF_TAUT [TEST ...]"""

import csv
import json
import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import time
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "cli"))
from command_line import BINARIES, CommandLine, facts_of, main, rows_of  # noqa: E402

SDK = HERE.parents[1] / "experiments" / "external" / "sdk"
os.environ["TAUT_SDK"] = str(SDK)
os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
USERS_SOLVERS = os.environ.get("TAUT_SOLVERS")
LISTING = "jakobsen:substeps=1,order=mesh,projection=exact,precision=double,iterations="
TOYS = {"python": f'python3 "{SDK}/toy.py"', "cpp": f'"{BINARIES}/tests/taut_toy_solver"'}


def hostile(mode, timeout=3):
    return f"""external:cmd='python3 "{HERE}/hostile.py" {mode}',timeout={timeout}"""


MARK = f"TAUT_EXTERNAL_TEST={os.getpid()}"
os.environ.update([MARK.split("=")])


def alive(word):
    """Processes with this word in their command line that carry this test's mark, as other tests run at the same time."""
    found = []
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            words = (folder / "cmdline").read_bytes().split(b"\0")
            if MARK.encode() not in (folder / "environ").read_bytes().split(b"\0"):
                continue
        except OSError:
            continue
        if any(word.encode() == w or w.endswith(word.encode()) for w in words):
            found.append((int(folder.name), words))
    return found


class Programs(CommandLine):
    def setUp(self):
        super().setUp()
        self.solvers = self.folder / "solvers"
        self.solvers.mkdir()
        os.environ["TAUT_SOLVERS"] = str(self.solvers)

    def end_of(self, scene, solver, *more):
        self.taut("case", scene, solver, "--final-state", "end.csv", *more)
        rows = csv.DictReader((self.folder / "end.csv").read_text().splitlines())
        return [float(row[key]) for row in rows for key in ("x", "y", "z", "vx", "vy", "vz")]

    def case(self, solver, scene="./five.toml", expect=0):
        return json.loads(self.taut("case", scene, solver, "--json", expect=expect).out)

    def five(self):
        text = (self.folder / "small.toml").read_text().replace("[4, 4]", "[5, 5]")
        (self.folder / "five.toml").write_text(text)


class Toys(Programs):
    def check(self, toy):
        command = TOYS[toy]
        if not shutil.which(shlex.split(command)[0]):
            self.skipTest(f"{shlex.split(command)[0]} is not here: its SDK is not tested")
        probe = self.taut("external", "probe", command)
        self.assertRegex(probe.out, "may be scored +yes")
        self.assertEqual(probe.out.count("passed"), 10, probe.out)
        self.assertRegex(probe.out, r"its links act like springs of [0-9.e+]+ N/m, as 8 sweeps")
        (self.folder / "sheet.toml").write_text("[cloth]\ngrid = [6, 6]\nsize = [1, 1]\nmass = 0.1\npins = [\"top-left\", \"top-right\"]\n"
                                                "[time]\ndt = \"1/64\"\nduration = 9.375\n")
        ours = self.end_of("./sheet.toml", LISTING + "6")
        theirs = self.end_of("./sheet.toml", f"external:cmd='{command}',iterations=6")
        self.assertEqual(len(theirs), 6 * 36)
        positions = [i for i in range(len(ours)) if i % 6 < 3]
        self.assertLess(max(abs(ours[i] - theirs[i]) for i in positions), 1e-12, "m after 600 steps")
        other = self.end_of("./sheet.toml", f"external:cmd='{command}',iterations=5")
        self.assertGreater(max(abs(ours[i] - other[i]) for i in positions), 1e-3, "its parameter has no effect")

    def test_python(self):
        self.check("python")

    def test_cpp(self):
        self.check("cpp")

    def test_what_it_cannot_do_is_unsupported(self):
        status = self.case(f"external:cmd='{TOYS['cpp']}'", "ball")["status"]
        self.assertEqual((status["kind"], status["reason"]), ("unsupported", "gravity, links and pins at rest are all that it knows"))

    def test_elastic_links_and_capsules_are_for_those_that_know_them(self):
        shutil.copy(SDK / "taut_solver.py", self.folder)
        (self.folder / "soft.toml").write_text((self.folder / "small.toml").read_text() + "[links]\nstiffness = { structural = 500 }\n"
                                               '[[collider]]\ntype = "capsule"\nfrom = [0, -9, 0]\nto = [0, -9, 1]\nradius = 0.5\n')
        toy = (SDK / "toy.py").read_text().replace('scene["colliders"] or ', "").replace(
            '{"projection"', '{"read": f"{self.stiffness} {self.capsules}", "projection"').replace(
            "self.sweeps = params", 'self.stiffness, self.capsules = scene.get("stiffness"), [c["to"] for c in scene["colliders"]]\n        self.sweeps = params')
        for version, kind in (("1", "unsupported"), ("2", "ok")):
            (self.folder / "knows.py").write_text(toy.replace("class Toy:", f'class Toy:\n    protocol = "taut-solver/{version}"'))
            record = self.case("external:cmd='python3 knows.py'", "./soft.toml")
            self.assertEqual(record["status"]["kind"], kind, record)
            if kind == "ok":
                self.assertIn({"name": "read", "text": "{'structural': 500.0, 'shear': None, 'bend': None} [[0.0, -9.0, 1.0]]"}, record["resolved_settings"])
            else:
                self.assertIn("links of 500 N/m", record["status"]["reason"])
                self.assertIn("a capsule", record["status"]["reason"])

    def test_a_registered_solver_is_one_like_any_other(self):
        (self.solvers / "mine.toml").write_text(f"cmd = '{TOYS['cpp']}'\n")
        listed = self.answer("list", "solvers")
        self.assertEqual([s["summary"] for s in rows_of(listed, "solvers") if s["name"] == "mine"], ["Jakobsen's algorithm in C++"])
        self.assertEqual([p["name"] for p in rows_of(listed, "parameters") if p["solver"] == "mine"], ["build", "iterations"])
        study = self.study(solvers=["mine", "jakobsen:substeps=1,order=mesh"], rest="[axes]\niterations = [1, 4]\n"
                           '[[plot]]\nkind = "convergence"\n')
        self.taut("run", study)
        records = self.records()
        self.assertEqual([r["status"]["kind"] for r in records], ["ok"] * 4)
        mine = [r for r in records if r["solver"] == "mine"]
        self.assertEqual(sorted(r["params"]["iterations"] for r in mine), ["1", "4"])
        self.assertIn({"name": "program", "text": "toy-cpp 1"}, mine[0]["resolved_settings"])
        self.assertEqual({r["projections"] for r in mine}, {42, 168})
        self.taut("plot", study)
        plan = self.taut("plan", "./small.toml", "mine:iterations=3").out
        self.assertIn("links", plan)
        bench = self.taut("bench", study, "--rounds", 2, "--seconds", 0.01).out
        self.assertNotIn("not timed", bench)
        self.taut("report", study, "--no-media")
        self.assertIn("toy-cpp", (self.folder / "report.html").read_text())

    def test_a_changed_program_is_another_one(self):
        for name in ("toy.py", "taut_solver.py"):
            shutil.copy(SDK / name, self.folder)
        solver = "external:cmd='python3 toy.py'"
        before = self.case(solver, "./small.toml")["key"]
        self.assertEqual(self.case(solver, "./small.toml")["key"], before)
        with (self.folder / "toy.py").open("a") as file:
            file.write("\n")
        self.assertNotEqual(self.case(solver, "./small.toml")["key"], before)

    def test_bad_input_is_refused_before_anything_runs(self):
        for solver, says in [("external:cmd='no-such-program x'", "no program 'no-such-program'"),
                             ("external:cmd='python3 a | b'", "no shell runs it"),
                             ("external:cmd='touch called", "the quote ' is not closed"),
                             (f"external:cmd='{TOYS['cpp']}',iterations=-1", "iterations=-1 is outside 0 to 1e6"),
                             (f"external:cmd='{TOYS['cpp']}',sweeps=1", "unknown parameter 'sweeps'"),
                             ("mien", "unknown solver 'mien'")]:
            with self.subTest(solver):
                self.assertIn(says, self.taut("case", "./small.toml", solver, expect=2).err)
        self.assertFalse((self.folder / "called").exists())
        (self.solvers / "mine.toml").write_text("cmd = 'no-such-program'\nspeed = 3\n")
        self.assertRegex(self.taut("case", "./small.toml", "mine", expect=2).err, r"mine.toml:2:1: unknown key 'speed'")
        self.assertEqual(self.case("external", "./small.toml")["status"]["kind"], "unsupported")


class Everywhere(Programs):
    """A program, and a file of positions, are accepted wherever a solver is."""

    def report(self, study):
        model = json.loads(self.taut("report", study, "--no-media", "--json").out)
        self.taut("report", study, "--no-media")
        return model, (self.folder / "report.html").read_text()

    def test_a_misnamed_file_is_an_error_that_names_it(self):
        for name in ("my.solver", "x y", "9lives", "é", "a" * 41):
            file = self.solvers / f"{name}.toml"
            file.write_text(f"cmd = '{TOYS['cpp']}'\n")
            for words in (["list", "solvers"], ["plan", "hang", "nosuch"], ["advise", "hang", "--error", "1%"]):
                said = self.taut(*words, expect=2).err
                self.assertIn(f"{name}.toml: '{name}' is not a solver name", said)
            file.unlink()
        os.mkfifo(self.solvers / "pipe.toml")
        self.assertIn("pipe.toml: is not a regular file", self.taut("list", "solvers", expect=2).err)
        (self.solvers / "pipe.toml").unlink()

    def test_any_kind_of_parameter_may_be_called_substeps_or_iterations(self):
        shutil.copy(SDK / "taut_solver.py", self.folder)
        program = (SDK / "toy.py").read_text().replace('self.sweeps = params["iterations"]', "self.sweeps = 4")
        kinds = {"text": {"type": "text", "default": "many"}, "choice": {"type": "choice", "choices": ["few", "many"], "default": "few"},
                 "real": {"type": "real", "min": 0, "max": 9, "default": 8.5}}
        for kind, spec in kinds.items():
            begin = program.index("    params = ")
            text = program[:begin] + f"    params = {{'iterations': {spec!r}, 'substeps': {spec!r}}}\n" + program[program.index("\n", begin) + 1:]
            (self.folder / f"{kind}.py").write_text(text.replace("toy-python", "toy " + kind))
        study = self.study(solvers=["jakobsen"] + [f"{kind}:cmd='python3 {kind}.py'" for kind in kinds])
        self.taut("run", study)
        self.assertEqual({r["status"]["kind"] for r in self.records()}, {"ok"})
        model, page = self.report(study)
        self.assertIn("many", page)

    def test_a_program_with_any_name_is_scored(self):
        shutil.copy(SDK / "taut_solver.py", self.folder)
        for name in ("9" + "x" * 39, "1e99999999999", "."):
            (self.folder / "named.py").write_text((SDK / "toy.py").read_text().replace("toy-python", name).replace('"1"', '"1e99999999999"'))
            study = self.study(f"named{len(name)}.toml", solvers=["external:cmd='python3 named.py'", "jakobsen"])
            self.taut("run", study)
            self.report(study)
        self.assertEqual({r["status"]["kind"] for r in self.records()}, {"ok"})

    def test_two_commands_are_two_solvers(self):
        for name in ("toy.py", "taut_solver.py"):
            shutil.copy(SDK / name, self.folder)
        (self.folder / "other.py").write_text((self.folder / "toy.py").read_text().replace("self.sweeps = ", "self.sweeps = 3 * "))
        study = self.study(solvers=["external:cmd='python3 toy.py'", "external:cmd='python3 other.py'", "named:cmd='python3 other.py -v'"],
                           rest='[axes]\niterations = [1, 2]\n[[plot]]\nkind = "convergence"\n')
        self.taut("run", study)
        names = {r["solver"]: r["params"]["cmd"] for r in self.records()}
        self.assertEqual(len(self.records()), 6)
        self.assertEqual(sorted(names.values()), ["python3 other.py", "python3 other.py -v", "python3 toy.py"])
        self.assertEqual(names["named"], "python3 other.py -v")
        for name in set(names) - {"named"}:
            self.assertRegex(name, "^toy-python-[0-9a-f]{4}$")
        self.taut("plot", study)
        curves = (self.folder / "results/runs/figures/study/small-convergence-stretch.rms-over-iterations.csv").read_text()
        self.assertEqual({line.split(",")[1] for line in curves.splitlines()[1:]}, set(names))
        model, page = self.report(study)
        self.assertEqual({s["id"] for s in model["solvers"]}, set(names))
        stretch = {r["solver"]: r["values"]["stretch.rms"] for r in self.records() if r["params"]["iterations"] == "1"}
        self.assertEqual(len(set(stretch.values())), 2, "the same program twice, and another")

    def test_a_solver_written_from_the_document_runs_beside_bullet(self):
        """A program in Perl without an SDK; it has sweeps but no substeps, so that each step is one substep."""
        if not shutil.which("perl"):
            self.skipTest("perl is not here")
        perl = f"""external:cmd='perl "{HERE}/relax.pl"'"""
        self.assertRegex(self.taut("external", "probe", f'perl "{HERE}/relax.pl"').out, "may be scored +yes")
        study = self.study(solvers=[perl, "bullet"], rest='[axes]\niterations = [1, 2]\n[[plot]]\nkind = "convergence"\n')
        self.taut("run", study)
        self.assertEqual([r["status"]["kind"] for r in self.records()], ["ok"] * 4)
        self.taut("plot", study)
        model, page = self.report(study)
        stretch = model["answer"]["tables"]["stretch.rms"]
        self.assertIn("1 \u00d7 2 (substeps \u00d7 sweeps)", stretch["caption"])
        self.assertTrue(any(column["heading"].startswith("Relax perl") for column in stretch["columns"]))
        self.assertIn("relax-perl", page)

    def test_an_axis_is_not_taken_for_fixed_by_a_command_that_names_it(self):
        for name in ("toy.py", "taut_solver.py"):
            shutil.copy(SDK / name, self.folder)
        study = self.study(solvers=["external:cmd='python3 toy.py a,iterations=7'"], rest="[axes]\niterations = [1, 2]\n")
        self.taut("run", study)
        self.assertEqual(sorted(r["params"]["iterations"] for r in self.records()), ["1", "2"])

    def test_positions_stand_beside_solvers(self):
        self.taut("case", "./small.toml", LISTING + "4", "--trajectory", "run.pc2")
        self.taut("case", "./small.toml", LISTING + "4", "--trajectory", "other.npy")
        study = self.study(solvers=["bullet", LISTING + "4", "positions:file=run.pc2", "named:file=other.npy"],
                           rest='[axes]\niterations = [1, 4]\n[[plot]]\nkind = "convergence"\n'
                           '[[plot]]\nkind = "series"\ny = "stretch.rms"\n[[plot]]\nkind = "work-precision"\n')
        self.taut("run", study)
        records = {r["solver"]: r for r in self.records()}
        self.assertEqual({r["status"]["kind"] for r in records.values()}, {"ok"})
        file, = [name for name in records if name.startswith("positions-")]
        inside, floor = records["jakobsen"]["values"], next(s["number"] for s in records[file]["resolved_settings"] if s["name"] == "strain.floor")
        self.assertTrue(1e-9 < floor < 1e-6, floor)
        for name, value in inside.items():
            if name.startswith(("stretch", "shear", "structural", "compression")):
                self.assertAlmostEqual(records[file]["values"][name], value, delta=30 * floor, msg=name)
                self.assertAlmostEqual(records["named"]["values"][name], value, delta=1e-12, msg=name)
        self.taut("plot", study)
        figures = self.folder / "results/runs/figures/study"
        error = (figures / "small-convergence-stretch.rms-over-iterations.csv").read_text().splitlines()
        level = [line.split(",") for line in error if f",{file}," in line]
        self.assertEqual([row[3] for row in level], ["1", "4"], "a level across the chart")
        self.assertEqual(len({row[6] for row in level}), 1)
        rounding = "rounding of the file of positions"
        self.assertIn(rounding, (figures / "small-series-stretch.rms-over-t.svg").read_text())
        self.assertNotIn(rounding, (figures / "small-convergence-stretch.rms-over-iterations.svg").read_text(), "far below all points")
        model, page = self.report(study)
        settings = model["tables"]["settings-small"]
        place = [column["name"] for column in settings["columns"]].index(file)
        self.assertEqual([row[place] for row in settings["rows"] if row[0] == "cost"], ["not measured"])
        self.assertIn(file, page)
        floors = [chart["floor"] for chart in model["charts"] if "floor" in chart]
        self.assertTrue(any("rounding of the file" in one["text"] for one in floors), floors)
        timing, = [c for c in rows_of(self.answer("bench", study, "--rounds", 2, "--seconds", 0.01), "cases") if c["solver"] == file]
        self.assertIn("positions from a file: cost not measured", timing["remark"])
        fronts = [p["case"] for chart in model["charts"] for p in chart.get("front", [])]
        self.assertNotIn(records[file]["key"], fronts)
        self.taut("case", "./small.toml", "positions:file=none.npy", expect=2)
        (self.folder / "one.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 0 1\n")
        self.assertIn("one.obj: has one frame", self.taut("external", "score", "./small.toml", "one.obj", expect=2).err)
        self.assertIn("has 33 frames, the scene needs 65",
                      json.loads(self.taut("case", "./small.toml", "positions:file=run.pc2", "--duration", 1, "--json").out)["status"]["reason"])
        self.taut("render", "./small.toml", "--solver", "positions:file=run.pc2", "--solver", "bullet", "-o", "end.png")

    def test_verbs(self):
        toy = f"external:cmd='{TOYS['cpp']} --'"
        frontier = self.taut("frontier", "./small.toml", toy, "--from", 0.01, "--to", 0.05).out
        self.assertIn("largest stable dt", frontier)
        advise = self.taut("advise", "./small.toml", "--error", "1%", "--solver", toy, "--patience", 20, "--rounds", 2).out
        self.assertIn("toy-cpp-", advise)
        reproduce, = [line.split("compare again", 1)[1] for line in advise.splitlines() if "compare again" in line]
        self.assertIn("'\\''", reproduce, "quotes for a shell")
        verify = self.taut("verify", "--solver", toy)
        self.assertIn("any-rest", verify.out)
        self.assertIn("0 broken", verify.err)
        wrong = self.taut("verify", "--solver", f"""external:cmd='python3 "{HERE}/wrong.py" pins'""", expect=1)
        self.assertIn("broken", wrong.out)
        study = self.study(solvers=[toy, "jakobsen:substeps=1,order=mesh"], rest="[axes]\niterations = [1, 4]\n")
        self.taut("baseline", "update", study, "--baselines", "kept", "--why", "new")
        self.taut("check", study, "--baselines", "kept")
        torture = self.study("torture.toml", scenes=["torture/smallest", "torture/step-huge"], solvers=[toy])
        self.taut("run", torture, "--timeout", 10)
        self.taut("require", "./small.toml", toy, "--patience", 20, expect=None)


class Engines(Programs):
    """Programs that tests do not download; external/README.md explains how to obtain each."""

    def engine(self, name):
        home = os.environ.get("XDG_CONFIG_HOME") or pathlib.Path.home() / ".config"
        installed = pathlib.Path(USERS_SOLVERS or pathlib.Path(home) / "taut" / "solvers")
        if not (installed / f"{name}.toml").exists():
            self.skipTest(f"no {name} in {installed}")
        os.environ["TAUT_SOLVERS"] = str(installed)
        study = self.study(solvers=[name, LISTING + "1"], rest="[axes]\nsubsteps = [2, 8]\n")
        self.taut("run", study)
        self.assertEqual({r["status"]["kind"] for r in self.records()}, {"ok"})
        stretch = {r["params"]["substeps"]: r["values"]["stretch.rms"] for r in self.records() if r["solver"] == name}
        self.assertLess(stretch["8"], stretch["2"])

    def test_jolt(self):
        self.engine("jolt")

    def test_nvcloth(self):
        self.engine("nvcloth")


class Hostile(Programs):
    def setUp(self):
        super().setUp()
        self.five()

    def test_each_costs_its_own_case_and_leaves_no_process(self):
        expected = {"hang": ("timeout", "no answer to 'step' within 3 s"), "flood": ("protocol", "without a line feed"),
                    "lines": ("protocol", "sent output that was not requested"), "exit": ("crash", "exit code 3 during 'step': enough of this"),
                    "abort": ("crash", "SIGABRT during 'step'"),
                    "garbage": ("protocol", "not a JSON object: 'step 5 done, residual 1e-3'"),
                    "close": ("protocol", "closed its standard output during 'step'"),
                    "error": ("error", "refused 'step': the matrix is singular"),
                    "half": ("timeout", "only 600 bytes"), "size": ("protocol", "a state of 25 vertices has 1200 bytes, not 48"),
                    "nan": ("exploded", "nonfinite"), "fork": ("extreme", "stretch"), "hello-hang": ("timeout", "no answer to 'hello' within 3 s"),
                    "hello-garbage": ("protocol", "not a JSON object: 'Loading model...'")}
        study = self.study(scenes=["./five.toml"], solvers=["jakobsen:precision=double"] + [hostile(mode) for mode in expected])
        run = self.taut("run", study, "-j", 2)
        self.assertIn(f"{len(expected) + 1}/{len(expected) + 1} cases", run.err)
        records = self.records()
        self.assertEqual([r["status"]["kind"] for r in records if r["solver"] == "jakobsen"], ["ok"])
        for mode, (kind, reason) in expected.items():
            record, = [r for r in records if r["params"].get("cmd", "").endswith(f"hostile.py\" {mode}")]
            with self.subTest(mode):
                status = record["status"]
                self.assertEqual(status["kind"], kind, status)
                self.assertIn(reason, status["reason"])
                if kind not in ("ok", "exploded", "extreme"):
                    self.assertEqual(status["step"], -1 if mode.startswith("hello") else 4)
        self.assertEqual([r["log"] for r in records if 'hostile.py" exit' in r["params"].get("cmd", "")], ["enough of this\n"])
        for left in ("hostile.py", "1000", "1001", "1002"):
            self.assertEqual([p for p in alive(left) if b"sleep" in p[1] or b"hostile" in b"".join(p[1])], [])

    def test_memory(self):
        if "asan" in BINARIES.name:
            self.skipTest("the sanitizer's programs have no limit of memory")
        self.taut("run", self.study(scenes=["./five.toml"], solvers=[hostile("memory", 60)]), "--memory", 500)
        status = self.records()[0]["status"]
        self.assertEqual(status["kind"], "oom", status)

    def test_lies_about_time_are_published_as_such(self):
        bench = self.answer("bench", "./five.toml", "--solver", hostile("lie", 30), "--solver", "jakobsen", "--rounds", 2)
        timing, = [c for c in rows_of(bench, "cases") if "lie" in c["case"]]
        self.assertRegex(timing["remark"], r"it says 1 us a step, its CPU clock [23]\d\d\d us")
        self.assertGreater(timing["cpu"][0], 0.0015)

    def test_what_a_program_puts_off_until_its_state_is_asked_for_is_counted(self):
        self.assertGreater(min(self.times("later")), 0.0015)
        self.assertLess(max(self.times("plain")), 0.001)

    def test_what_an_exchange_and_a_state_cost_is_no_steps(self):
        self.assertLess(max(self.times("slow")), 0.001)

    def times(self, mode):
        return [row["cpu"] for row in rows_of(self.answer("bench", "./five.toml", "--solver", hostile(mode, 30), "--rounds", 2), "samples")]

    def test_helpers_have_no_cost(self):
        bench = self.answer("bench", "./five.toml", "--solver", hostile("fork", 30), "--solver", "jakobsen", "--rounds", 2)
        timing, = [c for c in rows_of(bench, "cases") if "fork" in c["case"]]
        self.assertIn("it starts processes of its own", timing["remark"])

    def test_nothing_outlives_a_killed_taut(self):
        case = self.start("case", "./five.toml", hostile("hang", 60))
        for _ in range(600):
            if len(alive("hostile.py")) == 1:
                break
            time.sleep(0.05)
        else:
            self.fail("it never began")
        time.sleep(1)
        case.kill()
        case.communicate()
        for _ in range(100):
            left = [p for p in alive("hostile.py") if b"python3" in p[1]]
            if not left:
                return
            time.sleep(0.05)
        self.fail(left)


class Probe(Programs):
    def test_it_says_what_is_wrong(self):
        expected = {"still": "free fall: in 0.5 s of free fall in steps of 0.01562 s nothing moves",
                    "down": "free fall: .*it falls along \\(-?[0-9.e-]+, -1, -?[0-9.e-]+\\), but gravity points along",
                    "up": "free fall: .*it falls along", "weightless": "free fall: .*gravity has no effect",
                    "centimetres": "free fall: .*it falls 103.1 times as far as g t\\^2/2",
                    "frames": "free fall: .*it advances by 0.5333 s", "forgets": "free fall: .*forgets the velocities",
                    "shrinks": "free fall: .*does not stay in shape.*vertex 1", "frame-velocity": "free fall: .*it reports the velocity",
                    "nan": "free fall: .*does not stay in shape.*vertex 15 is -?nan m off",
                    "pins": "pins: vertex 0 is pinned", "left": "moving pins: vertex [03] is a pin that moves", "chance": "same bits: the same load and the same steps give other bits",
                    "survives": "same bits: the same load", "restart": "restart: 'store' right after 'load'",
                    "outlives": "end of input: does not end within 5 s"}
        for mode, says in expected.items():
            with self.subTest(mode):
                probe = self.taut("external", "probe", f'python3 "{HERE}/wrong.py" {mode}', expect=1)
                self.assertRegex(probe.out, "FAILED +(" + says.replace(": ", " +", 1) + ")")
                self.assertIn("it is not scored", probe.out)

    def test_of_what_was_not_computed_nothing_is_written(self):
        self.five()
        files = ["--final-state", "end.csv", "--trajectory", "way.pc2", "--series", "series.csv"]
        for solver, status, code in [("external", "unsupported", 0), (hostile("exit"), "crash", 1), ("external:cmd='false'", "crash", 1)]:
            done = self.taut("case", "./five.toml", solver, *files, "--json", expect=code)
            record = json.loads(done.out)
            self.assertEqual(record["status"]["kind"], status)
            written = [name for name in files[1::2] if (self.folder / name).exists()]
            self.assertEqual(written, files[1::2] if record["status"]["step"] >= 0 else [], status)
            if not written:
                self.assertIn(f"{status} ({record['status']['reason'][:40]}", done.err)
            for name in written:
                (self.folder / name).unlink()
        self.assertIn("cloud.xyz", self.taut("case", "./small.toml", "jakobsen", "--trajectory", "cloud.xyz", expect=2).err)

    def test_nobody_is_scored_before_it_passes(self):
        status = self.case(f"""external:cmd='python3 "{HERE}/wrong.py" down'""", "./small.toml", expect=1)["status"]
        self.assertEqual(status["kind"], "error")
        self.assertRegex(status["reason"], "not scored, free fall: .*it falls along")

    def test_json(self):
        told = self.answer("external", "probe", TOYS["cpp"])
        self.assertIs(facts_of(told)["passed"], True)
        self.assertEqual([c["check"] for c in rows_of(told, "checks")],
                         ["hello", "free fall", "time step", "pins", "moving pins", "same bits", "restart", "stretch", "bad requests", "end of input", "own word"])


if __name__ == "__main__":
    main()
