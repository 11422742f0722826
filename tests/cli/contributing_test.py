#!/usr/bin/env python3
"""CONTRIBUTING.md works as written: its code is built into taut-toy, its solvers give the same results as ours, and its
scene and study run.

Usage: contributing_test.py BUILD; `contributing_test.py --extract FOLDER` writes the code that CMake then builds."""

import csv
import json
import pathlib
import re
import shutil
import subprocess
import sys

DOCUMENT = pathlib.Path(__file__).resolve().parents[2] / "CONTRIBUTING.md"


def blocks(language, mark):
    """file name -> text, for the code blocks whose first line names their file"""
    found = re.findall(rf"```{language}\n{mark} (\S+)\n(.*?)```", DOCUMENT.read_text(), re.DOTALL)
    return {pathlib.Path(path).name: text for path, text in found}


if sys.argv[1:2] == ["--extract"]:
    folder = pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in blocks("cpp", "//").items():
        if not (folder / name).exists() or (folder / name).read_text() != text:
            (folder / name).write_text(text)
    sys.exit()

from command_line import CommandLine, main  # noqa: E402


class Contributing(CommandLine):
    def end_of(self, scene, solver):
        self.taut("case", scene, solver, "--duration", 1, "--final-state", "end.csv", program="taut-toy")
        rows = csv.DictReader((self.folder / "end.csv").read_text().splitlines())
        return [float(row[key]) for row in rows for key in ("x", "y", "z", "vx", "vy", "vz")]

    def test_the_toy_solver_gives_what_ours_gives(self):
        toy = self.end_of("hang", "toy:iterations=16")
        ours = self.end_of("hang", "jakobsen:substeps=1,order=mesh,projection=exact,precision=double,iterations=16")
        self.assertEqual(len(toy), 6 * 32 * 32)
        self.assertLess(max(abs(a - b) for a, b in zip(toy, ours, strict=True)), 1e-9)
        other = self.end_of("hang", "toy:iterations=8")
        self.assertGreater(max(abs(a - b) for a, b in zip(toy, other, strict=True)), 1e-3)

    def test_the_toy_pass_gives_what_ours_gives_with_contact_too(self):
        for scene in ("hang", "ball"):
            toy = self.end_of(scene, "toy-pass:iterations=16")
            ours = self.end_of(scene, "jakobsen:substeps=1,order=mesh,projection=exact,precision=double,iterations=16")
            self.assertLess(max(abs(a - b) for a, b in zip(toy, ours, strict=True)), 1e-6)
        self.assertNotEqual(self.end_of("ball", "toy-pass"), self.end_of("ball", "toy-pass:contact=after"))

    def test_the_toy_solver_says_what_it_does_not_do(self):
        record = json.loads(self.taut("case", "ball", "toy", "--json", program="taut-toy").out)
        self.assertEqual(record["status"]["kind"], "unsupported")

    def test_the_truths_for_every_solver_bind_it(self):
        for solver in ("toy", "toy-pass"):
            done = self.taut("verify", "--solver", solver, program="taut-toy")
            self.assertIn("any-rest", done.out)
            self.assertRegex(done.err, r"numbers: [2-9]\d passed, \d deviate as explained, \d+ not applicable, 0 broken")

    def test_the_code_is_formatted_as_the_tree_is(self):
        if not shutil.which("clang-format"):
            self.skipTest("clang-format is not installed")
        for path, text in re.findall(r"```cpp\n// (\S+)\n(.*?)```", DOCUMENT.read_text(), re.DOTALL):
            style = f"--style=file:{DOCUMENT.parent / '.clang-format'}"
            done = subprocess.run(["clang-format", style, f"--assume-filename={DOCUMENT.parent / path}"], input=text, capture_output=True, text=True, check=True)
            self.assertEqual(done.stdout, text, path)

    def test_the_truth_has_the_next_row_of_its_section(self):
        truths = json.loads(self.taut("verify", "--list", "--json", program="taut-toy").out)["tables"]["truths"]
        place = [column["name"] for column in truths["columns"]].index("place")
        rows = sorted(int(row[place].split(".")[1]) for row in truths["rows"] if row[place].startswith("3."))
        self.assertEqual(rows, list(range(1, len(rows) + 1)))

    def test_advice_on_the_pass_is_searched_as_on_ours(self):
        done = self.taut("advise", "./small.toml", "--error", "0.01%", "--solver", "toy-pass", "--json", program="taut-toy", expect=None)
        tried = " ".join(row[0] for row in json.loads(done.out)["tables"]["tried"]["rows"])
        self.assertIn("substeps=2", tried)
        self.assertIn("iterations=2", tried)

    def test_the_scene_and_the_study_run(self):
        files = blocks("toml", "#")
        self.assertEqual(sorted(files), ["mine.toml", "sweeps.toml"])
        for name, text in files.items():
            (self.folder / name).write_text(text)
        self.taut("run", "./sweeps.toml", program="taut-toy")
        self.assertEqual([record["status"]["kind"] for record in self.records()], ["ok"] * 6)


if __name__ == "__main__":
    main()
