#!/usr/bin/env python3
"""Numbers are read and written alike under a locale with a decimal comma and groups of digits (de_DE) and one with other letters (tr_TR): a program
that embeds taut may have set any.

Usage: locales_test.py BUILD"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "build/default").resolve()
LOCALES = ("de_DE", "tr_TR")
# The unit tests that read or write numbers, and those that were red under de_DE.
TESTS = ("Text.*:Params.*:Significant.*:Numbers.*:Format.*:Figures.*:Answers.*:CsvText.*:JsonText.*:JsonReader.*:Document.*:Toml.*:SceneFiles.*:"
         "SceneKeys.*:SceneSetting.*:SceneValues.*:SceneDigests.*:MeshFromObj.*:BodyFiles.*:Positions.*:MotionFiles.*:ComputedMotions.*:Settings.*:"
         "SolverSettings.*:SolverText.*:BulletSettings.*:Baseline*.*:Frontier*.*:Plots.*:PlotKinds.*:Study.*:StudyFile.*:StoreTest.*:StoreScale.*:"
         "RecordText.*:RecordLine.*:Isolated.*:IsolatedRun.*:LinearStability.*:TimingWorkers.*:Hello.*:Probe.*:Limits.*:JobScript.*:Drawn.*:TruthSolvers.*")

# As H1_locale.py of the attack: the same bits, whichever locale is set.
MODULE = """
import locale, sys
import numpy, taut
scene = taut.scene("hang", {"cloth.grid": [4, 4]})
def runs():
    all = [taut.simulate(scene, solver, duration="0.2") for solver in ("jakobsen:omega=0.7", "xpbd:structural=0.001", "implicit:iterations=3", "bullet")]
    taut.score(scene, all[0].x, fps=60)
    return [(run.status, run.x.tobytes(), run.record["key"], str(run.values), str(run.record["resolved_settings"])) for run in all]
before = runs()
locale.setlocale(locale.LC_ALL, sys.argv[1])
assert locale.localeconv()["decimal_point"] == ","
assert runs() == before
"""


class Locales(unittest.TestCase):
    def each(self, program, *words):
        with tempfile.TemporaryDirectory() as made:
            for name in LOCALES:
                subprocess.run(["localedef", "--no-archive", "-i", name, "-f", "UTF-8", f"{made}/{name}.UTF-8"], check=True, capture_output=True)
                with self.subTest(locale=name):
                    done = subprocess.run([program, *words, f"{name}.UTF-8"][:None if program == sys.executable else -1], cwd=made, text=True, capture_output=True,
                                          env=os.environ | {"LANGUAGE": "en", "LOCPATH": made, "TAUT_TESTS_LOCALE": f"{name}.UTF-8", "PYTHONPATH": str(BUILD / "python")}, timeout=250)
                    self.assertEqual(done.returncode, 0, (done.stdout + done.stderr)[-6000:])
                    yield done

    def test_the_unit_tests_of_numbers_pass(self):
        for done in self.each(BUILD / "tests/taut_tests", f"--gtest_filter={TESTS}", "--gtest_brief=1"):
            self.assertRegex(done.stdout, r"\[  PASSED  \] \d{3,} tests|\[  PASSED  \] \d\.\d{3} tests")

    @unittest.skipUnless((BUILD / "python/taut").is_dir(), "the Python module is not built")
    def test_the_python_module_gives_the_same_bits(self):
        for _ in self.each(sys.executable, "-c", MODULE):
            pass


if __name__ == "__main__":
    why = "localedef is not installed" if not shutil.which("localedef") else next(
        (f"/usr/share/i18n/locales/{name} is not there" for name in LOCALES if not pathlib.Path("/usr/share/i18n/locales", name).is_file()), "")
    if why:
        print("skipped:", why)
        sys.exit(77)
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])
