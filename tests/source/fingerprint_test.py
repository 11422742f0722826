#!/usr/bin/env python3
"""A stored result stays valid until something changes on which it depends. Edits in a copy of the sources have to change
the digests of exactly those solvers that use what was edited.

Usage: fingerprint_test.py FINGERPRINT_WRITER"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
WRITER = pathlib.Path(sys.argv.pop()).resolve()
CALL = re.search(r"taut_write_fingerprint\((.*?)\)", (ROOT / "CMakeLists.txt").read_text(), re.S)[1]
LAYERS, PARTS = (re.findall(r'"([^"]+)"', folders) for folders in CALL.split("PARTS"))
PART_NAMES = {part.split("=")[0] for part in PARTS}
OF_THE_LOOP = {"admm", "avbd", "implicit", "jakobsen", "mass-spring", "pd", "vbd", "xpbd"}
OF_BULLET = {"bullet", "bullet-deformable"}


class Fingerprint(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.root = pathlib.Path(cls.folder.name) / "tree"
        for part in ("core", "bullet_ref", "experiments", "results/references"):
            shutil.copytree(ROOT / part, cls.root / part)
        cls.before = cls.digests()

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def digests(cls, tools="g++"):
        """Digest of each solver, of each layer (through one of its solvers) and of each part."""
        out = cls.root.parent / "fingerprint.cpp"
        subprocess.run([WRITER, out, cls.root, tools, *LAYERS, "--", *PARTS], check=True)
        solvers, layers = (dict(re.findall(r'solver == "(\S+)"\) return "(\w+)"', part)) for part in out.read_text().split("layer_digest"))
        layers = {"core/solver": layers["jakobsen"], "bullet_ref": layers["bullet"]}
        return {**solvers, **layers, **dict(re.findall(r'(\w+)\(\) \{ return "(\w+)"', out.read_text()))}

    def changed_by(self, *edits):
        """Names of the digests that these edits change. An edit is (file, text) or (file, old, new)."""
        kept = {file: (self.root / file).read_text() if (self.root / file).exists() else None for file, *_ in edits}
        try:
            for file, *change in edits:
                if len(change) == 2:
                    self.assertIn(change[0], kept[file], file)
                (self.root / file).write_text(kept[file].replace(*change, 1) if len(change) == 2 else change[0])
            after = self.digests()
        finally:
            for file, text in kept.items():
                if text is None:
                    (self.root / file).unlink()
                else:
                    (self.root / file).write_text(text)
        return {name for name in self.before | after if self.before.get(name) != after.get(name)}

    def add_to(self, file, code="int another = 1;\n"):
        return (file, (self.root / file).read_text() + code)

    def test_every_solver_has_its_own(self):
        self.assertEqual(set(self.before), OF_THE_LOOP | OF_BULLET | PART_NAMES | {"core/solver", "bullet_ref"})
        self.assertEqual(PART_NAMES, {"measurement", "external_client", "pictures"})
        self.assertEqual(len(set(self.before.values())), len(self.before))

    def test_comments_and_blank_lines_change_nothing(self):
        for file in ("core/solver/vbd.cpp", "core/solver/loop.hpp", "core/model/scene.hpp", "experiments/metrics/stretch.cpp"):
            for edit in (self.add_to(file, "\n\n// a \"comment\", a 'quote'\n"), self.add_to(file, "/* // several\n\" lines */\n"),
                         self.add_to(file, "// goes on \\\n behind its line\n"),
                         (file, "namespace taut", "namespace /* between */ taut"), (file, ";\n", ";  // at its end\n"),
                         (file, "(", "(/*a parameter's name=*/ ")):
                self.assertEqual(self.changed_by(edit), set(), edit)

    def digest_with(self, code):
        """Digest of vbd with this code appended to its own."""
        file = self.root / "core/solver/vbd.cpp"
        text = file.read_text()
        try:
            file.write_text(text + code)
            return self.digests()["vbd"]
        finally:
            file.write_text(text)

    def test_what_only_looks_like_a_comment_is_none(self):
        for one, other in (('"http://a"', '"http://b"'), ('"\\"//a"', '"\\"//b"'), ('R"x(" // a)x"', 'R"x(" // b)x"'),
                           ("'\"' //*a*/\n+ 1", "'\"' //*a*/\n+ 2")):
            self.assertNotEqual(self.digest_with(one), self.digest_with(other), one)

    def test_a_digit_separator_begins_no_literal(self):
        self.assertEqual(self.digest_with("1'000;\n"), self.digest_with("1'000;  // that's all\n"))

    def test_a_solvers_file_is_its_own(self):
        self.assertEqual(self.changed_by(self.add_to("core/solver/vbd.cpp")), {"vbd", "core/solver"})
        self.assertEqual(self.changed_by(self.add_to("bullet_ref/bullet_soft_body.cpp")), {"bullet", "bullet_ref"})

    def test_what_several_share_is_of_all_of_them(self):
        for file, solvers in (("core/solver/loop.cpp", OF_THE_LOOP), ("core/solver/loop.hpp", OF_THE_LOOP),
                              ("core/solver/vertex_blocks.hpp", {"vbd", "avbd"}), ("core/solver/constraints/relaxation.cpp", {"jakobsen", "xpbd"})):
            self.assertEqual(self.changed_by(self.add_to(file)), solvers | {"core/solver"}, file)
        self.assertEqual(self.changed_by(self.add_to("bullet_ref/bullet_solver.cpp")), OF_BULLET | {"bullet_ref"})
        self.assertEqual(self.changed_by(self.add_to("core/model/scene.cpp")), set(self.before))

    def test_a_source_without_a_header_of_its_own_is_of_those_that_it_implements(self):
        self.assertEqual(self.changed_by(self.add_to("core/solver/simd/instruction_set.cpp")),
                         OF_THE_LOOP | {"core/solver", "measurement", "pictures"})
        self.assertEqual(self.changed_by(self.add_to("core/solver/layout/jolt_order.cpp")), OF_THE_LOOP | {"core/solver"})

    def test_a_new_file_counts_where_it_is_used(self):
        new = "core/solver/contact/planted"
        files = [(new + ".hpp", "int planted();\n"), (new + ".cpp", f'#include "{new}.hpp"\nint planted() {{ return 1; }}\n')]
        self.assertEqual(self.changed_by(*files), {"core/solver"}, "nobody uses it")
        used = self.add_to("core/solver/pd.cpp", f'#include "{new}.hpp"\n')
        self.assertEqual(self.changed_by(*files, used), {"pd", "core/solver"})
        before = self.before
        try:  # with only its source changed
            for name, text in (*files, used):
                (self.root / name).write_text(text)
            type(self).before = self.digests()
            self.assertEqual(self.changed_by((new + ".cpp", "return 1", "return 2")), {"pd", "core/solver"})
        finally:
            type(self).before = before
            shutil.copy(ROOT / "core/solver/pd.cpp", self.root / "core/solver/pd.cpp")
            for name, _ in files:
                (self.root / name).unlink()

    def test_what_measures_is_no_solver(self):
        for file in ("experiments/metrics/stretch.cpp", "experiments/case/run_case.cpp", "experiments/case/divergence.cpp",
                     "core/reference/step_error.cpp"):
            self.assertEqual(self.changed_by(self.add_to(file)), {"measurement"}, file)
        self.assertEqual(self.changed_by(self.add_to("results/references/hang/static.json", " ")), {"measurement"})
        self.assertEqual(self.changed_by(self.add_to("experiments/case/record_io.cpp")), set())

    def test_a_part_has_what_it_uses_of_other_layers(self):
        for file in ("core/solver/simd/panels_impl.hpp", "core/solver/simd/kernels.cpp"):  # they solve exact steps
            self.assertEqual(self.changed_by(self.add_to(file)), OF_THE_LOOP | {"core/solver", "measurement", "pictures"}, file)
        self.assertEqual(self.changed_by(self.add_to("core/io/positions/sequence.cpp")), {"external_client", "pictures"})
        self.assertEqual(self.changed_by(self.add_to("experiments/case/computed_motion.cpp")), {"external_client"})
        self.assertEqual(self.changed_by(self.add_to("experiments/render/opengl/shaders.hpp")), {"pictures"})

    def test_a_file_that_stays_the_same_is_not_written_again(self):
        self.digests()
        out = self.root.parent / "fingerprint.cpp"
        before = out.stat().st_mtime_ns
        self.digests()
        self.assertEqual(out.stat().st_mtime_ns, before)

    def test_another_compiler_changes_all(self):
        after = self.digests("clang++")
        self.assertEqual({name for name in after if after[name] != self.before[name]}, set(self.before))

    def test_an_include_that_is_not_there_is_an_error(self):
        edit = self.add_to("core/solver/vbd.cpp", '#include "core/solver/planted.hpp"\n')
        with self.assertRaises(subprocess.CalledProcessError):
            self.changed_by(edit)


if __name__ == "__main__":
    unittest.main()
