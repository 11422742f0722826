#!/usr/bin/env python3
"""A wrong input raises an exception that names the error, and the interpreter survives.

Usage: inputs_test.py BUILD [TEST...]"""

import json
import os
import pathlib
import subprocess

import module
import numpy
import taut


class Inputs(module.Case):
    def test_a_scene_is_a_name_a_path_or_a_text(self):
        (self.folder / "mine.toml").write_text(module.SMALL)
        want = taut.scene(module.SMALL).digest
        os.chdir(self.folder)
        for source in ("./mine.toml", "mine.toml", pathlib.Path("mine.toml"), self.folder / "mine.toml", str(self.folder / "mine.toml")):
            scene = taut.scene(source)
            self.assertEqual((scene.digest, scene.name), (want, "mine"))
        again = taut.scene(module.SMALL, {"time.dt": "1/60"}).replace({"time.dt": "1/50"})
        self.assertAlmostEqual(again.dt, 1 / 50, delta=1e-9)
        record = taut.simulate(again, dt="1/40", duration=0.1).record
        self.assertEqual(record["spec"]["settings"], ['time.dt="1/40"', "time.duration=0.1"], "what was replaced is not there")
        self.assertEqual(taut.scene(taut.scene(module.SMALL), {"cloth.mass": 0.3}).mass.sum().round(12), 0.3)
        self.assertEqual(taut.simulate("mine.toml", duration="1/64").record["scene"], "mine")
        named = taut.scene(module.SMALL, name="shirt")
        self.assertEqual(named.name, "shirt")
        (self.folder / "two.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        meshed = taut.scene('summary = "A triangle"\n[cloth]\nmesh = "two.obj"\nmass = 1\n[time]\ndt = 0.01\nduration = 1\n')
        self.assertEqual(meshed.triangles.tolist(), [[0, 1, 2]], "looked for in this folder")

    def test_settings_are_what_the_command_line_sets(self):
        for settings, words in (({"cloth.grid": [5, 4]}, ["cloth.grid=[5, 4]"]), ({"cloth.grid": numpy.array([5, 4])}, ["cloth.grid=[5, 4]"]),
                                ({"cloth.grid": (5, 4), "time.dt": "1/60"}, ["cloth.grid=[5, 4]", "time.dt=\"1/60\""]),
                                ({"cloth.mass": numpy.float64(0.3), "cloth.pins": ["top-left"]}, ["cloth.mass=0.3", "cloth.pins=[\"top-left\"]"]),
                                ({"links.bend": True, "forces.damping": numpy.float32(0.5)}, ["links.bend=true", "forces.damping=0.5"]),
                                ({"wind": {"velocity": [1, 0, 0.5], "strength": 0.2}}, ["wind={velocity=[1,0,0.5],strength=0.2}"])):
            with self.subTest(settings):
                scene = taut.scene("hang", settings)
                record = json.loads(self.taut("case", "hang", "jakobsen", "--json", "--duration", "0.1", *(w for word in words for w in ("--set", word))))
                run = taut.simulate(scene, duration=0.1, every=0)
                self.assertEqual(run.record["digest"], record["digest"])
                self.assertEqual(taut.scene("hang").replace(settings).digest, scene.digest)
        for value, said in (({1}, "set"), (b"1", "bytes"), (None, "NoneType"), ([object()], "object")):
            with self.refused("cloth.mass", said):
                taut.scene("hang", {"cloth.mass": value})

    def test_errors_name_file_line_column_and_key(self):
        text = module.SMALL.replace("mass = 0.2", "mas = 0.2").replace('dt = "1/64"', "dt = -1")
        with self.refused("mine.toml:6:1: ", "unknown key 'mas' in [cloth]; did you mean 'mass'?", "mine.toml:9:", "'dt' in [time]") as refused:
            taut.scene(text, name="mine")
        places = {(one.file, one.line, one.column) for one in refused.error.diagnostics}
        self.assertIn(("mine.toml", 6, 1), places)
        self.assertGreaterEqual(len(places), 2, "all that is wrong, at once")
        self.assertIn("'mas'", next(one.message for one in refused.error.diagnostics if one.line == 6))
        (self.folder / "broken.toml").write_text("a = [\n")
        with self.refused("broken.toml:"):
            taut.scene(self.folder / "broken.toml")
        (self.folder / "bytes.toml").write_bytes(b'summary = "\xff\xfe"\n')
        with self.refused("bytes.toml:1"):
            taut.scene(self.folder / "bytes.toml")
        for source, said in (("hnag", "did you mean 'hang'"), ("no/such.toml", "no/such.toml"), (self.folder, "folder"), ("", "unknown scene"), (3, "int"),
                             (None, "NoneType"), ("hang:cloth.grid=[3,3]", "settings")):
            with self.subTest(source), self.refused(said):
                taut.scene(source)
        scene = taut.scene(module.SMALL)
        for call, said in ((lambda: taut.simulate(scene, "jakobsne"), ("did you mean 'jakobsen'?",)),
                           (lambda: taut.simulate(scene, "jakobsen:iterations=x,omga=1"), ("column 10", "iterations", "omga")),
                           (lambda: taut.simulate(scene, ""), ("unknown solver ''",)),
                           (lambda: taut.simulate(scene, "bullet:precision=float"), ("taut-f32",)),
                           (lambda: taut.simulate(scene, "external:cmd='true'"), ("external",)),
                           (lambda: taut.simulate(scene, dt=0), ("time.dt=0", "'dt'")), (lambda: taut.simulate(scene, dt="1/0"), ("dt",)),
                           (lambda: taut.simulate(scene, dt=float("nan")), ("dt",)), (lambda: taut.simulate(scene, duration=-1), ("duration",)),
                           (lambda: taut.simulate(scene, duration=[1]), ("duration",)), (lambda: taut.simulate(scene, every=-1), ("every: -1",)),
                           (lambda: scene.replace({"cloth.gird": 1}), ("cloth.gird=1", "did you mean 'grid'")),
                           (lambda: scene.surface(0, scene.x, 0), ("collider: 0",)),
                           (lambda: taut.scene("ball").surface(0, scene.x[0], 0), ("x", "(3,)", "(n, 3)"))):
            with self.subTest(said), self.refused(*said):
                call()
        for call in (lambda: taut.simulate(), lambda: taut.simulate(scene, 3), lambda: taut.simulate(scene, every=0.5), lambda: taut.simulate(scene, nothing=1),
                     lambda: taut.score(scene), lambda: taut.scene("hang", 3), lambda: scene.pin_positions("now")):
            self.assertRaises((TypeError, ValueError), call)
        for read_only in ("x", "dt", "name"):
            with self.assertRaises(AttributeError):
                setattr(scene, read_only, 1)
        self.assertRaises(TypeError, taut.Scene)
        self.assertEqual(taut.simulate(scene).status, "ok")

    def test_what_no_memory_holds_is_a_memory_error(self):
        done = self.python("import resource, taut\nsize = int(open('/proc/self/statm').read().split()[0]) * 4096 + (64 << 20)\n"
                           "resource.setrlimit(resource.RLIMIT_AS, (size, size))\n"
                           "try:\n    taut.simulate('hang', duration=1e6)\nexcept MemoryError:\n    print('no memory')\n"
                           "print(taut.simulate('hang', duration=0.1).status)")
        self.assertEqual(done.stdout.split("\n")[:2], ["no memory", "ok"])

    def test_another_interpreter_of_the_process_is_refused(self):
        done = self.python("import _xxsubinterpreters as all, taut\n"
                           "one = all.create()\n"
                           f"try:\n    all.run_string(one, '''import sys\\nsys.path.insert(0, {str(module.BUILD / 'python')!r})\\nimport taut''')\n"
                           "except all.RunFailedError as error:\n    print(error)\n"
                           "print(taut.simulate('hang', duration=0.1).status)")
        self.assertRegex(done.stdout, r"ImportError.*main interpreter(.|\n)*\nok\n")
        done = self.python("import _xxsubinterpreters as all\none = all.create()\n"
                           f"try:\n    all.run_string(one, '''import sys\\nsys.path.insert(0, {str(module.BUILD / 'python')!r})\\nimport taut._taut''')\n"
                           "except all.RunFailedError as error:\n    print(error)\n"
                           "import taut\nprint(taut.simulate('hang', duration=0.1).status)")
        self.assertRegex(done.stdout, r"ImportError(.|\n)*\nok\n")

    def test_a_process_that_was_forked_goes_on(self):
        done = self.python("import multiprocessing, taut\n"
                           "def run(k): return taut.simulate('hang', f'jakobsen:iterations={k},threads=2', duration=0.2).record['digest']\n"
                           "with multiprocessing.get_context('fork').Pool(2) as pool:\n    there = pool.map(run, [1, 2, 3])\n"
                           "print(there == [run(k) for k in (1, 2, 3)])")
        self.assertEqual(done.stdout, "True\n")

    def test_an_import_is_quick_and_brings_neither_pandas_nor_matplotlib(self):
        done = self.python("import time, taut\nprint(time.process_time())\n"  # includes the interpreter and NumPy
                           "print({'pandas', 'matplotlib'} & set(sys.modules))")
        seconds, brought = done.stdout.splitlines()
        self.assertLess(float(seconds), 0.5)
        self.assertEqual(brought, "set()")

    def test_results_are_a_frame_of_the_view(self):
        try:
            import pandas
        except ImportError:
            self.skipTest("pandas is not installed")
        (self.folder / "small.toml").write_text(module.SMALL)
        (self.folder / "one.toml").write_text('question = "?"\nscenes = ["./small.toml"]\nsolvers = ["jakobsen", "xpbd"]\n')
        self.taut("run", "./one.toml", "--out", "runs", "--quiet")
        frame = taut.results(self.folder / "runs")
        self.assertIsInstance(frame, pandas.DataFrame)
        rms = frame[(frame.metric == "stretch.rms") & (frame.status == "ok")]
        self.assertEqual(sorted(rms.solver), ["jakobsen", "xpbd"])
        for row in rms.itertuples():
            self.assertEqual(row.value, taut.simulate(self.folder / "small.toml", row.solver).values["stretch.rms"])
        self.assertTrue(frame.equals(taut.results(self.folder / "runs/results.db")))
        os.chdir(self.folder)
        os.environ["TAUT_RESULTS"] = "."
        self.addCleanup(os.environ.pop, "TAUT_RESULTS")
        self.assertTrue(frame.equals(taut.results()))
        (self.folder / "text.db").write_text("no database at all, but a text of some length\n" * 9)
        for wrong in ("nowhere", self.folder, "text.db"):
            with self.refused(str(wrong), "no results file") as refused:
                taut.results(wrong)
            self.assertEqual([one.file for one in refused.error.diagnostics], [str(wrong)])
        before = sorted(p.name for p in (self.folder / "runs").iterdir())
        subprocess.run(["chmod", "-R", "a-w", self.folder / "runs"], check=True)
        self.assertTrue(frame.equals(taut.results("runs")))
        self.assertEqual(sorted(p.name for p in (self.folder / "runs").iterdir()), before)
        subprocess.run(["chmod", "-R", "u+w", self.folder / "runs"], check=True)


if __name__ == "__main__":
    module.main()
