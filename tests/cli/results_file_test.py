#!/usr/bin/env python3
"""The results file for people: its document agrees with the schema, README's query works, and means ignore zeros."""

import contextlib
import os
import pathlib
import re
import shutil
import sqlite3
import subprocess

import stored
from command_line import CommandLine, main

ROOT = pathlib.Path(__file__).resolve().parents[2]
DOCUMENT = (ROOT / "experiments/results/README.md").read_text()
HOW_FAR, = re.findall("This counts the missing cases of each study: `(.*)`", DOCUMENT)


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
        line, = re.findall(r'^sqlite3 [^"]*"(.*)"$', DOCUMENT, re.MULTILINE)
        asked, = re.findall(r'read_sql\("([^"]*)"', DOCUMENT)
        for sql in line, asked:
            self.assertEqual(len(self.query(sql)), 2, sql)
        self.assertIn('study == "iterations")', DOCUMENT, "of R")
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
        self.assertEqual(self.query("SELECT count(*) FROM cases WHERE id <> scene || ' ' || setting"), [(0,)])
        for record in self.records():
            rows = dict(self.query("SELECT metric, value FROM results WHERE key = ?", record["key"]))
            self.assertEqual(rows, record["values"])
            last, = self.query("SELECT step, t, value FROM curves WHERE key = ? AND metric = 'stretch.max' ORDER BY t DESC LIMIT 1", record["key"])
            self.assertEqual(last[:2], (32, 0.5))
            count, = self.query("SELECT count(*) FROM curves WHERE key = ? AND metric = 'stretch.max'", record["key"])
            self.assertEqual(count, (33,))

    def test_others_read_it_while_it_is_written(self):
        process = self.start("run", self.study(solvers=["jakobsen", "bullet", "faulty:mode=held"]), "-j", 1, program="taut-faulty")
        while not self.keys():  # solvers with sweeps run first
            pass
        reader = sqlite3.connect(self.folder / "results/runs/results.db")
        self.assertGreater(reader.execute(HOW_FAR).fetchall()[0][1], 0)
        reader.close()
        (self.folder / "go-on").touch()
        _, said = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0, said)
        self.assertEqual(self.query(HOW_FAR), [("study", 0, 3)])


