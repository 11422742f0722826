#!/usr/bin/env python3
"""The code in documents runs unchanged, and help() and the stubs for editors match the module.

Usage: documents_test.py BUILD [TEST...]"""

import ast
import inspect
import os
import pydoc
import re
import subprocess
import sys

import module
import numpy
import taut

PYTHON = module.TREE / "experiments/python"


class Documents(module.Case):
    def run_it(self, *words, expect=0):
        path = os.pathsep.join([str(module.BUILD / "python"), os.environ.get("PYTHONPATH", "")])
        done = subprocess.run([sys.executable, *map(str, words)], cwd=self.folder, env={**os.environ, "PYTHONPATH": path, "MPLBACKEND": "Agg"},
                              text=True, capture_output=True, timeout=100)
        self.assertEqual(done.returncode, expect, done.stdout + done.stderr)
        return done.stdout

    def blocks(self, document):
        return [block for block in re.findall(r"^```python\n(.*?)^```", document.read_text(), re.DOTALL | re.MULTILINE) if "import taut" in block]

    def test_the_readme_runs(self):
        block, = self.blocks(module.TREE / "README.md")
        first, second = self.run_it("-c", block).splitlines()
        self.assertRegex(first, r"^ok \d\.\d+(e-\d+)? \(\d+, 256, 3\)$")
        self.assertAlmostEqual(float(first.split()[1]), float(second), delta=1e-6)

    def test_the_examples_run(self):
        simulator, solver = self.blocks(PYTHON / "README.md")
        numbers = [line.split() for line in self.run_it("-c", simulator).splitlines()]
        self.assertEqual(len(numbers), 3)
        for name, *both in numbers:
            self.assertTrue(all(numpy.isfinite([float(one) for one in both])), name)
        lines = [line.split() for line in self.run_it("-c", solver).splitlines()]
        self.assertEqual([line[1] for line in lines], ["ok"] * 3)
        few, many, ours = (float(line[2]) for line in lines)
        self.assertLess(many, few / 2)
        self.assertLess(abs(many / ours - 1), 0.5, "the same algorithm in another order")

    def test_the_template_draws_a_scene_of_ones_own(self):
        try:
            import matplotlib  # noqa: F401
        except ImportError:
            self.skipTest("matplotlib is not installed")
        template = module.TREE / "experiments/templates/errors.py"
        self.assertLessEqual(len(template.read_text().splitlines()), 45)
        (self.folder / "mine.toml").write_text(module.SMALL)
        for words, picture in (((), "errors.png"), (("./mine.toml", "mine.png"), "mine.png")):
            lines = self.run_it(template, *words).splitlines()
            self.assertEqual(len(lines), 15)
            self.assertEqual((self.folder / picture).read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
            for name in ("Jakobsen", "XPBD", "Bullet"):
                errors = [float(line.split()[3]) for line in lines if line.startswith(name)]
                self.assertEqual(len(errors), 5)
                self.assertLess(errors[-1], errors[0] / 2, "more sweeps, less stretch")

    def test_help_has_shapes_units_and_errors(self):
        for name in ("scene", "simulate", "score", "solver", "results"):
            text = pydoc.plain(pydoc.render_doc(getattr(taut, name)))
            self.assertIn(f"{name}(", text)
            self.assertIn("Raises", text)
            for parameter in inspect.signature(getattr(taut, name)).parameters:
                self.assertRegex(text, rf"\n +{parameter} ", f"{name}: {parameter} is not explained")
        whole = pydoc.plain(pydoc.render_doc(taut))
        for name in taut.__all__:
            self.assertIn(name, whole)
            self.assertTrue(getattr(taut, name).__doc__, name)
        for kind in (taut.Scene, taut.Run):
            for name, member in vars(kind).items():
                if not name.startswith("_"):
                    self.assertTrue(member.__doc__, f"{kind.__name__}.{name}")
        self.assertEqual(taut.Scene.effects.__doc__, "What it has besides gravity, rigid links and pins that stay: 'colliders', 'moving pins', "
                                                     "'pins that let go', 'wind', 'bending', 'membrane', 'self-collision', 'damping', 'damping of links', 'damping of the membrane', 'elastic links'.")
        for kind, names in ((taut.Scene, ("x", "v", "rest", "mass", "rest_lengths", "dt", "gravity", "damping")), (taut.Run, ("t", "x", "x_end", "v_end"))):
            for name in names:
                self.assertRegex(getattr(kind, name).__doc__, r"\b(m|kg|s|1/s|m/s|m/s\^2)\b", f"unit of {name}")

    def test_the_stubs_are_what_there_is(self):
        tree = ast.parse((PYTHON / "package/__init__.pyi").read_text())
        classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
        functions = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
        public = {name for name in (*classes, *functions) if not name.startswith("_")}
        self.assertEqual(public, set(taut.__all__))
        for name, node in functions.items():
            self.compare(node, getattr(taut, name))
        run = taut.simulate(taut.scene(module.SMALL))
        try:
            taut.scene("a = 1\n")
        except taut.InputError as error:
            made = {"Scene": taut.scene(module.SMALL), "Run": run, "Diagnostic": error.diagnostics[0], "InputError": error}
        for name, node in classes.items():
            if name.startswith("_"):
                continue
            self.assertIn(getattr(taut, name), type(made[name]).__mro__)
            said = {member.name: member for member in node.body if isinstance(member, ast.FunctionDef)}
            there = {key for key in vars(type(made[name])) if not key.startswith("_")}
            self.assertEqual(set(said), there, name)
            for key, member in said.items():
                if member.decorator_list:
                    self.check_type(getattr(made[name], key), member.returns, f"{name}.{key}")
                else:
                    self.compare(member, getattr(type(made[name]), key))

    def compare(self, stub, function):
        """Compares the parameters of a stub with those of its original: names, kinds, defaults."""
        has = inspect.signature(function)
        args = stub.args
        said = [(arg.arg, "positional") for arg in args.posonlyargs + args.args if arg.arg != "self"] + [(arg.arg, "keyword") for arg in args.kwonlyargs]
        there = [(p.name, "keyword" if p.kind is p.KEYWORD_ONLY else "positional") for p in has.parameters.values() if p.name != "self"]
        self.assertEqual(said, there, stub.name)
        defaults = [ast.literal_eval(d) for d in (*args.defaults, *(d for d in args.kw_defaults if d is not None))]
        self.assertEqual(defaults, [p.default for p in has.parameters.values() if p.default is not p.empty], stub.name)

    def check_type(self, value, annotation, name):
        text = ast.unparse(annotation)
        if text in ("_Floats", "_Ints"):
            self.assertIsInstance(value, numpy.ndarray, name)
            self.assertEqual(value.dtype, numpy.float64 if text == "_Floats" else numpy.int32, name)
        else:
            kinds = {"str": str, "int": int, "float": float, "list": list, "dict": dict}
            self.assertIsInstance(value, kinds[text.split("[")[0]], name)
            if text == "list[str]":
                self.assertEqual({type(one) for one in value} - {str}, set(), name)


if __name__ == "__main__":
    module.main()
