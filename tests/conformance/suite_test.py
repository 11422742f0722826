#!/usr/bin/env python3
"""`taut verify --suite`: what it finds about a program, what a program's failure costs, results read back, engines side by side.

Usage: suite_test.py FOLDER_OF_TAUT [TEST ...]"""

import json
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "cli"))
from command_line import BINARIES, CommandLine, main, rows_of  # noqa: E402

SDK = HERE.parents[1] / "experiments" / "external" / "sdk"


def planted(fault="none", more=""):
    return f"external:cmd='\"{BINARIES}/tests/taut_planted_solver\"',fault={fault}{more}"


class Suite(CommandLine):
    def suite(self, *words, expect=0):
        return json.loads(self.taut("verify", "--suite", *words, "--json", expect=expect).out)

    def verdicts(self, fault, more=""):
        numbers = rows_of(self.suite("--solver", planted(fault, more), expect=1), "numbers")
        broken = [n for n in numbers if n["verdict"] == "broken"]
        return {n["phenomenon"] for n in broken}, broken[0]["quantity"]

    def test_a_sound_program_passes_and_its_numbers_stand_beside_their_closed_forms(self):
        answer = self.suite("--solver", planted())
        engine, = rows_of(answer, "engines")
        self.assertEqual((engine["failed"], engine["suite"], engine["first_failed"]), (0, 2, ""))
        self.assertEqual(engine["passed"] + engine["deviates"] + engine["not_claimed"], 33)
        self.assertIn("planted-1-", engine["version"])
        self.assertTrue(engine["machine"])
        sag, = [n for n in rows_of(answer, "numbers") if n["phenomenon"] == "wave"]
        self.assertAlmostEqual(sag["value"], sag["closed_form"], delta=sag["tolerance"])
        self.assertAlmostEqual(sag["ratio"], sag["value"] / sag["closed_form"])
        self.assertEqual(sag["needs"], "links, gravity")

    def test_what_a_program_lacks_is_not_claimed(self):
        toy = f"""external:cmd='python3 "{SDK}/toy.py"'"""
        answer = self.suite("--solver", toy)
        verdict = {row["phenomenon"]: row["verdict"] for row in rows_of(answer, "phenomena")}
        self.assertEqual([verdict[p] for p in ("pendulum", "wind", "friction")], ["passed", "not claimed", "not claimed"])

    def test_a_program_that_dies_hangs_or_lies_in_one_test_loses_that_test(self):
        self.assertEqual(self.verdicts("dies-in-wind")[0], {"wind"})
        self.assertEqual(self.verdicts("hangs-in-wind", ",timeout=1")[0], {"wind"})
        self.assertEqual(self.verdicts("lies-in-wind")[0], {"wind"})
        self.assertIn("timeout", self.verdicts("hangs-in-wind", ",timeout=1")[1])

    def test_a_program_that_is_wrong_everywhere_is_run_although_the_probe_refuses_it(self):
        broken, quantity = self.verdicts("gravity-halved")
        self.assertIn("free fall", broken)
        self.assertNotIn("inertia", broken)
        self.assertEqual(quantity, "distance of the acceleration from g, over |g|")

    def test_a_result_is_read_back_beside_other_engines(self):
        found = self.suite("--solver", planted("friction-halved"), expect=1)
        (self.folder / "before.json").write_text(json.dumps(found))
        answer = json.loads(self.taut("verify", "--beside", "before.json", "jakobsen", "--json", expect=1).out)
        self.assertEqual([row["first_failed"] for row in rows_of(answer, "engines")], ["friction", ""])
        before = [n for n in rows_of(answer, "numbers") if n["engine"].startswith("planted")]
        self.assertEqual(before, rows_of(found, "numbers"))
        friction, = [row for row in rows_of(answer, "phenomena") if row["phenomenon"] == "friction"]
        self.assertEqual(sorted(friction.values()), sorted(["friction", "gravity, planes, friction", "failed", "passed"]))
        shown = self.taut("verify", "--beside", "before.json", "--markdown", expect=1).out
        self.assertIn("| friction | failed |", shown)

    def test_the_scenes_of_the_tests_are_files(self):
        answer = json.loads(self.taut("verify", "any-fall", "any-pinch", "any-release", "--scenes", "scenes", "--json").out)
        files = [row["file"] for row in rows_of(answer, "scenes")]
        self.assertEqual(files, ["any-fall-1.json", "any-release-1.json", "any-pinch-1.json", "any-pinch-2.json", "any-pinch-3.json"])
        scenes = [json.loads((self.folder / "scenes" / file).read_text()) for file in files]
        self.assertEqual(scenes[0]["gravity"], [2.25, -3, 9])
        self.assertEqual([c["friction"] for scene in scenes[2:] for c in scene["colliders"]], [0.5, 0.5, 0, 0, 0.5, 0.5])
        self.taut("external", "scene", "hang", "-o", "hang.json")
        self.assertEqual(scenes[0].keys(), json.loads((self.folder / "hang.json").read_text()).keys())

    def test_bad_input_is_named(self):
        self.assertIn("nosuch.json", self.taut("verify", "--beside", "nosuch.json", expect=2).err)
        (self.folder / "other.json").write_text(self.taut("verify", "free-fall", "--json").out)
        self.assertIn("no result of the conformance suite", self.taut("verify", "--beside", "other.json", expect=2).err)
        self.assertIn("nobody", self.taut("verify", "--suite", "--solver", "nobody", expect=2).err)
        self.taut("verify", "--suite", "--assertions", expect=2)


if __name__ == "__main__":
    main()
