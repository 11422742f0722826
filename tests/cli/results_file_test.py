#!/usr/bin/env python3
"""The results file for people: its document and the schema agree, README's query answers, and means take no zeros."""

import pathlib
import re
import shutil
import sqlite3
import subprocess

import stored
from command_line import CommandLine, main

ROOT = pathlib.Path(__file__).resolve().parents[2]
DOCUMENT = (ROOT / "experiments/results/README.md").read_text()
HOW_FAR, = re.findall("How far the studies are: `(.*)`", DOCUMENT)


class ResultsFile(CommandLine):
    def query(self, sql, *values, folder="results/runs"):
        return [tuple(row) for row in stored.query(self.folder / folder, sql, *values)]

    def columns(self, name):
        return [name for name, in self.query("SELECT name FROM pragma_table_info(?)", name)]

    def test_the_document_is_the_schema(self):
        self.taut("run", self.study())
        views = {name: re.findall(r"^\| (\w+) \|[^|]*\|", text, re.MULTILINE)[1:]
                 for name, text in re.findall(r"^## (\w+)\n(.*?)(?=^## )", DOCUMENT, re.MULTILINE | re.DOTALL)}
        self.assertEqual(sorted(views), sorted(name for name, in self.query("SELECT name FROM sqlite_master WHERE type = 'view'")))
        for view, columns in views.items():
            self.assertEqual(columns, self.columns(view), view)
        tables = dict(re.findall(r"^\| (\w+) \| [^|]* \| ([\w, ]+) \|$", DOCUMENT[DOCUMENT.index("## Tables"):], re.MULTILINE))
        tables.pop("table")
        self.assertEqual(sorted(tables), sorted(name for name, in self.query("SELECT name FROM sqlite_master WHERE type = 'table'")))
        for table, columns in tables.items():
            self.assertEqual(columns.split(", "), self.columns(table), table)

    def test_the_line_of_the_readme_answers_its_first_question(self):
        readme = (ROOT / "README.md").read_text()
        line, = re.findall(r'^sqlite3 .*$', readme, re.MULTILINE)
        self.assertIn(line, DOCUMENT)
        if not shutil.which("sqlite3"):
            self.skipTest("sqlite3 is not installed")
        study = self.study(scenes=["hang"], solvers=["jakobsen", "xpbd"], name="iterations.toml",
                           rest='set = ["cloth.grid=[4, 4]", "time.duration=0.25"]\naxes.iterations = [1, 4]\n')
        self.taut("run", study)
        said = subprocess.run(line, shell=True, cwd=self.folder, capture_output=True, text=True, check=True).stdout.splitlines()
        self.assertEqual(said[0], "setting|value")
        values = {r["id"].removeprefix("hang "): r["values"]["stretch.rms"] for r in self.records()}
        found = {row.split("|")[0]: float(row.split("|")[1]) for row in said[1:]}
        self.assertEqual(found.keys(), values.keys())
        for which, value in values.items():
            self.assertAlmostEqual(found[which], value, delta=1e-14 * abs(value))

    def test_the_examples_of_the_documents_mix_no_two_studies(self):
        rest = 'set = ["cloth.grid=[4, 4]", "time.duration=0.25"]\naxes.iterations = [1, 4]\n'
        self.taut("run", self.study("iterations.toml", ["hang"], ["jakobsen:substeps=1"], rest),
                  self.study("other.toml", ["hang"], ["jakobsen:substeps=3"], rest))
        for document in (ROOT / "README.md").read_text(), DOCUMENT:
            line, = re.findall(r'^sqlite3 [^"]*"(.*)"$', document, re.MULTILINE)
            asked, = re.findall(r'read_sql\("([^"]*)"', document)
            for sql in line, asked:
                self.assertEqual(len(self.query(sql)), 2, sql)
            self.assertIn('study == "iterations")', document, "of R")
        both = self.query("select * from results where metric = 'stretch.rms' and scene = 'hang'")
        self.assertEqual(len(both), 4)

    def test_what_a_case_has_not_is_null_and_its_status_says_why(self):
        study = self.study(solvers=["faulty:mode=stable", "faulty:mode=crash", "faulty:mode=refuse"])
        self.taut("run", study, program="taut-faulty")
        rows = self.query("SELECT setting, value, unit, status FROM results WHERE metric = 'stretch.rms' AND study = 'study'")
        self.assertEqual(sorted((value is None, unit, status) for _, value, unit, status in rows),
                         [(False, "1", "ok"), (True, "1", "crash"), (True, "1", "unsupported")])
        mean, = self.query("SELECT avg(value) FROM results WHERE metric = 'stretch.rms'")
        alone, = self.query("SELECT value FROM results WHERE metric = 'stretch.rms' AND status = 'ok'")
        self.assertEqual(mean, alone, "nobody averages zeros")

    def test_values_keep_their_bits_and_curves_their_rows(self):
        self.taut("run", self.study(rest="axes.iterations = [1, 2]\n"))
        for record in self.records():
            rows = dict(self.query("SELECT metric, value FROM results WHERE key = ?", record["key"]))
            self.assertEqual(rows, record["values"])
            last, = self.query("SELECT step, t, value FROM curves WHERE key = ? AND metric = 'stretch.max' ORDER BY t DESC LIMIT 1", record["key"])
            self.assertEqual(last[:2], (32, 0.5))
            count, = self.query("SELECT count(*) FROM curves WHERE key = ? AND metric = 'stretch.max'", record["key"])
            self.assertEqual(count, (33,))

    def test_others_read_it_while_it_is_written(self):
        study = self.study(solvers=["faulty:mode=slow"], rest="axes.variant = [0, 1, 2, 3]\n")
        process = self.start("run", study, "-j", 1, program="taut-faulty")
        while not self.keys():
            pass
        reader = sqlite3.connect(self.folder / "results/runs/results.db")
        self.assertGreater(reader.execute(HOW_FAR).fetchall()[0][1], 0)
        reader.close()
        _, said = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0, said)
        self.assertEqual(self.query(HOW_FAR), [("study", 0, 4)])


if __name__ == "__main__":
    main()
