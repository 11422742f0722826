#!/usr/bin/env python3
"""`bench --beside`: each adapter builds against our stand-ins, which have the names that it uses, and runs.

Usage: beside_test.py BUILD_FOLDER"""

import pathlib
import shutil
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
from command_line import CommandLine, facts_of, rows_of  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
STUBS = ROOT / "tests/beside/stubs"


class Beside(CommandLine):
    def beside(self, checkout, **more):
        return self.taut("bench", "--beside", checkout, "--rounds", 1, "--json", **more)

    def test_every_adapter_builds_and_runs(self):
        adapters = {path.stem for path in (ROOT / "experiments/beside").glob("*.cpp")}
        self.assertEqual(len(adapters), len(list(STUBS.iterdir())), "a stand-in for each")
        for stub in sorted(STUBS.iterdir()):
            with self.subTest(stub.name):
                answer = self.answer("bench", "--beside", stub, "--rounds", 1)
                theirs, ours, jakobsen = rows_of(answer, "iterations")
                self.assertTrue(theirs["code"].startswith(stub.name))
                self.assertTrue(theirs["differs"])
                self.assertGreater(ours["each"], 0)
                self.assertAlmostEqual(ours["sweeps"], ours["each"] / jakobsen["each"])
                self.assertAlmostEqual(theirs["sweeps"], theirs["each"] / jakobsen["each"])
                self.assertAlmostEqual(facts_of(answer)["times"], theirs["each"] / ours["each"])

    def test_what_is_no_checkout_is_said(self):
        said = self.beside(self.folder, expect=2).err
        self.assertIn("no adapter knows this checkout", said)
        self.assertIn("TinyVBD (which has Strand.h)", said)
        self.assertIn("takes no study or scene", self.taut("bench", "hang", "--beside", STUBS / "ShapeOp", expect=2).err)

    def test_what_does_not_build_ends_with_the_compilers_words(self):
        copy = self.folder / "checkout"
        shutil.copytree(STUBS / "ShapeOp", copy)
        solver = copy / "libShapeOp/src/Solver.h"
        solver.write_text(solver.read_text().replace("bool solve(", "bool solved("))
        said = self.beside(copy, expect=2).err
        self.assertIn("the build of shapeop.cpp failed", said)
        self.assertIn("error:", said)

    def test_a_net_that_flies_away_is_no_measurement(self):
        copy = self.folder / "checkout"
        shutil.copytree(STUBS / "ShapeOp", copy)
        solver = copy / "libShapeOp/src/Solver.h"
        solver.write_text(solver.read_text().replace("+= dt_ * dt_", "-= 10000 * dt_ * dt_"))
        self.assertIn("the adapter's net does not hang", self.beside(copy, expect=2).err)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])
