#!/usr/bin/env python3
"""Tests changed.py on a small repository: it names the tests of the layer that changed and what includes the change, and no others."""

import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

FILES = {
    "core/model/planted_base.hpp": "int base();\n",
    "core/model/planted_base.cpp": '#include "core/model/planted_base.hpp"\n',
    "core/solver/planted_uses.hpp": '#include "core/model/planted_base.hpp"\n',
    "experiments/report/planted_far.cpp": '#include "core/solver/planted_uses.hpp"\n',
    "experiments/report/planted_far.hpp": "",
    "tests/model/planted_base_test.cpp": '#include "core/model/planted_base.hpp"\nTEST(Base, Is) {}\n',
    "tests/solver/planted_solver_test.cpp": '#include "core/model/planted_other.hpp"\nTEST_P(Solver, Is) {}\n',
    "tests/report/planted_far_test.cpp": '#include "experiments/report/planted_far.hpp"\nTEST_F(Far, Is) {}\n',
    "tests/report/planted_page_test.py": "",
    "README.md": "",
}


class Changed(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.root = pathlib.Path(scratch.name)
        for name, text in FILES.items():
            (self.root / name).parent.mkdir(parents=True, exist_ok=True)
            (self.root / name).write_text(text)
        self.script = self.root / "tests/source/changed.py"
        self.script.parent.mkdir()
        shutil.copy(pathlib.Path(__file__).with_name("changed.py"), self.script)
        self.git("init", "-q", "-b", "main")
        self.commit()

    def git(self, *words):
        subprocess.run(["git", "-C", self.root, "-c", "user.name=a", "-c", "user.email=a@x", *words], check=True, capture_output=True)

    def commit(self):
        self.git("add", "-A")
        self.git("commit", "-q", "-m", "a commit")

    def names(self, *words, expect=0):
        """Those of these tests that are run."""
        done = subprocess.run(["python3", self.script, *words], text=True, capture_output=True)
        self.assertEqual(done.returncode, expect, done.stderr)
        self.assertNotIn("(", done.stdout, "of which ctest takes few")
        known = ["Base.Is", "f32.Every/Solver.Is/3", "Far.Is", "planted_page_test", "layers"]
        return [name for name in known if expect == 0 and re.search(done.stdout.strip(), name)]

    def edit(self, name):
        with (self.root / name).open("a") as out:
            out.write("// changed\n")

    def test_what_includes_the_change_is_run(self):
        self.assertEqual(self.names(), ["layers"])
        self.edit("core/model/planted_base.cpp")
        self.assertEqual(self.names(), ["Base.Is", "Far.Is", "layers"])

    def test_the_layer_of_the_change_is_run(self):
        self.edit("core/solver/planted_uses.hpp")
        self.assertEqual(self.names(), ["f32.Every/Solver.Is/3", "Far.Is", "layers"])
        self.commit()
        self.assertEqual(self.names(), ["layers"])
        self.edit("experiments/report/planted_far.cpp")
        self.assertEqual(self.names(), ["Far.Is", "planted_page_test", "layers"])

    def test_new_files_and_other_commits_count(self):
        self.edit("experiments/report/planted_far.cpp")
        self.commit()
        (self.root / "core/model/planted_new.cpp").write_text("")
        self.assertEqual(self.names("HEAD~1"), ["Base.Is", "Far.Is", "planted_page_test", "layers"])
        self.assertEqual(self.names(), ["Base.Is", "layers"])
        self.names("nonsense", expect=1)


if __name__ == "__main__":
    unittest.main(verbosity=2)
