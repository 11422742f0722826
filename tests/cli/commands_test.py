#!/usr/bin/env python3
"""What the verbs print, and what bad input costs: a message with its place, exit 2, nothing written."""

import csv
import hashlib
import json
import pathlib
import re
import struct

from command_line import CommandLine, main


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
        self.refuse("run", "iterations", "--preset", "quikc", says="did you mean 'quick'?")
        self.refuse("advise", "hnag", "--error", "1%", says="unknown scene 'hnag'; did you mean 'hang'?")
        self.refuse("advise", "hang", "--error", "1%", "--metric", "stretch.rsm", says="did you mean 'stretch.rms'?")
        self.refuse("advise", "hang", says="one of --error and --budget")
        self.refuse("advise", "hang", "--error", "1%", "--budget", 4, says="one of --error and --budget")
        self.refuse("advise", "hang", "--error", "small", says="expected a number above 0 such as 0.01 or 1%")
        self.refuse("advise", "hang", "--error", "1%", "--solver", "bulet", says="did you mean 'bullet'?")

    def test_numbers(self):
        for value in ["0", "-3", "many", "nan", "1e9", "1.5"]:
            if value != "0":
                self.refuse("case", "hang", f"jakobsen:iterations={value}", says=f"iterations={value}")
            self.refuse("case", "hang", f"jakobsen:substeps={value}", says=f"substeps={value}")
        for dt in ["0", "-0.01", "nan", "fast", "1/0"]:
            self.refuse("case", "hang", "jakobsen", "--dt", dt, says="dt")
        self.refuse("run", "iterations", "--shard", "5/4", says="shard 5/4 does not exist")
        self.refuse("run", "iterations", "--shard", "two", says="expected i/n")

    def test_a_study_with_many_mistakes_names_them_all(self):
        (self.folder / "bad.toml").write_text('''question = "?"
scenes = ["hang", "hnag"]
solvers = ["jakobsen:iterations=-1"]
sovers = []
[sweep]
iteratons = [1, 2]
substeps = [1, 0]
[preset.quick]
scense = ["hang"]
[[plot]]
x = "iterations"
''')
        self.refuse("run", "./bad.toml",
                    says=["bad.toml:2:", "unknown scene 'hnag'; did you mean 'hang'?",
                          "bad.toml:3:", "iterations=-1 is outside",
                          "bad.toml:4:1: unknown key 'sovers'", "did you mean 'solvers'?",
                          "bad.toml:9:1: unknown key 'scense' in [preset.quick]; did you mean 'scenes'?",
                          "missing key 'kind'"])
        (self.folder / "bad.toml").write_text('''question = "?"
scenes = ["hang"]
solvers = ["jakobsen"]
[sweep]
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
[sweep]
iterations = [1, 2]
[[plot]]
kind = "series"
colour = "red"
''')
        self.refuse("run", "./bad.toml",
                    says=["bad.toml:4:14: nothing that this study varies is called 'scen'; did you mean 'scene'?",
                          "'iteratons'; did you mean 'iterations'?", "bad.toml:9:1: unknown key 'colour' in [[plot]]"])
        plot = '[[plot]]\nkind = "error-iteration"\ny = "stretch.rmss"\n'
        self.refuse("run", self.study(rest=plot),
                    says=["unknown kind of plot 'error-iteration'; did you mean 'error-iterations'?",
                          "unknown value 'stretch.rmss' for y; did you mean 'stretch.rms'?"])
        nothing = self.taut("run", self.study(rest='exclude = [{ solver = "jakobsen" }]\n'), expect=4)
        self.assertIn("no case", nothing.err)

    def test_a_bad_scene_in_a_study_stops_all_of_it(self):
        (self.folder / "small.toml").write_text("[cloth]\ngrid = [1, 1]\nmas = 3\n")
        self.refuse("run", self.study(scenes=["hang", "./small.toml"]), says=["small.toml:", "unknown key 'mas'"])

    def test_a_swept_scene_key_that_does_not_exist(self):
        self.refuse("run", self.study(rest='[sweep]\n"time.td" = [1]\n'), says="unknown key 'td'")


