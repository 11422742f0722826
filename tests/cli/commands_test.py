#!/usr/bin/env python3
"""Output of the verbs, and the consequences of bad input: a message with its place, exit code 2, nothing written."""

import csv
import hashlib
import json
import os
import pathlib
import re
import shlex
import socket
import sqlite3
import struct
import subprocess
import time
import tomllib

from command_line import BINARIES, SCENE, CommandLine, facts_of, main, rows_of


class BadInput(CommandLine):
    def refuse(self, *words, says):
        before = sorted(self.folder.rglob("*"))
        process = self.taut(*words, expect=2)
        for text in [says] if isinstance(says, str) else says:
            self.assertIn(text, process.err)
        self.assertEqual(process.out, "")
        self.assertEqual(sorted(self.folder.rglob("*")), before, "nothing is written")

    def test_names(self):
        self.refuse("rnu", says="unknown verb 'rnu'; did you mean 'run'?")
        self.refuse("case", "hnag", "jakobsen", says="unknown scene 'hnag'; did you mean 'hang'?")
        self.refuse("case", "hang", "jakobsne", says="unknown solver 'jakobsne'; did you mean 'jakobsen'?")
        self.refuse("case", "hang", "jakobsen:iteration=3", says="did you mean 'iterations'?")
        self.refuse("run", "iteration", says="unknown study 'iteration'; did you mean 'iterations'?")
        self.refuse("case", "no/such.toml", "jakobsen", says="no/such.toml: no such scene file")
        for verb in (["run"], ["bench"], ["plot"], ["export"], ["report"]):
            self.refuse(*verb, "iterations", "--preset", "quikc", says="has no preset 'quikc'; did you mean 'quick'?")
        self.refuse("case", "/", "jakobsen", says="/ is a folder, not a scene file")
        self.refuse("bench", "hang", says="'hang' is a scene; --solver says what to time on it")
        self.refuse("case", "hang", "jakobsen", "--set", "cloth.mesh=none.obj", says='cloth.mesh is of type file, as in cloth.mesh="disc.obj"')
        self.refuse("case", "hang", "jakobsen", "--set", "nothing.mesh=none.obj", says='a text stands in quotes: key="text"')
        self.refuse("case", "hang", "jakobsen", "--set", "time.dt=fast", says="time.dt is of type number, as in time.dt=")
        self.refuse("case", "hang", "jakobsen", "--set", "span=0.9", says="unknown key 'span' in the scene; did you mean 'cloth.span'?")
        self.refuse("case", "hang", "jakobsen", "--fabric", "petrak-m7", says="'fabric' in the scene must be one of petrak-m1, ")
        self.refuse("plan", "drape:cloth.span=0.7", "jakobsen", says="settings of a scene stand alone: drape --set cloth.span=0.7")
        self.refuse("case", "hang", "jakobsen", "--jsno", says="'--jsno' is no option of this verb; did you mean '--json'?")
        self.refuse("frontier", "hang", "jakobsen", "--of", "wind.strenght", says="did you mean 'wind.strength'?")
        self.refuse("list", "key", says="unknown kind 'key'; did you mean 'keys'?")
        self.refuse("advise", "hnag", "--error", "1%", says="unknown scene 'hnag'; did you mean 'hang'?")
        self.refuse("advise", "hang", "--error", "1%", "--metric", "stretch.rsm", says="did you mean 'stretch.rms'?")
        self.refuse("advise", "hang", says="one of --error and --budget")
        self.refuse("advise", "hang", "--error", "1%", "--budget", 4, says="one of --error and --budget, not both")
        self.refuse("advise", "hang", "--error", "small", says="expected a number above 0 such as 0.01 or 1%")
        self.refuse("advise", "hang", "--error", "1%", "--solver", "bulet", says="did you mean 'bullet'?")
        self.refuse("advise", "hang", "--error", "1%", "--patience", -3, says="'-3' is not a number above 0")
        self.refuse("predict", "hang", "bulet", "--error", "1%", says="did you mean 'bullet'?")
        self.refuse("predict", "hang", "jakobsen", "--error", 5, says="5%")
        self.refuse("predict", "hang", "jakobsen", "--error", "1%", "--stiffness", 100, says="at most one of --error, --stiffness and --budget")
        self.refuse("run", "iterations", "--timeout", "-3", says="--timeout: '-3' is not a number above 0")

    def test_what_contradicts_itself(self):
        for words, both in ((["--dt", "1/60", "--set", "time.dt=0.1"], ["'time.dt=0.1'", "time.dt=\"1/60\""]),
                            (["--set", "cloth.mass=0.1", "--set", "cloth.mass = 0.2"], ["'cloth.mass=0.1'", "'cloth.mass = 0.2'"]),
                            (["--fabric", "petrak-m1", "--set", "bending.stiffness=1e-5"], ["'stiffness' in [bending]", 'fabric = "petrak-m1"']),
                            (["--fabric", "petrak-m1", "--set", "cloth.mass=3"], ["'mass' in [cloth]", 'fabric = "petrak-m1"'])):
            self.refuse("case", "./small.toml", "jakobsen", *words, says=both)
        for option in ("--from", "--to", "--of", "--dt", "--set"):
            self.refuse("frontier", "--all", "jakobsen", option, "1", says=[option, "--all"])

    def test_a_path_in_a_study_is_seen_from_the_study(self):
        (self.folder / "below").mkdir()
        (self.folder / "small.toml").rename(self.folder / "below/only_here.toml")
        (self.folder / "below/also.toml").write_text((self.folder / "below/only_here.toml").read_text())
        study = self.study("below/study.toml", scenes=["./only_here.toml", "also.toml:time.dt=0.01"],
                           rest='[[exclude]]\nscene = "./only_here.toml"\niterations = 4\n[axes]\niterations = [1, 4]\n')
        self.taut("run", study)
        self.assertEqual(len(self.records()), 3)
        self.refuse("run", self.study("below/study.toml", scenes=["./none.toml"]), says="below/none.toml: no such scene file")

    def test_a_message_says_what_would_be_right(self):
        self.refuse("run", self.study(scenes=["hang:cloth.grid=[12,12]"]), says="a value with a comma stands in quotes: key='[12, 12]'")
        self.refuse("run", self.study(scenes=["./none.toml"]), says=f"none.toml: no such scene file, seen from {self.folder}")
        self.taut("run", self.study())
        self.assertIn("before: no results folder to compare with results/runs", self.taut("report", "before", "results/runs", expect=2).err)
        self.assertIn("results/runs: 1 cases are there, but this build would run none of them", self.taut("report", "--json", "--out", "results/runs", expect=2).err)
        self.assertNotIn("store", json.loads(self.taut("cluster", "merge", "nothing", "--out", "new", "--json", expect=None).out or "{}").get("facts", {}))

    def test_numbers(self):
        for value in ["0", "-3", "many", "nan", "1e9", "1.5"]:
            if value != "0":
                self.refuse("case", "hang", f"jakobsen:iterations={value}", says=f"iterations={value}")
            self.refuse("case", "hang", f"jakobsen:substeps={value}", says=f"substeps={value}")
        for dt in ["0", "-0.01", "nan", "fast", "1/0"]:
            self.refuse("case", "hang", "jakobsen", "--dt", dt, says=f'time.dt="{dt}": column 9: ')
        self.refuse("case", "hang", "jakobsen:iterations=1e99,precision=quad,,omega=1,omega=2,itertions=1",
                    says=["column 10: jakobsen: iterations=1e99 is not a whole number", "column 26: jakobsen: precision=quad is not one of",
                          "column 41: jakobsen: expected key=value, got ''", "column 50: jakobsen: parameter 'omega' is given twice",
                          "column 58: jakobsen: unknown parameter 'itertions'; did you mean 'iterations'?"])
        self.refuse("case", "hang", "jakobsen:,,,", says=["column 10: ", "column 11: ", "column 12: ", "column 13: "])
        self.refuse("case", "hang", "jakobsen:", says="column 10: expected key=value")
        self.refuse("case", "hnag", "jakobsne:n=1,,", says=["unknown scene 'hnag'", "jakobsne:n=1,,: column 1: unknown solver 'jakobsne'",
                                                            "column 14: expected key=value", "column 15: expected key=value"])
        for words in (["bench", "hang"], ["render", "hang", "-o", "x.png"], ["advise", "hang", "--error", "1%"]):
            self.refuse(*words, "--solver", "jakobsne", "--solver", "bullet:iterations=-1,omega=2",
                        says=["jakobsne: column 1: unknown solver", "omega=2: column 8: bullet: iterations=-1 is outside",
                              "omega=2: column 22: bullet: unknown parameter 'omega'"])
        self.refuse("case", "hang", ":,,,", says=["column 1: unknown solver ''", *(f"column {i}: expected key=value" for i in (2, 3, 4, 5))])
        self.refuse("case", "hang", "xpbd:iterations=10000000", says="is outside 0 to 1e6")
        self.refuse("run", "iterations", "--shard", "5/4", says="shard 5/4 does not exist")
        self.refuse("run", "iterations", "--shard", "two", says="expected i/n")

    def test_a_study_with_many_mistakes_names_them_all(self):
        (self.folder / "bad.toml").write_text('''question = "?"
scenes = ["hang", "hnag"]
solvers = ["jakobsen:iterations=-1"]
sovers = []
[axes]
iteratons = [1, 2]
substeps = [1, 0]
[preset.quick]
scense = ["hang"]
[[plot]]
x = "iterations"
''')
        self.refuse("run", "./bad.toml",
                    says=["bad.toml:2:", "unknown scene 'hnag'; did you mean 'hang'?",
                          "bad.toml:3:22: jakobsen: iterations=-1 is outside",
                          "bad.toml:4:1: unknown key 'sovers'", "did you mean 'solvers'?",
                          "bad.toml:9:1: unknown key 'scense' in [preset.quick]; did you mean 'scenes'?",
                          "missing key 'kind'"])
        (self.folder / "bad.toml").write_text('''question = "?"
scenes = ["hang"]
solvers = ["jakobsen"]
[axes]
iteratons = [1, 2]
substeps = [1, 0]
"time.dt" = 3
''')
        self.refuse("run", "./bad.toml",
                    says=["bad.toml:5:1: no solver of this study has a parameter 'iteratons'; did you mean 'iterations'?",
                          "bad.toml:6:", "substeps=0 is outside", "bad.toml:7:", "must be a list of values or a range"])
        (self.folder / "bad.toml").write_text("question = ")
        self.refuse("run", "./bad.toml", says="bad.toml:1:")

    def test_exclusions_and_plots_are_judged_before_anything_runs(self):
        (self.folder / "bad.toml").write_text('''question = "?"
scenes = ["hang"]
solvers = ["jakobsen"]
exclude = [{ scen = "hang" }, { iteratons = 1 }]
[axes]
iterations = [1, 2]
[[plot]]
kind = "series"
colour = "red"
''')
        self.refuse("run", "./bad.toml",
                    says=["bad.toml:4:14: nothing that this study varies is called 'scen'; did you mean 'scene'?",
                          "'iteratons'; did you mean 'iterations'?", "bad.toml:9:1: unknown key 'colour' in [[plot]]"])
        plot = '[[plot]]\nkind = "convergance"\ny = "stretch.rmss"\n'
        self.refuse("run", self.study(rest=plot),
                    says=["study.toml:5:8: unknown kind of plot 'convergance'; did you mean 'convergence'?",
                          "study.toml:6:5: unknown value 'stretch.rmss'; did you mean 'stretch.rms'?"])
        nothing = self.taut("run", self.study(rest='exclude = [{ solver = "jakobsen" }]\n'), expect=4)
        self.assertIn("no case", nothing.err)

    def test_a_bad_scene_in_a_study_stops_all_of_it(self):
        (self.folder / "small.toml").write_text("[cloth]\ngrid = [1, 1]\nmas = 3\n")
        self.refuse("run", self.study(scenes=["hang", "./small.toml"]), says=["small.toml:", "unknown key 'mas'"])

    def test_a_swept_scene_key_that_does_not_exist(self):
        self.refuse("run", self.study(rest='[axes]\n"time.td" = [1]\n'), says="study.toml:5:14: time.td=1: unknown key 'td'")

    def test_a_bad_value_of_a_sweep_has_its_place_in_the_study(self):
        rest = 'set = ["time.duration=1", "cloth.mass=-2"]\n[axes]\n"time.dt" = ["1/64", -1]\n"forces.damping" = { from = -2, to = 1, steps = 2 }\n'
        self.refuse("run", self.study(solvers=["jakobsne", "bullet"], rest=rest), says="study.toml:3:13: unknown solver 'jakobsne'")
        for verb in (["run"], ["cluster", "submit", "--on", "slurm", "--dry-run"], ["plot"], ["export"], ["report"], ["bench"]):
            self.refuse(*verb, self.study(rest=rest),
                        says=["study.toml:4:27: cloth.mass=-2: 'mass' in [cloth]", "study.toml:6:22: time.dt=-1: 'dt' in [time]",
                              "study.toml:7:20: forces.damping=-2: 'damping' in [forces]"])
        self.refuse("run", self.study(rest='axes.order = ["mesh", "messh"]\naxes.iterations = [1, 1e99]\n'),
                    says=["study.toml:4:24: jakobsen: order=messh is not one of", "study.toml:5:23: jakobsen: iterations=1e+99 is not a whole number"])

    def test_a_shipped_scene_that_is_missing_is_named_by_verify(self):
        (self.folder / "scenes").mkdir()
        process = self.taut("verify", "-j", 2, "box-freeze", "box-halt", expect=2,
                            env={**os.environ, "TAUT_DATA": str(self.folder)})
        self.assertIn("unknown scene 'box'", process.err)


