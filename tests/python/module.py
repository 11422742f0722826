"""Shared by the tests of the Python module: imports taut from the build in the first argument and runs its command line."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

TREE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else TREE / "build/default").resolve()
sys.path.insert(0, str(BUILD / "python"))

SMALL = """
summary = "A small sheet on two pins"
[cloth]
grid = [8, 8]
size = [1.0, 1.0]
mass = 0.2
pins = ["top-left", "top-right"]
[time]
dt = "1/64"
duration = 0.5
"""


class Case(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.addCleanup(os.chdir, os.getcwd())

    def taut(self, *words, expect=0):
        done = subprocess.run([BUILD / "taut", *map(str, words)], cwd=self.folder, text=True, capture_output=True, timeout=250)
        self.assertEqual(done.returncode, expect, done.stdout + done.stderr)
        return done.stdout

    def python(self, text, expect=0, **more):
        """Runs a separate program that imports taut."""
        done = subprocess.run([sys.executable, "-c", f"import sys\nsys.path.insert(0, {str(BUILD / 'python')!r})\n{text}"],
                              cwd=self.folder, text=True, capture_output=True, timeout=60, **more)
        self.assertEqual(done.returncode, expect, done.stdout + done.stderr)
        return done

    def refused(self, *parts):
        """A context that expects an InputError whose text contains all of these."""
        import taut

        case = self

        class Refused:
            def __enter__(self):
                return self

            def __exit__(self, kind, error, trace):
                case.assertIsNotNone(kind, "nothing was raised")
                if not issubclass(kind, taut.InputError):
                    return False
                for part in parts:
                    case.assertIn(part, str(error))
                self.error = error
                return True

        return Refused()


def main():
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)