class Damage(CommandLine):
    """An unusable file is set aside once, with a message, and begun anew; what does not match its digest counts as missing."""
    RESULTS = "results/runs"

    def file(self, folder=RESULTS):
        return self.folder / folder / "results.db"

    def sql(self, *statements, folder=RESULTS):
        with contextlib.closing(sqlite3.connect(self.file(folder))) as file:
            for statement, *values in statements:
                file.execute(statement, values)
            file.commit()

    def flip_in(self, index, folder=RESULTS):
        """Flips a bit in the first entry of an index, which a reader of rows never reads."""
        with contextlib.closing(sqlite3.connect(self.file(folder))) as file:
            page, = file.execute("SELECT rootpage FROM sqlite_master WHERE name = ?", [index]).fetchone()
            size, = file.execute("PRAGMA page_size").fetchone()
        data = bytearray(self.file(folder).read_bytes())
        data[page * size - 12] ^= 1  # within the text of the entry inserted first, which is at the end of the page
        self.file(folder).write_bytes(data)

    def test_an_index_that_disagrees_with_its_table_is_set_aside_once(self):
        study = self.study(rest="axes.iterations = [1, 2, 3]\n")
        self.taut("run", study)
        sound = self.store_digest(self.taut("run", study))
        for index in ("planned_key", "sqlite_autoindex_cases_1"):
            self.flip_in(index)
            again = self.taut("run", study)
            self.assertIn("damaged, set aside as", again.err, index)
            self.assertEqual(self.store_digest(again), sound)
            self.assertNotIn("damaged", self.taut("run", study).err)
            self.assertEqual(len(self.records()), 3)
            self.taut("report", study, "--json")

    def test_references_to_nothing_are_damage(self):
        study = self.study()
        self.taut("run", study)
        self.sql(["PRAGMA foreign_keys = OFF"], ["UPDATE numbers SET metric_id = 4711 WHERE metric_id = 1"])
        self.assertIn("damaged, set aside as", self.taut("run", study).err)

    def test_a_merge_takes_what_matches_its_digest_alone(self):
        study = self.study(rest="axes.iterations = [1, 2]\n")
        for folder in ("one", "two"):
            self.taut("run", study, "--out", folder)
        whole = self.store_digest(self.taut("run", study, "--out", "one"))
        self.sql(["UPDATE numbers SET value = 1e9 WHERE case_id = 1 AND metric_id = 1"], folder="one")
        for folders in (["one", "two"], ["two", "one"]):
            merged = self.taut("cluster", "merge", *folders, "--out", "merged")
            self.assertIn("damaged case", merged.err)
            self.assertIn(whole.split()[1], merged.out)
            self.assertNotIn("damaged", self.taut("export", study, "--out", "merged").err)
            shutil.rmtree(self.folder / "merged")
        self.assertIn("damaged case", self.taut("cluster", "merge", "one", "--out", "merged", expect=3).err)
        self.taut("cluster", "merge", "two", "--out", "one")  # the sound record takes its place
        self.assertEqual(self.store_digest(self.taut("run", study, "--out", "one")), whole)
        said = self.taut("cluster", "merge", "one", "merged", "--out", "x", "--quiet", expect=None)
        self.assertNotEqual((said.returncode, said.err), (2, ""), "it says why it exits with 2")

    def test_series_answers_and_benches_have_digests(self):
        study = self.study(rest='[[plot]]\nkind = "series"\ny = "stretch.rms"\n')
        self.taut("run", study)
        self.taut("converge", "./small.toml", "--solver", "jakobsen", "--record")
        self.sql(["UPDATE series SET columns = replace(columns, '0.1', '0.2')"], ["UPDATE answers SET answer = replace(answer, '1', '2')"])
        self.assertIn("damaged series", self.taut("plot", study, expect=None).err)
        self.assertIn("does not match its digest", self.taut("report", study, "--json").err)
        self.taut("bench", study, "--rounds", 2, "--seconds", 0.001)
        self.assertNotIn("damaged bench", self.taut("report", study, "--json").err)
        self.sql(["UPDATE samples SET cpu = 2 * cpu WHERE sample = 1"])
        self.assertIn("damaged bench of small in study", self.taut("report", study, "--json").err)

    def test_a_foreign_file_with_a_view_without_end_is_refused(self):
        study = self.study()
        self.taut("run", study)
        shutil.copytree(self.folder / self.RESULTS, self.folder / "other")
        self.sql(["ALTER TABLE answers RENAME TO kept"],
                 ["CREATE VIEW answers AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) "
                  "SELECT i AS kind, i AS subject, i AS program, i AS made, i AS answer, i AS digest FROM n"])
        self.assertIn("its table answers is not that of a results file", self.taut("report", study, "--json", expect=2).err)
        self.assertIn("set aside as", self.taut("run", study).err)
        self.sql(["CREATE TRIGGER t AFTER INSERT ON sessions BEGIN DELETE FROM cases; END"], folder="other")
        self.assertIn("trigger t", self.taut("report", study, "--json", "--out", "other", expect=2).err)

    def test_a_kept_film_is_the_one_that_was_made(self):
        study = self.study()
        self.taut("run", study)
        filmed = lambda: "small filmed" in self.taut("report", study, "-o", "page.html").err  # noqa: E731
        self.assertTrue(filmed())
        self.assertFalse(filmed())
        films = sorted((self.folder / self.RESULTS / "films").iterdir())
        self.assertGreaterEqual(len(films), 2)
        for film in films:
            data = bytearray(film.read_bytes())
            data[len(data) // 2] ^= 1
            film.write_bytes(data)
            self.assertTrue(filmed(), film)
            self.assertFalse(filmed(), film)
            film.unlink()
            os.mkfifo(film)  # must not block on the other end
            self.assertTrue(filmed(), film)
            self.assertFalse(filmed(), film)


if __name__ == "__main__":
    main()