class Verbs(CommandLine):
    def test_plots_of_values_over_time_and_what_is_held_is_said(self):
        plot = '[[plot]]\nkind = "convergence"\nfile = "mine"\n'
        few = self.study("few.toml", rest="axes.iterations = [1, 2]\naxes.time.dt = [0.02, 0.01]\n" + plot)
        self.taut("run", few)
        drawn = self.taut("plot", few)
        curves = {row["label"] for row in csv.DictReader((self.folder / drawn.out.split()[0]).with_suffix(".csv").read_text().splitlines())}
        self.assertEqual(curves, {"Jakobsen"})
        self.assertIn("dt = 20.0\u00a0ms; 2 cases at other values are not drawn", drawn.err)
        study = self.study(rest="axes.iterations = [1, 2]\naxes.time.dt = [0.02, 0.01, 0.005, 0.004]\n" + plot)
        self.taut("run", study)
        drawn = self.taut("plot", study)
        self.assertIn("small-mine.svg", drawn.out)
        self.assertIn("6 cases at other values are not drawn", drawn.err)
        self.assertIn("dt = ", (self.folder / drawn.out.split()[0]).read_text())
        self.taut("run", self.study("two.toml", scenes=["./small.toml", "hang"], rest='set = ["time.duration=0.2"]\n' +
                                    "axes.iterations = [1, 2]\naxes.time.dt = [0.02, 0.01]\n" + plot))
        files = self.taut("plot", "./two.toml").out.split()
        self.assertEqual([pathlib.Path(name).name for name in files], ["mine.svg", "mine.pdf"], "a figure of both scenes")
        self.assertIn("set title 'hang, dt = 20.0", (self.folder / files[0]).with_suffix(".gp").read_text())
        files = self.taut("plot", "./two.toml", "--scene", "hang").out.split()
        self.assertEqual([pathlib.Path(name).name for name in files], ["hang-mine.svg", "hang-mine.pdf"])
        self.assertIn("did you mean 'hang'", self.taut("plot", "./two.toml", "--scene", "hnag", expect=2).err)
        series = self.taut("plot", study, "--kind", "series", "--y", "stretch.rms")
        self.assertIn("Jakobsen 5 × 2", (self.folder / series.out.split()[0]).with_suffix(".csv").read_text())

    def test_theory_is_drawn_beside_what_it_speaks_of(self):
        study = self.study(rest="axes.iterations = [1, 2, 4]\n")
        self.taut("run", study)
        for value, drawn in (("stretch.max", True), ("compression.max", False)):
            figure = self.folder / self.taut("plot", study, "--kind", "convergence", "--y", value).out.split()[0]
            self.assertEqual("theory of relaxation: 1/sweeps" in figure.with_suffix(".gp").read_text(), drawn, value)
        self.assertIn(" title 'Largest stretch over sweeps per substep, small",
                      (figure.parent / "small-convergence-stretch.max-over-iterations.gp").read_text())
        figure = self.folder / self.taut("plot", study, "--kind", "convergence", "--title", "Ours").out.split()[0]
        self.assertIn(" title 'Ours, small", figure.with_suffix(".gp").read_text())

    def test_a_run_ends_with_commands_that_work(self):
        self.study("a study.toml", rest="axes.iterations = [1, 2]\n" + '[[plot]]\nkind = "convergence"\n')
        said = self.taut("run", "./a study.toml", "--out", "other results").err
        commands = [shlex.split(line) for line in said.partition("next: ")[2].splitlines()]
        self.assertEqual([words[:2] for words in commands], [["taut", "report"], ["taut", "plot"], ["taut", "export"]])
        for words in commands:
            self.taut(*words[1:])
        self.assertEqual(len((self.folder / "table.csv").read_text().splitlines()), 3)

    def test_a_run_without_figures_ends_with_commands_that_work_too(self):
        said = self.taut("run", self.study(rest="axes.iterations = [1, 2]\n")).err
        for line in said.partition("next: ")[2].splitlines():
            self.taut(*shlex.split(line)[1:])

    def test_an_axis_of_one_solver_is_drawn_and_what_is_dropped_is_said(self):
        rest = 'axes."xpbd:structural" = [1e-5, 1e-4, 1e-3]\n[[plot]]\nkind = "convergence"\nx = "xpbd:structural"\n'
        study = self.study(solvers=["jakobsen", "xpbd"], rest=rest)
        self.taut("run", study)
        self.taut("plot", study, "-o", "figures")
        data, = (self.folder / "figures").glob("*.csv")
        rows = [(row["curve"], row["solver"], float(row["x"])) for row in csv.DictReader(data.open())]
        self.assertEqual(rows, [("0", "xpbd", x) for x in (1e-5, 1e-4, 1e-3)], "one curve")
        self.study(solvers=["jakobsen", "xpbd"], rest=rest + '[[plot]]\nkind = "contact"\n')
        self.assertIn("not drawn: ", self.taut("plot", study, "-o", "figures", expect=3).err)

    def test_what_only_a_preset_has_is_said(self):
        rest = 'axes.iterations = [1, 2]\n[preset.quick]\nset = ["time.duration=0.25"]\n[preset.half]\naxes.iterations = [1]\n'
        study = self.study(rest=rest + '[[plot]]\nkind = "convergence"\n')
        self.taut("run", study, "--preset", "quick")
        for verb in ("plot", "export", "report"):
            self.assertIn("preset quick has all of its results: --preset quick", self.taut(verb, study, expect=2).err)
            self.taut(verb, study, "--preset", "quick")
        model = json.loads(self.taut("report", study, "--preset", "quick", "--json", "--no-media").out)
        self.assertEqual(model["meta"]["command"], f"./taut run {study} --preset quick && ./taut report {study} --preset quick")
        self.taut("run", study, "--preset", "half")
        for verb in ("plot", "export"):
            said = self.taut(verb, study, expect=3)
            self.assertRegex(said.err, r"\b1 (of the 2 )?cases .*; preset half has all of its results: --preset half")
            self.assertTrue(said.out)

    def test_a_model_goes_where_it_is_told(self):
        study = self.study()
        self.taut("run", study)
        self.assertEqual(self.taut("report", study, "--json", "-o", "model.json").out, "model.json\n")
        model = json.loads((self.folder / "model.json").read_text())
        self.assertEqual(model.keys(), json.loads(self.taut("report", study, "--json").out).keys())

    def test_a_device_is_a_file_for_whoever_may_write_to_it(self):
        user = {"user": 65534} if os.getuid() == 0 else {}
        os.chmod(self.folder, 0o755)
        for device in ("/dev/stdout", "/dev/null"):
            line = f"{BINARIES}/taut case {self.folder}/small.toml jakobsen --final-state {device} | cat"  # a pipe that belongs to the user
            process = subprocess.run(["bash", "-o", "pipefail", "-c", line], cwd=self.folder, capture_output=True, text=True, **user)
            self.assertEqual(process.returncode, 0, process.stderr)
            self.assertEqual("vertex,x,y,z" in process.stdout, device == "/dev/stdout")

    def test_unequal_work_is_said_wherever_it_is_compared(self):
        plot = '[[plot]]\nkind = "convergence"\n'
        unequal = self.study("unequal.toml", solvers=["jakobsen:substeps=2", "bullet"], rest="axes.iterations = [1, 4]\n" + plot)
        equal = self.study("equal.toml", solvers=["jakobsen", "bullet:substeps=1", "jakobsen:substeps=1"], rest="axes.iterations = [1, 4]\n" + plot)
        words = "unequal work: Jakobsen 2 × 1 to 2 × 4, Bullet 1 × 1 to 1 × 4 (substeps × sweeps)"
        for study, said in ((unequal, self.assertIn), (equal, self.assertNotIn)):
            said(words if study == unequal else "unequal", self.taut("run", study).err)
            figure = self.folder / self.taut("plot", study).out.split()[0]
            said("unequal work", figure.with_suffix(".gp").read_text())
            self.assertIn("title 'Jakobsen", figure.with_suffix(".gp").read_text())
            self.taut("plot", study, "--solver", "bullet")
            self.assertNotIn("title 'Jakobsen", figure.with_suffix(".gp").read_text())
            self.assertIn("bullet", self.taut("plot", study, "--solver", "bulet", expect=2).err)
            method = json.loads(self.taut("report", study, "--no-media", "--json").out)["method"]
            said("U" + words[1:] if study == unequal else "nequal", method["studies"][0].get("unequal", ""))

    def test_targets_that_cannot_be_written_are_refused_before_the_work(self):
        study = self.study()
        self.taut("run", study)
        (self.folder / "file").write_text("")
        self.assertIn("is a folder; name a file in it", self.taut("report", study, "-o", ".", expect=2).err)
        for words in [["report", study, "-o", "file/x.html"], ["plot", study, "--kind", "series", "-o", "file"]]:
            self.assertIn("file", self.taut(*words, expect=2).err)
        for option in ("--final-state", "--series", "--trajectory"):
            started = time.monotonic()
            self.assertIn("file: cannot create", self.taut("case", "hang", "bullet:iterations=3000", option, "file/x.csv", expect=2).err)
            self.assertLess(time.monotonic() - started, 10, "it would take minutes")
        self.assertIn("taut run", self.taut("plot", study, "--out", "nowhere", expect=2).err)
        self.assertIn("no results folder nowhere; taut run makes it", self.taut("report", study, "--out", "nowhere", expect=2).err)
        self.assertRegex(self.taut("plot", study, "--kind", "pie", expect=2).err, "unknown kind of plot 'pie'.*one of .*stability")
        self.assertIn("--y: unknown value 'strech.rms'; did you mean 'stretch.rms'?",
                      self.taut("plot", study, "--y", "strech.rms", expect=2).err)
        text = (self.folder / study).read_text()
        (self.folder / study).write_text(text + '[[plot]]\nkind = "pie"\ny = "strech.rms"\n')
        refused = self.taut("plot", study, expect=2).err
        self.assertRegex(refused, r"study.toml:\d+:8: unknown kind of plot 'pie'")
        self.assertRegex(refused, r"study.toml:\d+:5: unknown value 'strech.rms'; did you mean 'stretch.rms'\?")
        (self.folder / study).write_text(text)
        self.assertIn("no folder", self.taut("check", "regression", expect=4).out)

    def test_the_version_names_release_build_and_compiler(self):
        self.assertRegex(self.taut("--version").out, r"^taut \d+\.\d+\.\d+\nprogram [0-9a-f]{10}\n\w+ \d+.*Bullet 3\.")

    def test_the_documentation_names_every_key_of_a_record(self):
        text = (pathlib.Path(__file__).parents[2] / "experiments/cli/README.md").read_text()
        keys = json.loads(self.taut("case", "./small.toml", "jakobsen", "--json").out)
        within = [f"{key}.{inner}" for key in ("status", "spec") for inner in keys.pop(key)]
        for key in [*keys, *within, *keys["step_cost"][0], *keys["resolved_settings"][0]]:
            self.assertIn(f"`{key}`", text)

    def test_every_verb_has_help_with_an_example(self):
        verbs = self.taut("--help").out
        named = re.findall(r"^  ([a-z]+) ", verbs, re.MULTILINE)
        self.assertGreater(len(named), 12)
        self.assertEqual(len(named), len(set(named)))
        for verb in [[name] for name in named] + [["bench", inner] for inner in ["effects", "scaling"]]:
            self.assertIn("Example:\n  taut " + " ".join(verb), self.taut(*verb, "--help").out)

    def test_every_example_of_every_help_is_understood(self):
        """Only the word added at the end is refused: options are judged in order, and --quiet is the last option of each verb."""
        verbs = [[name] for name in re.findall(r"^  ([a-z]+) ", self.taut("--help").out, re.MULTILINE)]
        verbs += [[verb, inner] for verb, inners in (("bench", ["effects", "scaling"]), ("external", ["probe", "score"]), ("cluster", ["submit", "status", "merge"]),
                                                     ("baseline", ["diff", "update"])) for inner in inners]
        examples = [example for verb in verbs for example in re.findall(r"^ +(taut [^\n]*?)(?: \|| &&| > |$)", self.taut(*verb, "--help").out, re.MULTILINE)]
        self.assertGreater(len(examples), 40)
        for example in examples:
            words = shlex.split(example)[1:]
            self.assertIn("Could not convert: --quiet", self.taut(*words, "--quiet=bogus", expect=2).err, example)

    def test_the_help_shows_verbs_in_groups_a_line_each(self):
        lines = self.taut("--help").out.splitlines()
        heads = ["Studies:", "One case:", "Cost:", "Trust:", "Extremes:"]
        self.assertEqual([line for line in lines if line in heads], heads)
        self.assertLess(max(map(len, lines)), 100)
        for gone in ["agree", "map", "table", "figures", "scaling"]:
            self.assertIn(f"unknown verb '{gone}'", self.taut(gone, expect=2).err)
            self.assertNotIn(f"  {gone} ", "\n".join(lines))

    def test_a_study_is_printed_as_a_table_of_a_value(self):
        study = self.study(solvers=["jakobsen:iterations=2", "xpbd"])
        out = self.taut("run", study, "--table", "stretch.rms").out
        head, first, second = out.splitlines()[:3]
        self.assertEqual(head.split(), ["stretch.rms", "small", "[%]"])
        self.assertEqual(first.split()[0], "jakobsen:iterations=2")
        rows = rows_of(self.answer("run", study, "--table", "stretch.rms"), "stretch.rms")
        self.assertEqual(f"{100 * rows[0]['small']:.3g}", f"{float(first.split()[1]):.3g}")
        self.assertIn("did you mean 'stretch.rms'?", self.taut("run", study, "--table", "strech.rms", expect=2).err)

    def test_json_says_how_a_run_went(self):
        said = self.answer("run", self.study())
        self.assertEqual((facts_of(said)["cases"], facts_of(said)["ran"], rows_of(said, "statuses")), (1, 1, [{"status": "ok", "cases": 1}]))

    def test_a_full_disk_behind_stdout_is_an_error(self):
        with open("/dev/full", "w") as full:
            process = subprocess.run([BINARIES / "taut", "list", "--json"], stdout=full, stderr=subprocess.PIPE, text=True)
        self.assertEqual((process.returncode, "cannot be written" in process.stderr), (2, True))

    def test_help_on_a_full_disk_is_an_error_too(self):
        for option in ("--help", "--help-all", "--version", "--man", "--bash-completion"):
            with open("/dev/full", "w") as full:
                process = subprocess.run([BINARIES / "taut", option], stdout=full, stderr=subprocess.PIPE, text=True, timeout=60)
            self.assertEqual(process.returncode, 2, option)
            self.assertIn("cannot be written", process.stderr)

    def test_a_terminal_gets_lines_of_its_width_and_a_pipe_whole_rows(self):
        shown, rows = self.on_a_terminal("list", "scenes", columns=100), self.taut("list", "scenes").out
        self.assertLessEqual(max(map(len, shown.splitlines())), 100)
        self.assertGreater(max(map(len, rows.splitlines())), 150)
        self.assertEqual(sorted(shown.split()), sorted(rows.split()))

    def test_truths_are_listed_by_name_and_section(self):
        all_of_4 = rows_of(self.answer("verify", "--list", "--section", 4), "truths")
        self.assertEqual({row["place"].split(".")[0] for row in all_of_4}, {"4"})
        one, = rows_of(self.answer("verify", all_of_4[1]["name"], "--list"), "truths")
        self.assertEqual(one, all_of_4[1])

    def test_the_main_job_names_studies_that_exist(self):
        job = tomllib.loads((pathlib.Path(__file__).parents[2] / "experiments/main-job.toml").read_text())
        known = {study["name"]: study["presets"].split(", ") for study in rows_of(self.answer("list", "studies"), "studies")}
        for study in [*job["studies"], *job["maps"], job["bench"]]:
            self.assertIn(job["preset"], known[study], study)

    def test_list(self):
        everything = self.answer("list")
        self.assertIn("hang", [scene["name"] for scene in rows_of(everything, "scenes")])
        self.assertIn(("jakobsen", "iterations"), [(p["solver"], p["name"]) for p in rows_of(everything, "parameters")])
        for value in rows_of(everything, "values"):
            self.assertTrue(value["unit"] and value["help"], value["name"])
        self.assertEqual({"iterations", "time-steps", "penetration"} - {s["name"] for s in rows_of(everything, "studies")}, set())
        self.assertRegex(self.taut("list", "metrics").out, r"stretch\.rms +1 ")

    def test_case_prints_a_record_and_its_final_state(self):
        run = self.taut("case", "./small.toml", "jakobsen:precision=double", "--dt", "1/128", "--duration", 0.25,
                        "--set", "cloth.grid=[5, 3]", "--json", "--final-state", "end.csv", "--series", "series.csv",
                        "--trajectory", "all.npy")
        record = json.loads(run.out)
        self.assertEqual((record["dt"], record["steps"], record["vertices"]), (1 / 128, 32, 15))
        self.assertEqual(record["status"]["kind"], "ok")
        rows = list(csv.DictReader((self.folder / "end.csv").read_text().splitlines()))
        self.assertEqual(list(rows[0]), ["vertex", "x", "y", "z", "vx", "vy", "vz"])
        self.assertEqual(len(rows), 15)
        # The texts stand for the same doubles: their bits have the digest of the state in the record.
        bits = b"".join(b"".join(struct.pack("<3d", *(float(row[key]) for key in keys)) for row in rows) + b"|"
                        for keys in (("x", "y", "z"), ("vx", "vy", "vz")))
        self.assertEqual(hashlib.sha256(bits).hexdigest(), record["digest"])
        self.assertEqual(len((self.folder / "series.csv").read_text().splitlines()), 34)
        self.assertEqual((self.folder / "all.npy").read_bytes()[:6], b"\x93NUMPY")

    def test_a_case_says_how_far_it_is_and_what_the_settings_became(self):
        words = ["case", "./small.toml", "jakobsen", "--dt", "1/128", "--duration", 0.25, "--json"]
        verbose, plain = self.taut(*words, "--verbose"), self.taut(*words)
        self.assertEqual((verbose.out, plain.err), (plain.out, ""))
        # A line for each of 32 steps, and one at the end: at rest in the first, then falling.
        steps = re.findall(r"^step (\d+)/32  t (\S+) s  fastest vertex (\S+) m/s$", verbose.err, re.MULTILINE)
        self.assertEqual([(int(n), float(t)) for n, t, _ in steps], [(n, float(f"{n / 128:.6g}")) for n in range(33)])
        self.assertEqual(float(steps[0][2]), 0)
        self.assertGreater(float(steps[3][2]), 0)
        for name, value in ((one["name"], one["text"]) for one in json.loads(plain.out)["resolved_settings"]):
            self.assertIn(f"{name}: {value}\n", verbose.err)

    def test_float_bullet_runs_in_its_own_program(self):
        for precision in ["float", "double"]:
            run = self.taut("case", "./small.toml", f"bullet:precision={precision}", "--json")
            self.assertEqual(json.loads(run.out)["params"]["precision"], precision)
        self.taut("run", self.study(solvers=["bullet:precision=float", "bullet:precision=double"]))
        self.assertEqual({r["status"]["kind"] for r in self.records()}, {"ok"})
        self.assertEqual(len({r["digest"] for r in self.records()}), 2)

    def test_case_and_study_agree(self):
        self.taut("run", self.study(solvers=["jakobsen:iterations=4"]))
        alone = json.loads(self.taut("case", "./small.toml", "jakobsen:iterations=4", "--json").out)
        self.assertEqual(self.records(), [alone])

    QUICK = ("--rounds", 4, "--seconds", 0.002, "--json")

    def advise(self, *words, expect=0):
        return json.loads(self.taut("advise", "./small.toml", *words, *self.QUICK, expect=expect).out)

    def test_advice_holds_when_it_is_followed(self):
        answer = self.advise("--error", "0.1%", "--solver", "jakobsen", "--solver", "bullet")
        said = facts_of(answer)
        self.assertLessEqual(said["error"], 0.001)
        self.assertIs(said["same_bits"], True)
        solvers = rows_of(answer, "solvers")
        self.assertEqual({row["solver"] for row in solvers}, {"jakobsen", "bullet"})
        rival, = [row for row in solvers if row["setting"] != said["best"]]
        self.assertGreater(rival["times"][1], 1)
        alone = json.loads(self.taut("case", "./small.toml", said["best"], "--json").out)
        self.assertEqual(alone["values"]["stretch.rms"], said["error"])
        for other in rows_of(answer, "tried"):  # no tried setting that reaches the error is far cheaper
            if not other["refused"] and other["error"] is not None and other["error"] <= 0.001:
                self.assertGreater(other["quick_cost"], 0.3 * said["cost"][1])
        self.taut(*shlex.split(said["command"])[1:], "--rounds", 2, "--seconds", 0.002)

    def test_every_solver_stands_among_the_bests_or_why_not(self):
        answer = self.advise("--error", "1%", expect=None)
        rows = {row["solver"]: row for row in rows_of(answer, "solvers")}
        known = {row["name"] for row in rows_of(self.answer("list", "solvers"), "solvers")} - {"external", "positions"}
        self.assertEqual(set(rows), known)
        self.assertTrue(all(row["cost"] or row["note"] for row in rows.values()), rows)
        self.assertGreater(sum(not row["cost"] for row in rows.values()), 0, "at most five are timed")

    def test_a_study_is_searched_with_equal_time_for_all_and_runs_what_was_found(self):
        (self.folder / "mine.toml").write_text('''
question = "?"
scenes = ["./small.toml"]
solvers = ["jakobsen:threads=1", "bullet", "mass-spring"]
searched = "mine-searched.toml"
''')
        self.assertIn("`taut advise --study mine` searches them", self.taut("run", "./mine.toml", expect=2).err)
        answer = self.answer("advise", "--study", "./mine.toml", "--cpu", 0.02)
        found = tomllib.loads((self.folder / "mine-searched.toml").read_text())
        searched = {row["solver"]: row for row in rows_of(answer, "searched")}
        for name in ("jakobsen:threads=1", "bullet", "mass-spring"):
            rows = [row for row in found["tried"] if row["solver"].split(":")[0] == name.split(":")[0]]
            self.assertEqual(len(rows), searched[name]["tried"])
            self.assertTrue(rows[0]["cheapest"])
            dearest = max(row.get("cost", 0) for row in rows)
            self.assertLess(searched[name]["cpu"], 0.02 + 2 * dearest, "the last run alone may go beyond")
            for kind in ("plain", "best"):
                for level in (0.1, 0.03, 0.01, 0.003, 0.001):
                    reach = [row for row in rows if "refused" not in row and row.get("error", 1) <= level
                             and (kind == "best" or not any(f"{word}=" in row["solver"] for word in ("omega", "levels", "tethers", "stiffness")))]
                    chosen = [row for row in rows if level in row.get(kind, [])]
                    self.assertEqual(len(chosen), bool(reach), (name, kind, level))
                    if reach:
                        self.assertEqual(chosen[0]["cost"], min(row["cost"] for row in reach))
                    elif kind == "best":
                        self.assertTrue(any(f"{name}, stretch.rms <= {level}:" in why for why in found["missing"]))
        chosen = [row["solver"] for row in found["tried"] if row.get("cheapest") or row.get("plain") or row.get("best")]
        cases = facts_of(self.answer("run", "./mine.toml"))["cases"]
        self.assertTrue(len(chosen) <= cases <= len(chosen) + 3, "the chosen settings and each solver as it comes")
        file = self.folder / "mine-searched.toml"
        sent = "mass-spring:structural=777,substeps=37"
        file.write_text(file.read_text().replace("tried = [", f'tried = [\n  {{ scene = "./small.toml", solver = "{sent}", error = 0.01, best = [0.001] }},', 1))
        self.answer("advise", "--study", "./mine.toml", "--cpu", 0.5)
        again = [row["solver"] for row in tomllib.loads(file.read_text())["tried"]]
        self.assertEqual(set(chosen + [sent]) - set(again), set(), "a search begins with what was best, and with a setting that an author sent")

    def test_advice_is_clear_only_when_it_was_confirmed_and_the_search_has_ended(self):
        for patience in [3, 120]:
            said = facts_of(self.advise("--error", "0.3%", "--patience", patience, expect=None))
            self.assertLess(said["seconds"], 1.1 * patience + 1)
            inside = said["cost"][0] <= said["again"][1] <= said["cost"][2]
            self.assertEqual(said["confirmed"], inside)
            if not (inside and said["complete"]):
                self.assertNotEqual(said["certainty"], "clear")
        self.assertTrue(said["complete"])
        refused = [t["refused"] for t in rows_of(self.advise("--error", "0.3%", "--solver", "mass-spring"), "tried") if t["refused"]]
        self.assertTrue(all(re.match(r"exploded \(", why) for why in refused) and refused, refused)

    def test_advice_uses_its_time_and_searches_all_before_it_refines_one(self):
        patience = 10
        done = self.taut("advise", "./small.toml", "--error", "0.1%", "--patience", patience, "--json", expect=None)
        answer = json.loads(done.out)
        said, left = facts_of(answer), rows_of(answer, "not_done")
        self.assertTrue(said["complete"] or said["seconds"] > 0.6 * patience, said)
        self.assertLess(said["seconds"], 1.1 * patience + 1)
        unsearched = [row["solver"] for row in left if row["what"] == "search"]
        self.assertEqual("INCOMPLETE" in answer["subject"], bool(unsearched))
        self.assertEqual(done.returncode, 3 if unsearched else 0)
        tried = [row["setting"] for row in rows_of(answer, "tried")]
        self.assertEqual(len(tried), len(set(tried)), "each once")
        if any("omega=" in setting for setting in tried):  # the cheap jakobsen is refined only after the others were searched
            self.assertLess({"xpbd", "pd", "bullet"}, {setting.partition(":")[0] for setting in tried[:tried.index(
                next(setting for setting in tried if "omega=" in setting))]})
        hurried = self.taut("advise", "./small.toml", "--error", "0.1%", "--patience", 0.05, "--out", "new", "--json", expect=None)
        self.assertIn(hurried.returncode, (3, 4))
        self.assertIn("INCOMPLETE", json.loads(hurried.out)["subject"])

    def test_the_bench_and_the_advice_name_the_same_solver(self):
        answer = self.advise("--error", "1%", "--solver", "jakobsen", "--solver", "bullet")
        best = facts_of(answer)["best"]
        rival, = [row["setting"] for row in rows_of(answer, "solvers") if row["setting"] != best]
        study = self.study(solvers=[best, rival])
        best, rival = (row["cpu"][1] for row in rows_of(self.answer("bench", study, "--seconds", 0.002), "cases"))
        self.assertLess(best, rival)

    def test_advice_keeps_what_it_is_asked_to_keep(self):
        scene = SCENE.replace("[time]", '[[collider]]\ntype = "ball"\ncenter = [-0.6, -0.6, 0.05]\nradius = 0.25\n[time]')
        (self.folder / "small.toml").write_text(scene.replace("duration = 0.5", "duration = 1"))
        loose = self.advise("--error", "30%", "--solver", "bullet", "--keep", "nothing")
        self.assertEqual(rows_of(loose, "kept"), [])
        setting = facts_of(loose)["best"]
        deep = json.loads(self.taut("case", "./small.toml", setting, "--json").out)["values"]["penetration.peak"]
        limit = f"{1e3 * deep / 2}mm"
        strict = self.advise("--error", "30%", "--solver", "bullet", "--keep", f"penetration.peak:{limit}", expect=None)
        self.assertEqual([row["value"] for row in rows_of(strict, "kept")], ["penetration.peak"])
        refused = " ".join(one["refused"] for one in rows_of(strict, "tried"))
        self.assertRegex(refused, r"penetration\.peak \S+ mm, more than \S+ mm")
        kept, = [row["best"] for row in rows_of(strict, "kept")]
        self.assertNotEqual(facts_of(strict)["best"], setting)
        self.assertLessEqual(kept or 0, deep / 2)
        usual = [row["value"] for row in rows_of(self.advise("--error", "30%", "--solver", "jakobsen", expect=None), "kept")]
        self.assertEqual(usual, ["penetration.peak", "tunnelling.events"], "the error says how much stretch there may be")
        within = self.advise("--budget", 1, "--solver", "jakobsen", expect=None)
        self.assertEqual({row["value"]: row["limit"] for row in rows_of(within, "kept")}["stretch.rms"], 0.1)
        for wrong in ("penetration.peek:1mm", "penetration.peak", "penetration.peak:1kg", "shape:1%", "tunnelling.count:1%"):
            self.taut("advise", "./small.toml", "--error", "1%", "--keep", wrong, expect=2)

    def test_a_budget_below_one_sweep_is_unreachable_at_once(self):
        said = self.advise("--budget", 1e-6, "--solver", "jakobsen", "--set", "wind.velocity=[1, 0, 0]", expect=4)
        self.assertEqual(said["facts"]["best"]["note"], "unreachable")
        self.assertEqual(rows_of(said, "tried"), [], "nothing was run")
        without = rows_of(said, "without")
        self.assertIn("wind", [row["effect"] for row in without])
        self.assertEqual([row["cost"] for row in without], sorted(row["cost"] for row in without))
        self.assertGreater(facts_of(said)["cheapest_cost"], 1e-9 * 60)
        self.assertIn("ms a frame", self.taut("advise", "./small.toml", "--budget", 1e-6, "--solver", "jakobsen", expect=4).out)

    def test_a_cost_is_compared_on_one_cloth(self):
        study = self.study(solvers=["jakobsen:iterations=1", "bullet:iterations=1"], rest='axes."cloth.grid" = [[4, 4], [8, 8]]\n')
        few = ["--rounds", 1, "--seconds", 0.001]
        bench = self.answer("bench", study, *few)
        self.assertEqual([row["scene"] for row in rows_of(bench, "scenes")], [f"small (cloth.grid=[{side}, {side}])" for side in (4, 8)])
        for row in rows_of(bench, "cases"):
            self.assertIn(row["scene"].removeprefix("small (").removesuffix(")").replace(" ", ""), row["case"])
        cost = json.loads(self.taut("report", study, "--json").out)["cost"]["scenes"]
        self.assertEqual(len(cost), 2)

    def test_cases_that_were_not_timed_in_turns_are_not_compared(self):
        study = self.study(solvers=["jakobsen:iterations=1", "bullet:iterations=1"], rest='axes."cloth.grid" = [[4, 4], [5, 5], [6, 6]]\n')
        self.taut("bench", "scaling", study, "--samples", 2)
        page = json.loads(self.taut("report", study, "--json").out)
        self.assertNotIn("cost", page)
        self.assertFalse({"price", "equal_cost", "setting"} & set(page["answer"]["tables"]))
        self.assertTrue(all("cpu.per_step" in case["values"] for case in page["cases"]), "the costs are there")

    def test_an_error_is_five_per_cent_or_refused(self):
        for text in ("5", "1"):
            said = self.taut("advise", "hang", "--error", text, expect=2).err
            self.assertIn(f"--error {text}: {text}% or {100 * int(text)}%?", said)

    def test_a_budget_is_of_a_frame_of_the_frames_a_second(self):
        cost = {}
        for fps in (60, 30):
            answer = self.advise("--budget", 0.01, "--fps", fps, "--solver", "jakobsen")
            self.assertIn(f"within 0.01 ms a frame of 1/{fps} s", answer["subject"])
            self.assertLessEqual(facts_of(answer)["cost"][1], 0.01e-3 * fps)
            cost[fps] = answer["facts"]["cost"]
        self.assertAlmostEqual(cost[30]["scale"], 2 * cost[60]["scale"])

    def test_of_a_search_that_was_ended_nothing_is_best(self):
        said = self.taut("advise", "hang", "--error", "0.1%", "--patience", 2, expect=None)
        if "INCOMPLETE" not in said.out:
            self.skipTest("two seconds were enough for all solvers")
        self.assertNotRegex(said.out, r"(?m)^ *best  ")
        if said.returncode == 3:
            self.assertRegex(said.out, r"cheapest so far; (\d+ solvers? not tried(, )?)?(\d+ solvers? not searched to the end)?")

    def test_several_solvers_have_one_table_of_frontiers_with_what_is_acceptable(self):
        loose, strict = ({row["solver"]: row for row in rows_of(self.answer(
            "frontier", "./small.toml", "jakobsen:iterations=4", "xpbd", "--tolerance", 0.3, "--keep", keep), "frontiers")}
            for keep in ("stretch.rms:1000%", "stretch.rms:2%"))
        self.assertEqual(list(loose), ["jakobsen:iterations=4", "xpbd"])
        for solver, row in strict.items():
            self.assertEqual(row["stable"], loose[solver]["stable"])
            if isinstance(row["acceptable"], float):
                self.assertLess(row["acceptable"], row["stable"])
            self.assertRegex(row["acceptable_end"], r"stretch\.rms \S+ %, more than 2 %")
        one = self.answer("frontier", "./small.toml", "xpbd", "--tolerance", 0.3, "--keep", "stretch.rms:2%")["facts"]["acceptable"]
        self.assertEqual(one["value"], strict["xpbd"]["acceptable"])
        self.assertIn("more than 2 %", one["note"])
        self.taut("frontier", "./small.toml", "xpbd", "--keep", "stretch.rmz:2%", expect=2)

    def test_a_study_runs_at_two_time_steps_beside_its_own(self):
        study = self.study(solvers=["jakobsen:iterations=2"], rest='axes.time.dt = ["1/64"]\n')
        table = self.taut("run", study, "--dt", "1/32", "--dt", "1/16", "--table", "stretch.rms").out
        self.assertEqual([line.split()[0] for line in table.splitlines() if "dt=" in line], ["jakobsen:iterations=2"] * 2)
        self.assertEqual(sorted(r["dt"] for r in self.records()), [1 / 32, 1 / 16])
        self.taut("run", study)
        self.assertEqual(len(self.records()), 3)
        self.taut("run", "--dt", "1/32", expect=2)

    def test_a_figure_is_as_wide_as_it_is_asked_to_be(self):
        study = self.study(solvers=["jakobsen", "bullet"], rest='axes.iterations = [1, 4, 16]\n[[plot]]\nkind = "convergence"\nfile = "mine"\n')
        self.taut("run", study)
        pdf = next(line for line in self.taut("plot", study, "--width", "84mm", "--height", "60mm", "--no-title").out.splitlines() if line.endswith(".pdf"))
        box = re.search(rb"/MediaBox \[ 0 0 ([0-9.]+) ([0-9.]+) \]", (self.folder / pdf).read_bytes())
        self.assertEqual([round(float(side) * 25.4 / 72) for side in box.groups()], [84, 60])
        script = (self.folder / pdf).with_suffix(".gp").read_text()
        self.assertNotIn(" title 'RMS", script)
        for wrong in (("--width", "84"), ("--font", "8mm"), ("--width", "20mm"), ("--width", "84mm", "--height", "20mm"), ("--width", "0mm")):
            self.taut("plot", study, *wrong, expect=2)

    def test_list_shows_the_parameters_of_one_solver(self):
        one = self.answer("list", "jakobsen")
        self.assertEqual({row["solver"] for row in rows_of(one, "parameters")}, {"jakobsen"})
        self.assertIn("omega", [row["name"] for row in rows_of(one, "parameters")])
        self.taut("list", "jakobson", expect=2)

    def test_many_cases_are_tenths_and_all_of_them_lines_if_asked_for(self):
        study = self.study(solvers=["jakobsen"], rest=f"axes.iterations = {list(range(1, 31))}\n")
        lines = self.taut("run", study).err.splitlines()
        tenths = [line for line in lines if line.startswith("[") and "  left " in line]
        self.assertTrue(9 <= len(tenths) <= 11, lines)
        self.assertEqual([line for line in lines if "jakobsen:iterations=7" in line], [])
        self.assertIn("study: 30 cases: ok 30", lines)
        other = self.study("other.toml", solvers=["xpbd"], rest=f"axes.iterations = {list(range(1, 31))}\n")
        self.assertEqual(len([line for line in self.taut("run", other, "--verbose").err.splitlines() if line.endswith(": ok")]), 30)

    def test_a_budget_is_kept_and_what_cannot_be_had_is_said(self):
        answer = self.advise("--budget", 0.01, "--solver", "jakobsen")
        self.assertLessEqual(facts_of(answer)["cost"][1], 0.01e-3 * 60)
        never = self.advise("--error", "1e-12", "--solver", "xpbd:iterations=1,substeps=2", expect=4)
        self.assertEqual((facts_of(never)["best"], len(rows_of(never, "tried")) > 0), (None, True))

    def test_a_whole_number_of_six_digits_is_one(self):
        run = self.taut("case", "./small.toml", "xpbd:iterations=100000", "--dt", "0.25", "--json")
        self.assertEqual(json.loads(run.out)["params"]["iterations"], "100000")
        self.taut("run", self.study(solvers=["xpbd"], rest='set = ["time.dt=0.25"]\naxes.iterations = [100000]\n'))

    def test_export_is_one_tidy_table(self):
        study = self.study(solvers=["jakobsen:iterations=2", "xpbd"],
                           rest='set = ["forces.damping =  0.5 "]\naxes.time.dt = ["1/64", "1/32"]\n')
        self.assertRegex(self.taut("export", study, expect=2).err, r"taut run \S*study\.toml makes them")
        self.taut("run", study)
        self.assertEqual(self.taut("export", study, "-o", "x.csv").out, "x.csv\n")
        text = (self.folder / "x.csv").read_text()
        rows = list(csv.DictReader(text.splitlines()))
        self.assertEqual([(r["solver"], r["time.dt"]) for r in rows],
                         [(s, dt) for dt in ["1/64", "1/32"] for s in ["jakobsen", "xpbd"]])
        self.assertEqual((rows[0]["iterations"], rows[0]["forces.damping"]), ("2", "0.5"))
        by_key = {r["key"]: r for r in self.records()}
        for row in rows:
            record = by_key[row["key"]]
            self.assertEqual(float(row["stretch.rms"]), record["values"]["stretch.rms"])
            self.assertEqual((row["status"], float(row["dt"])), ("ok", record["dt"]))
        self.assertNotIn("cpu.per_second", rows[0])
        self.taut("bench", study, "--rounds", 2, "--seconds", 0.001, "--quiet")
        priced = list(csv.DictReader(self.taut("export", study).out.splitlines()))
        for row in priced:
            self.assertEqual(row["cpu.host"], socket.gethostname())
            self.assertLessEqual(float(row["cpu.per_second.low"]), float(row["cpu.per_second"]))
        tidy = list(csv.DictReader(self.taut("export", study, "--tidy").out.splitlines()))
        series = list(csv.DictReader(self.taut("export", study, "--series").out.splitlines()))
        for row in rows:
            one, = [t for t in tidy if t["key"] == row["key"] and t["metric"] == "stretch.rms"]
            self.assertEqual((one["value"], one["unit"], one["status"]), (row["stretch.rms"], "1", "ok"))
            steps = [s for s in series if s["key"] == row["key"] and s["metric"] == "stretch.rms"]
            self.assertEqual(len(steps), int(row["steps"]) + 1)
            self.assertEqual(sorted(float(s["t"]) for s in steps)[-1], float(row["dt"]) * int(row["steps"]))
        more = self.study(solvers=["jakobsen:iterations=2", "xpbd", "bullet"],
                          rest='set = ["forces.damping=0.5"]\naxes.time.dt = ["1/64", "1/32"]\n')
        missing = self.taut("export", more, expect=3)
        self.assertEqual(missing.out.count(",not run,"), 2)

    def test_a_bench_says_how_many_times_the_first_each_costs(self):
        study = self.study(rest="axes.iterations = [1, 256]\n")
        first, other = rows_of(self.answer("bench", study, *self.QUICK), "cases")
        self.assertIsNone(first["times"])
        self.assertGreater(other["cost"][1], 2 * first["cost"][1])
        self.assertGreater(other["times"][1], 2)
        self.assertNotIn("cheaper", other["verdict"])

    def test_the_failure_map_has_the_costs_of_a_bench(self):
        study = self.study(solvers=["implicit:iterations=3", "pd"], rest='axes."links.stiffness" = [{ structural = 1e3, shear = 1e3 }, { structural = 1e6, shear = 1e6 }]\n')

        def numbers():
            table = self.answer("run", study, "--table", "failure_map")["tables"]["failure_map"]
            return [one["note"] for one in table["notes"]]
        self.assertFalse(any("a simulated second" in one for one in numbers()), "nothing was timed yet")
        self.taut("bench", study, "--rounds", 2, "--seconds", 0.001, "--quiet")
        self.assertEqual(len(numbers()), 4)
        for one in numbers():
            self.assertRegex(one, r"strain .*, \S+\s.?s a simulated second$")

    def test_of_a_key_that_is_set_twice_export_has_what_the_case_ran(self):
        study = self.study(scenes=["./small.toml:time.duration=0.25"], rest='set = ["time.duration=0.375", "time.dt=\'1/32\'"]\n')
        self.taut("run", study)
        row, = csv.DictReader(self.taut("export", study).out.splitlines())
        self.assertEqual((float(row["time.duration"]), int(row["steps"])), (0.25, 8))

    def test_a_damaged_case_is_no_row_of_a_table(self):
        study = self.study(rest="axes.iterations = [1, 2]\n")
        self.taut("run", study)
        with sqlite3.connect(self.folder / "results/runs/results.db") as store:
            store.execute("UPDATE numbers SET value = 2 * value WHERE case_id = 1")
        for option in ([], ["--tidy"], ["--series"]):
            done = self.taut("export", study, *option, expect=3)
            self.assertIn("damaged case", done.err)
            self.assertIn("1 cases are damaged and left empty", done.err)
            rows = list(csv.DictReader(done.out.splitlines()))
            self.assertEqual(len({row["key"] for row in rows if row.get("status", "ok") == "ok" and row.get("value", "1") != ""}), 1)
            if not option:
                damaged, = [row for row in rows if row["status"] == "damaged"]
                self.assertEqual((damaged["stretch.rms"], damaged["dt"]), ("", ""))

    def test_no_cell_of_a_table_is_a_formula(self):
        (self.folder / "=1+1.toml").write_text((self.folder / "small.toml").read_text())
        study = self.study(scenes=["./=1+1.toml"])
        self.taut("run", study)
        row, = csv.DictReader(self.taut("export", study).out.splitlines())
        self.assertEqual(row["scene"], "'=1+1")
        self.assertEqual(row["case"][0], "'")

    def test_what_new_writes_runs(self):
        self.taut("new", "study", "mine")
        self.assertIn("already exists", self.taut("new", "study", "mine", expect=2).err)
        self.assertIn("ok 6", self.taut("run", "./mine.toml").err)
        self.assertIn("mine", self.taut("run", "./mine.toml", "--table", "stretch.rms").err)
        self.taut("new", "scene", "cloth")
        self.assertEqual(json.loads(self.taut("case", "./cloth.toml", "jakobsen", "--json").out)["status"]["kind"], "ok")
        for name in ["../../x y", "a;b", ".hidden", "a\nb"]:
            self.taut("new", "scene", name, expect=2)

    def test_a_scene_by_its_seed(self):
        for seed in range(1, 6):  # 4 is a mesh
            with self.subTest(seed=seed):
                self.taut("new", "scene", f"drawn{seed}", "--seed", seed, *["--contact"] * (seed % 2))
                run = json.loads(self.taut("case", f"./drawn{seed}.toml", "jakobsen:iterations=1", "--set", "time.duration=1", "--json").out)
                self.assertEqual(run["status"]["kind"], "ok")
        first = (self.folder / "drawn1.toml").read_text()
        (self.folder / "drawn1.toml").unlink()
        self.taut("new", "scene", "drawn1", "--seed", "1", "--contact")
        self.assertEqual((self.folder / "drawn1.toml").read_text(), first)
        self.assertIn("taut new scene drawn1 --seed 1 --contact", first)
        names = json.loads(self.taut("new", "scene", "again", "--seed", 4, "--json").out)
        self.assertEqual(len(list(self.folder.glob("again.*"))), 2, names)
        (self.folder / "again.toml").unlink()
        self.assertIn("again.obj already exists", self.taut("new", "scene", "again", "--seed", 4, expect=2).err)
        self.assertFalse((self.folder / "again.toml").exists())
        for words, why in [(["scene", "no", "--seed", "-1"], "--seed: '-1'"), (["scene", "no", "--seed", "1.5"], "--seed: '1.5'"),
                           (["study", "no", "--seed", "1"], "--seed draws a scene"), (["scene", "no", "--contact"], "--seed")]:
            self.assertIn(why, self.taut("new", *words, expect=2).err)
        self.assertFalse((self.folder / "no.toml").exists())

    def test_a_reference_goes_to_the_results_and_replaces_nothing_unasked(self):
        (self.folder / "hang.toml").write_text((self.folder / "small.toml").read_text().replace('["top-left"]', '["top"]'))
        own = {**os.environ, "TAUT_RESULTS": str(self.folder / "own")}
        self.taut("reference", "./hang.toml", env=own)
        kept = self.folder / "own/references/hang/static.json"
        before = kept.read_bytes()
        self.assertFalse((self.folder / "results").exists())
        self.assertIn("--replace computes it again", self.taut("reference", "./hang.toml", env=own, expect=4).out)
        self.taut("reference", "./hang.toml", "--replace", env=own)
        self.assertEqual(kept.read_bytes(), before)
        record = json.loads(self.taut("case", "./hang.toml", "jakobsen", "--json", env=own).out)
        self.assertLess(record["values"]["reference.rms"], 1)
        self.assertIsNone(json.loads(self.taut("case", "./hang.toml", "jakobsen", "--json").out)["values"].get("reference.rms"))
        (self.folder / "hang.toml").write_text((self.folder / "hang.toml").read_text().replace("[4, 4]", "[5, 4]"))
        self.taut("reference", "./hang.toml", env=own)
        self.assertEqual(kept.read_bytes(), before, "another scene of that name")
        self.assertEqual(len(list(kept.parent.glob("static*.json"))), 2)

    def test_plan(self):
        plan = self.answer("plan", "./small.toml", "jakobsen:iterations=2,substeps=3")
        structural, = [p for p in rows_of(plan, "passes") if p["pass"] == "structural"]
        self.assertEqual((structural["items"], structural["repeats"]), (24, 6))
        self.assertIn("projections", self.taut("plan", "hang", "bullet").out)
        small, large = (facts_of(self.answer("plan", "hang", "pd", "--set", f"cloth.grid=[{n}, {n}]"))["set_up"] for n in (8, 64))
        self.assertTrue(0 < 5 * small < large < 10, "the factor's: 64 times the vertices")

    def test_a_long_plan_says_so_before_it_begins(self):
        long = self.taut("plan", "hang", "jakobsen", "--set", "cloth.grid=[320, 320]").err
        self.assertRegex(long, r"setting up 102400 vertices and \d+ links: it may take some seconds per million")
        self.assertNotIn("setting up", self.taut("plan", "hang", "jakobsen").err)

    def test_scaling_at_an_error_finds_the_fewest_sweeps(self):
        bench = self.answer("bench", "scaling", "--error", "2%", "--preset", "quick", "--samples", "1")
        sizes = rows_of(bench, "sizes")
        self.assertEqual([row["vertices"] for row in sizes], [64, 144, 256] * 2)
        for row in sizes:
            self.assertLessEqual(row["stretch.rms"], 0.02)
            name, count = ("substeps", "substeps=") if "order=mesh" not in row["run"] else ("iterations", "iterations=")
            found = int(row["run"].split(count)[1].split(",")[0]) if count in row["run"] else {"iterations": 3, "substeps": 5}[name]
            side = round(row["vertices"] ** 0.5)
            fewer = row["setting"] + f",{name}={found - 1 - found // 20}"
            less = self.answer("case", "hang", fewer, "--set", f"cloth.grid=[{side}, {side}]", "--set", "forces.damping=2", "--duration", "2")
            self.assertGreater(less["values"]["stretch.rms"], 0.02, row)

    def test_doctor(self):
        report = self.answer("doctor")
        good = {finding["name"]: finding["good"] for finding in rows_of(report, "findings")}
        self.assertIn("toolchain", good)
        noise = [good.get(name, True) for name in ("load", "clock", "same code, twice")]
        self.assertEqual(facts_of(report)["timing_trusted"], all(noise))
        made_of = {row["solver"]: row for row in rows_of(report, "fingerprints")}
        self.assertEqual(made_of["vbd"]["layer"], made_of["jakobsen"]["layer"])
        self.assertNotEqual(made_of["vbd"]["digest"], made_of["jakobsen"]["digest"])
        self.assertNotIn(made_of["vbd"]["digest"], self.taut("doctor").out)
        self.assertIn(made_of["vbd"]["digest"], self.taut("doctor", "--all").out)

    def test_effects_are_timed_beside_the_links_of_hang(self):
        def samples(bench, scene, what, side=0):
            return [s["value"] for s in rows_of(bench, "samples") if (s["scene"], s["what"], s["side"]) == (scene, what, side)]
        short = ["--rounds", "2", "--seconds", "0.0001"]
        bench = self.answer("bench", "effects", "flag", "chain", *short)
        rows = rows_of(bench, "effects_0")
        self.assertEqual([(row["scene"], row["effects"]) for row in rows], [("hang", ""), ("flag", "wind"), ("chain", "")])
        for row in rows:
            whole, alone = (samples(bench, row["scene"], what) for what in ("whole", "links alone"))
            self.assertEqual((len(whole), len(alone)), (4, 4))
            self.assertGreater(min(whole + alone), 0)
        bench = self.answer("bench", "effects", "crumple", "chain", "--sizes", "20,24", *short)
        self.assertEqual([(row["scene"], row["vertices"]) for side in (20, 24) for row in rows_of(bench, f"effects_{side}")],
                         [("hang", 400), ("crumple", 400), ("hang", 576), ("crumple", 576)])  # a chain is not a sheet
        solver = "jakobsen:iterations=1,substeps=1000000"
        out = self.taut("bench", "effects", "ball", "--solver", solver, "--rounds", "1").out
        self.assertIn("not timed: float: rounding in coordinates", out)

    def test_a_fabric_stands_beside_other_settings(self):
        words = ["case", "./small.toml", "jakobsen", "--set", "time.duration=0.1", "--fabric", "petrak-m1", "--json"]
        spec = json.loads(self.taut(*words).out)["spec"]
        self.assertEqual(sorted(spec["settings"]), ['fabric="petrak-m1"', "time.duration=0.1"])
        self.assertIn("petrak-m1", self.taut(*words[:-2], "petrak", expect=2).err)

    def test_the_curves_of_a_step_are_drawn_from_its_points(self):
        words = ["converge", "./small.toml", "--solver", "pd", "--solver", "jakobsen:order=mesh", "--most", "16", "-o", "figures"]
        answer = self.answer(*words, "--kind", "gap")
        picture = self.folder / facts_of(answer)["picture"]
        self.assertIn("exact step", "".join(self.answer(*words)["tables"]["points"]["columns"][5]["heading"]))
        self.assertIn("Projective Dynamics", picture.read_text())
        drawn = [line.split(",") for line in picture.with_suffix(".csv").read_text().splitlines()[1:]]
        points = [(row["iterations"], row["gap"]) for row in rows_of(answer, "points") if row["gap"]]
        self.assertEqual([(int(k), float(gap)) for _, _, _, k, gap, *_ in drawn], points)
        self.assertIn("did you mean 'residual'", self.taut(*words, "--kind", "residuel", expect=2).err)
        self.assertIn("--kind", self.taut(*words[:-2], "--kind", "gap", expect=2).err)

    def test_rigid_sheets_that_drape_and_swing_have_an_exact_step(self):
        for scene in (["drape", "--set", "cloth.span=0.7"], ["swing"]):
            own, = rows_of(self.answer("converge", *scene, "--solver", "admm", "--most", "1"), "solvers")
            self.assertIn("nearest placement", own["exact"])
            self.assertLess(own["moved"], 1e-6)

    def test_a_page_shows_what_converge_kept(self):
        study = self.study(solvers=["jakobsen"])
        self.taut("run", study)
        self.assertNotIn("steps", json.loads(self.taut("report", study, "--json").out))
        solvers = ["--solver", "pd:structural=500", "--solver", "jakobsen:order=mesh", "--solver", "mass-spring"]
        self.taut("converge", "./small.toml", *solvers, "--most", "32", "--record")
        with sqlite3.connect(self.folder / "results/runs/results.db") as store:
            kept, = [json.loads(answer) for answer, in store.execute("select answer from answers where kind = 'converge'")]
        model = json.loads(self.taut("report", study, "--json").out)
        points, reached = rows_of(kept, "points"), rows_of(kept, "reached")
        shown = rows_of(model, "steps")
        self.assertEqual([row["solver"] for row in shown], ["Projective Dynamics", "Jakobsen"])
        self.assertEqual([row["links"] for row in shown], ["500\u00a0N/m", "rigid"])
        for row, own in zip(shown, rows_of(kept, "solvers"), strict=True):
            mine = [point for point in points if point["solver"] == own["solver"]]
            for column, k in ("after_1", 1), ("after_16", 16):
                self.assertEqual([row[column]], [point["distance"] for point in mine if point["iterations"] == k])
            for column in "contraction", "floor":
                self.assertEqual(row[column], own[column])
            for column, gap in ("to_1e-1", 1e-1), ("to_1e-2", 1e-2), ("to_1e-4", 1e-4):
                first = [r["iterations"] for r in reached if r["solver"] == own["solver"] and r["below"] == gap]
                self.assertEqual(row[column], first[0] if first else "not reached")
        figure, = [figure for figure in model["figures"] if figure["of"] == "steps"]
        chart, = [chart for chart in model["charts"] if chart["id"] in figure["charts"]]
        drawn = [(point["x"], point["y"]) for series in chart["series"] for point in series["points"]]
        self.assertEqual(sorted(drawn), sorted((p["iterations"], p["distance"]) for p in points if p["distance"]))

    def test_the_same_scene_under_another_name_is_the_same_case(self):
        (self.folder / "copy.toml").write_text((self.folder / "small.toml").read_text())
        self.taut("run", self.study(scenes=["./small.toml"]))
        again = self.taut("run", self.study(scenes=["./copy.toml"]))
        self.assertIn("(1 were stored already)", again.err)


if __name__ == "__main__":
    main()
