#!/usr/bin/env python3
"""Markup, quotes, line breaks, direction marks, 10,000 letters, shell and gnuplot syntax in names, summaries, questions, titles
and messages of solvers: a text stays a text everywhere."""

import contextlib
import csv
import hashlib
import html.parser
import json
import os
import shutil
import sqlite3

from command_line import SCENE, CommandLine, main, rows_of

MARKUP = "<img src=x onerror=alert(1)></script><script>alert(1)</script>"
SHELL = "$(touch canary)`touch canary`;touch canary"
GNUPLOT = "';system('touch canary');'\"`touch canary`@CSV@{/Symbol x}_^"
NAMES = ["<img src=x onerror=alert(1)>", SHELL, "it's \"odd\" &amp; %s", "\u202egpj.exe\u2066", "x" * 240, "=1+1", "-o"]
LONG = "letters " * 1250


class Page(html.parser.HTMLParser):
    """Elements and attributes of a page, and its title."""
    def __init__(self, text):
        super().__init__()
        self.tags, self.handlers = [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.handlers += [name for name, _ in attrs if name.startswith("on")]


class HostileText(CommandLine):
    def setUp(self):
        super().setUp()
        for i, name in enumerate(NAMES):  # different masses, so that each is a case of its own
            summary = json.dumps(MARKUP + GNUPLOT + "\u202e\n" + LONG)
            (self.folder / f"{name}.toml").write_text(SCENE.replace('"A small sheet"', summary).replace("mass = 0.1", f"mass = {1 + i}"))
        self.scenes = [f"./{name}.toml" for name in NAMES]

    def tearDown(self):
        self.assertEqual(list(self.folder.rglob("canary")), [], "a text was run as a command")

    def taut(self, *words, **more):
        process = super().taut(*words, **more)
        for said in (process.out, process.err):
            self.assertNotIn("\x1b", said)
            self.assertNotIn("\x07", said)
        return process

    def hostile_study(self, **more):
        plots = "".join(f'[[plot]]\nkind = "{kind}"\ntitle = {json.dumps(title)}\nfile = {json.dumps(title)}\n'
                        for kind, title in [("convergence", GNUPLOT), ("stability", SHELL + "../../canary")])
        study = self.folder / self.study(scenes=self.scenes, rest="axes.iterations = [1, 2]\naxes.omega = [0.9, 1]\n" + plots, **more)
        study.write_text(study.read_text().replace("Does it?", (MARKUP + GNUPLOT).replace('"', '\\"') + "\u202e" + LONG))
        name = "a study; touch canary `touch canary`.toml"
        study.rename(self.folder / name)
        return "./" + name

    def test_from_a_study_to_plots_tables_and_the_page(self):
        study = self.hostile_study()
        run = self.taut("run", study, "--table", "stretch.rms")
        self.assertIn("'./a study; touch canary `touch canary`.toml'", run.err)  # the suggested command
        self.assertEqual(rows_of(self.answer("run", study), "statuses"), [{"status": "ok", "cases": 28}])
        rows = list(csv.DictReader(self.taut("export", study).out.splitlines()))
        self.assertEqual(len(rows), 28)
        self.assertEqual({row["scene"] for row in rows}, {name if name[0] not in "=-" else "'" + name for name in NAMES})
        model = json.loads(self.taut("report", study, "--json").out)
        self.assertEqual({scene["id"] for scene in model["scenes"]}, set(NAMES))
        self.assertEqual({scene["summary"] for scene in model["scenes"]}, {MARKUP + GNUPLOT + "\u202e\n" + LONG})
        self.taut("report", study, "--no-media", "-o", "page.html")
        text = (self.folder / "page.html").read_text()
        page = Page(text)
        self.assertNotIn("img", page.tags)
        self.assertEqual(page.handlers, [])
        self.assertEqual(text.count("<script"), page.tags.count("script"))
        drawn = [line for line in self.taut("plot", study).out.splitlines()]
        self.assertEqual(len(drawn), 2 * (1 + len(NAMES)), "a figure of all scenes, and a map of each")
        for file in drawn:
            self.assertGreater((self.folder / file).stat().st_size, 0)
            self.assertEqual(os.path.dirname(file).count(".."), 0)

    def test_a_picture_of_a_scene_with_such_a_name(self):
        for scene in self.scenes:
            self.taut("render", scene, "--solver", "jakobsen", "--size", "320x240", "--quality", "draft", "--at", "0.05", "-o", "x.png")
            self.assertEqual((self.folder / "x.png").read_bytes()[:4], b"\x89PNG")

    def test_what_a_solver_says(self):
        study = self.study(scenes=self.scenes[:2], solvers=["faulty:mode=words", "faulty:mode=stable"])
        self.taut("run", study, program="taut-faulty")
        said = {r["status"]["reason"] for r in self.records() if r["status"]["kind"] == "error"}
        reason, = said
        self.assertTrue(reason.startswith("<img src=x onerror=alert(1)>?]0;title?`touch canary` \u202ew"), reason[:80])
        self.assertLess(len(reason), 310)
        self.assertIn(reason, json.loads(self.taut("report", study, "--json", program="taut-faulty").out)["cases"][0].values())
        self.taut("report", study, "--no-media", "-o", "page.html", program="taut-faulty")
        self.assertNotIn("img", Page((self.folder / "page.html").read_text()).tags)
        self.taut("plot", study, "--kind", "series", "--y", "stretch.rms", program="taut-faulty")
        self.taut("export", study, program="taut-faulty")

    def test_control_characters_in_cells(self):
        program = self.folder / "says.py"
        program.write_text("import json, sys\nfor line in sys.stdin:\n    print(json.dumps({'protocol': 'taut-solver/1', 'name': 'says', "
                           "'version': '1', 'summary': 'a\\x1b]0;t\\x07b\\x9b2Jc\\x7f', 'params': {}} if 'hello' in line else "
                           "{'cannot': ['no \\x1b[31m\\x9b2J']}), flush=True)\n")
        (self.folder / "registered").mkdir()
        (self.folder / "registered/says.toml").write_text(f'cmd = "python3 {program}"\n')
        environment = {**os.environ, "TAUT_SOLVERS": str(self.folder / "registered")}
        study = self.study(solvers=["says", "jakobsen"])
        for words in (["list", "solvers"], ["list", "solvers", "--csv"], ["list", "solvers", "--markdown"], ["list", "solvers", "--json"],
                      ["case", "./small.toml", "says"], ["case", "./small.toml", "says", "--json"], ["bench", "./small.toml", "--solver", "says"],
                      ["bench", "effects", "--solver", "says"], ["run", study, "--json"], ["plan", "./small.toml", "says"]):
            said = self.taut(*words, env=environment, expect=None)
            for text in (said.out, said.err):
                self.assertNotRegex(text, "[\x00-\x08\x0b-\x1f\x7f-\x9f]", words)
        listed = json.loads(self.taut("list", "solvers", "--json", env=environment).out)
        self.assertIn("a\x1b]0;t\x07b\x9b2Jc\x7f", [row["summary"] for row in rows_of(listed, "solvers")], "data are whole")

    def test_control_characters_in_errors(self):
        for name in ["a\x1b[31m\x07.toml", "a\nb.toml", "a\x9b31m.toml"]:
            (self.folder / name).write_text(r'[cloth]' '\n' r'"\u001b[31m" = 1' '\n' r'x = "\u001b]0;t\u0007"' '\n')
            refused = self.taut("case", f"./{name}", "jakobsen", expect=2)
            self.assertIn("?[31m", refused.err)
        self.taut("case", "./small.toml", "\x1b[31m", expect=2)
        self.taut("case", "./small.toml", "jakobsen:\x1b[31m=\x9b", expect=2)
        missing = "\x1b[31mno folder"
        self.assertIn("'?[31mno folder'", self.taut("check", self.study(scenes=["./small.toml"]), "--baselines", missing, expect=4).out)
        (self.folder / missing).mkdir()
        self.assertIn("?[31mno folder", self.taut("check", "./study.toml", "--baselines", missing, expect=4).out)
        long = self.taut("case", "./small.toml", "jakobsen:" + "x" * 100_000, expect=2)
        self.assertLess(len(long.err), 5000)


class StoredText(CommandLine):
    """A results file is data: a program that it names is not started, a file that it names is not opened."""
    REST = "axes.iterations = [1, 2]\n"

    def setUp(self):
        super().setUp()
        registered = self.folder / "registered"
        registered.mkdir()
        (registered / "mine.toml").write_text('cmd = "touch canary"\n')
        os.environ["TAUT_SOLVERS"] = str(registered)
        self.addCleanup(os.environ.pop, "TAUT_SOLVERS")
        os.mkfifo(self.folder / "pipe.npy")  # opening it would block forever
        self.texts = [f"x:cmd='touch {self.folder}/canary'", "mine", "mine:iterations=2", f"positions:file='{self.folder}/pipe.npy'"]

    def started(self):
        return [str(file) for file in self.folder.rglob("canary")]

    def replaced(self, value, text):
        """The value with every text that names a solver replaced by `text`."""
        if isinstance(value, dict):
            return {key: self.replaced(one, text) for key, one in value.items()}
        if isinstance(value, list):
            return [self.replaced(one, text) for one in value]
        return text if isinstance(value, str) and value.startswith("jakobsen") else value

    def plant(self, results, text):
        """Plants `text` in every table that contains solver texts, and in JSON stored there."""
        with contextlib.closing(sqlite3.connect(results / "results.db")) as file:
            file.execute("UPDATE cases SET solver_text = ?", [text])
            file.execute("UPDATE planned SET id = ? || id", [text])
            file.execute("UPDATE sessions SET command = ?", [text])
            file.execute("INSERT INTO conflicts SELECT key, 'other', 'now', ? FROM cases", [json.dumps({"spec": {"solver": text}})])
            for kind, subject, answer in file.execute("SELECT kind, subject, answer FROM answers").fetchall():
                planted = json.dumps(self.replaced(json.loads(answer), text))
                file.execute("UPDATE answers SET answer = ?, digest = ? WHERE kind = ? AND subject = ?",
                             [planted, hashlib.sha256(planted.encode()).hexdigest(), kind, subject])
            kinds = {kind for kind, in file.execute("SELECT DISTINCT kind FROM answers")}
            file.commit()
        return kinds

    def test_no_verb_that_reads_starts_a_program_that_a_results_file_names(self):
        study = self.study(rest=self.REST + '[[plot]]\nkind = "convergence"\n')
        mine, sound = self.folder / "results/runs", self.folder / "sound"
        self.taut("run", study)
        self.taut("bench", study, "--rounds", 2, "--seconds", 0.2, expect=None)
        self.taut("converge", "./small.toml", "--solver", "jakobsen", "--record")
        self.taut("verify", "free-fall", "--record", expect=None)
        self.taut("require", "./small.toml", "--patience", 1, expect=None)
        self.taut("baseline", "update", study, "--why", "the first", "--baselines", "baselines")
        self.taut("check", study, "--baselines", "baselines", "--record")
        mine.rename(sound)
        shutil.copytree(self.folder / "baselines", self.folder / "sound-baselines")
        for text in self.texts:
            for folder, of in ((mine, sound), (self.folder / "baselines", self.folder / "sound-baselines")):
                shutil.rmtree(folder, ignore_errors=True)
                shutil.copytree(of, folder)
            self.assertLessEqual({"converge", "check"}, self.plant(mine, text))
            for file in (self.folder / "baselines").rglob("*.json"):
                file.write_text(json.dumps(self.replaced(json.loads(file.read_text()), text)))
            for words in (["report", study], ["report", study, "--json"], ["report", "--json"], ["report", "--json", sound, mine],
                          ["report", "--json", mine, sound], ["plot", study], ["plot", study, "--kind", "series"],
                          ["plot", study, "--kind", "stability"], ["plot", study, "--kind", "profile"], ["export", study],
                          ["check", study, "--baselines", "baselines"], ["baseline", "diff", study, "--baselines", "baselines"],
                          ["cluster", "status", mine], ["cluster", "merge", mine, "--out", "merged"], ["bench", "x:cmd"],
                          ["advise", "./small.toml", "--error", "0.5", "--solver", "jakobsen", "--patience", "1"],
                          ["run", study]):
                self.taut(*words, expect=None)
                self.assertEqual(self.started(), [], f"{words} with {text}")

    def test_what_is_typed_or_stands_in_a_study_is_started(self):
        for words in (["case", "./small.toml", self.texts[0]], ["case", "./small.toml", "mine"],
                      ["run", self.study(solvers=[self.texts[0]])], ["run", self.study(solvers=["mine"])],
                      ["render", "./small.toml", f"--solver={self.texts[0]}"], ["bench", "./small.toml", "--solver", self.texts[0]]):
            self.taut(*words, expect=None)
            self.assertNotEqual(self.started(), [], words)
            for file in self.started():
                os.remove(file)


if __name__ == "__main__":
    main()