class Verbs(CommandLine):
    def test_plots_of_values_over_time_and_what_is_held_is_said(self):
        study = self.study(rest="sweep.iterations = [1, 2]\nsweep.time.dt = [0.02, 0.01]\n"
                                '[[plot]]\nkind = "error-iterations"\nfile = "mine"\n')
        self.taut("run", study)
        drawn = self.taut("plot", study)
        self.assertIn("small-mine.svg", drawn.out)
        self.assertIn("2 cases at other values are not drawn", drawn.err)
        self.assertIn("dt = ", (self.folder / drawn.out.split()[0]).read_text())
        series = self.taut("plot", study, "--kind", "series", "--y", "stretch.rms")
        self.assertIn("Jakobsen 5 × 2", (self.folder / series.out.split()[0]).with_suffix(".csv").read_text())

    def test_targets_that_cannot_be_written_are_refused_before_the_work(self):
        study = self.study()
        self.taut("run", study)
        (self.folder / "file").write_text("")
        self.assertIn("is a folder; name a file in it", self.taut("report", study, "-o", ".", expect=2).err)
        for words in [["report", study, "-o", "file/x.html"], ["plot", study, "--kind", "series", "--out", "file"],
                      ["figures", "-o", "file"]]:
            self.assertIn("file", self.taut(*words, expect=2).err)
        self.assertIn("taut run", self.taut("plot", study, "--results", "nowhere", expect=2).err)
        self.assertIn("no folder", self.taut("check", "regression", expect=4).out)

    def test_the_version_names_release_build_and_compiler(self):
        self.assertRegex(self.taut("--version").out, r"^taut \d+\.\d+\.\d+\nprogram [0-9a-f]{10}\n\w+ \d+.*Bullet 3\.")

    def test_the_documentation_names_every_key_of_a_record_and_a_plan(self):
        text = (pathlib.Path(__file__).parents[2] / "experiments/cli/README.md").read_text()
        for verb in ["case", "plan"]:
            keys = json.loads(self.taut(verb, "./small.toml", "jakobsen", "--json").out)
            for key in [*keys, *keys.get("step_cost", [{}])[0], *keys.get("status", {}), *keys.get("spec", {})]:
                self.assertIn(f"`{key}`", text, verb)

    def test_every_verb_has_help_with_an_example(self):
        verbs = self.taut("--help").out
        for verb in ["list", "run", "case", "plan", "merge", "doctor"]:
            self.assertIn(verb, verbs)
            self.assertIn("Example:\n  taut " + verb, self.taut(verb, "--help").out)

    def test_list(self):
        everything = json.loads(self.taut("list", "--json").out)
        self.assertIn("hang", [scene["name"] for scene in everything["scenes"]])
        solver, = [s for s in everything["solvers"] if s["name"] == "jakobsen"]
        self.assertIn("iterations", [param["name"] for param in solver["params"]])
        for metric in everything["metrics"]:
            for value in metric["values"]:
                self.assertTrue(value["unit"] and value["help"], value["name"])
        self.assertEqual({"iterations", "time-steps", "penetration"} - {s["name"] for s in everything["studies"]}, set())
        self.assertIn("stretch.rms [1]", self.taut("list", "metrics").out)

    def test_case_prints_a_record_and_its_final_state(self):
        run = self.taut("case", "./small.toml", "jakobsen:precision=double", "--dt", "1/128", "--duration", 0.25,
                        "--set", "cloth.grid=[5, 3]", "--json", "--final-state", "end.csv", "--series", "series.csv",
                        "--trajectory", "all.traj")
        record = json.loads(run.out)
        self.assertEqual((record["dt"], record["steps"], record["vertices"]), (1 / 128, 32, 15))
        self.assertEqual(record["status"]["kind"], "ok")
        rows = list(csv.DictReader((self.folder / "end.csv").read_text().splitlines()))
        self.assertEqual(list(rows[0]), ["vertex", "x", "y", "z", "vx", "vy", "vz"])
        self.assertEqual(len(rows), 15)
        # The texts are the same doubles: their bits have the digest that the record has of the state.
        bits = b"".join(b"".join(struct.pack("<3d", *(float(row[key]) for key in keys)) for row in rows) + b"|"
                        for keys in (("x", "y", "z"), ("vx", "vy", "vz")))
        self.assertEqual(hashlib.sha256(bits).hexdigest(), record["digest"])
        self.assertEqual(len((self.folder / "series.csv").read_text().splitlines()), 34)
        self.assertEqual((self.folder / "all.traj").read_bytes()[:8], b"TAUTTRAJ")

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
        best, rival = answer["best"], answer["runner_up"]
        self.assertLessEqual(best["error"], 0.001)
        self.assertTrue(answer["verified"]["same_bits"])
        self.assertEqual({best["solver"], rival["solver"]}, {"jakobsen", "bullet"})
        self.assertGreater(answer["ratio"][1], 1)
        alone = json.loads(self.taut("case", "./small.toml", best["setting"], "--json").out)
        self.assertEqual(alone["values"]["stretch.rms"], best["error"])
        for other in answer["tried"]:  # nothing that was tried and reaches the error is far cheaper
            if not other["failed"] and other["error"] is not None and other["error"] <= 0.001:
                self.assertGreater(other["quick_cost"], 0.3 * best["cpu_seconds_per_second"][1])

    def test_the_table_and_the_advice_name_the_same_solver(self):
        answer = self.advise("--error", "1%", "--solver", "jakobsen", "--solver", "bullet")
        study = self.study(solvers=[answer["best"]["setting"], answer["runner_up"]["setting"]])
        table = json.loads(self.taut("bench", study, "--seconds", 0.002, "--json").out)
        best, rival = (sorted(case["cpu_seconds_per_step"])[5] for case in table["scenes"][0]["cases"])
        self.assertLess(best, rival)

    def test_a_budget_is_kept_and_what_cannot_be_had_is_said(self):
        answer = self.advise("--budget", 0.01, "--solver", "jakobsen")
        self.assertLessEqual(answer["best"]["cpu_seconds_per_second"][1], 0.01e-3 * 60)
        never = self.advise("--error", "1e-12", "--solver", "xpbd:iterations=1,substeps=2", expect=4)
        self.assertEqual((never["best"], len(never["tried"]) > 0), (None, True))

    def test_plan(self):
        plan = json.loads(self.taut("plan", "./small.toml", "jakobsen:iterations=2,substeps=3", "--json").out)
        structural, = [p for p in plan["passes"] if p["pass"] == "structural"]
        self.assertEqual((structural["items"], structural["repeats"]), (24, 6))
        self.assertIn("projections", self.taut("plan", "hang", "bullet").out)

    def test_doctor(self):
        report = json.loads(self.taut("doctor", "--json").out)
        good = {finding["name"]: finding["good"] for finding in report["findings"]}
        self.assertIn("toolchain", good)
        noise = [good.get(name, True) for name in ("load", "clock", "same code, twice")]
        self.assertEqual(report["timing_trusted"], all(noise))

    def test_benches_of_two_words_take_options(self):
        short = ["--sizes", "8", "--rounds", "1", "--seconds", "0.0001"]
        out = self.taut("bench", "kernels", *short).out
        self.assertIn("textbook, float", out)
        self.assertIn("fixed: what a step costs without a sweep", out)
        fixed = [float(line.split()[-1]) for line in out.splitlines() if line.startswith("jakobsen:")]
        self.assertGreater(len(fixed), 8)
        self.assertGreaterEqual(min(fixed), 0)  # 0.00 where other programs slowed the sweeps
        traffic = re.search(r"loads and stores, .*: ([\d.]+) ns in float, ([\d.]+) ns in double", out)
        self.assertGreater(min(map(float, traffic.groups())), 0)
        cores = re.search(r"two threads: ([\d.]+) .* sheets at once: ([\d.]+) .* get ([\d.]+) ", out)
        self.assertGreater(min(map(float, cores.groups())), 0)
        out = self.taut("bench", "contact", *short).out
        for text in ["contact=swept,order=mesh", "self=grid,order=coloured", "8 x 8, 64 particles"]:
            self.assertIn(text, out)

    def test_the_same_scene_under_another_name_is_the_same_case(self):
        (self.folder / "copy.toml").write_text((self.folder / "small.toml").read_text())
        self.taut("run", self.study(scenes=["./small.toml"]))
        again = self.taut("run", self.study(scenes=["./copy.toml"]))
        self.assertIn("(1 were stored already)", again.err)


if __name__ == "__main__":
    main()
