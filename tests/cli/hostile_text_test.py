#!/usr/bin/env python3
"""Markup, quotes, line breaks, marks of direction, 10,000 letters, shell and gnuplot syntax in names, summaries, questions, titles
and what solvers say: everywhere a text stays a text."""

import csv
import html.parser
import json
import os

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
        for i, name in enumerate(NAMES):  # of different mass, so that no two are one case
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
        self.assertIn("'./a study; touch canary `touch canary`.toml'", run.err)  # what to type next
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


if __name__ == "__main__":
    main()
