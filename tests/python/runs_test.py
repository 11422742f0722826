#!/usr/bin/env python3
"""taut.simulate gives the same bits as the command line, releases the interpreter lock while it runs, and frees its memory.

Usage: runs_test.py BUILD [TEST...]"""

import csv
import gc
import json
import math
import os
import pathlib
import resource
import signal
import threading
import time

import module
import numpy
import taut


class Runs(module.Case):
    def test_the_bits_are_those_of_the_command_line(self):
        for scene, solver in (("hang", "jakobsen:iterations=8"), ("ball", "bullet:iterations=4"), ("swing", "xpbd"),
                              ("hang", "jakobsen:precision=float,threads=2")):
            with self.subTest(scene=scene, solver=solver):
                record = json.loads(self.taut("case", scene, solver, "--dt", "1/60", "--duration", 1, "--set", "cloth.grid=[16, 16]", "--json",
                                              "--trajectory", "run.npy", "--final-state", "end.csv"))
                run = taut.simulate(taut.scene(scene, {"cloth.grid": [16, 16]}), solver, dt="1/60", duration=1)
                frames = numpy.load(self.folder / "run.npy")
                self.assertEqual((run.x.dtype, run.x.shape), (numpy.float64, frames.shape))
                self.assertEqual(run.x.tobytes(), frames.astype(numpy.float64).tobytes())
                for field in ("digest", "values", "status", "params", "resolved_settings", "projections", "dt", "steps", "vertices", "links"):
                    self.assertEqual(run.record[field], record[field], field)
                self.assertEqual({k: None if math.isnan(v) else v for k, v in run.values.items()}, record["values"])
                rows = [[float(row[key]) for key in ("x", "y", "z", "vx", "vy", "vz")] for row in csv.DictReader((self.folder / "end.csv").read_text().splitlines())]
                self.assertTrue(numpy.array_equal(numpy.hstack([run.x_end, run.v_end]), rows))

    def test_a_prediction_is_that_of_the_command_line(self):
        solver = "jakobsen:projection=exact"
        asked = json.loads(self.taut("predict", "hang", solver, "--error", "1%", "--set", "cloth.grid=[12, 12]", "--json"))["tables"]["predictions"]
        names = [column["name"] for column in asked["columns"]]
        rows = taut.predict(taut.scene("hang", {"cloth.grid": [12, 12]}), solver, error=0.01)
        for row, cells in zip(rows, asked["rows"], strict=True):
            said = dict(zip(names, cells, strict=True))
            self.assertEqual((row["solver"], row["rms"], row["largest"], row["refused"]), (said["setting"], said["rms"], said["largest"], []))
            self.assertLessEqual(row["rms"], 0.01)
        refused = taut.predict("ball")[0]
        self.assertIn("contact: ", refused["refused"][0])
        self.assertTrue(math.isnan(refused["rms"]))
        with self.assertRaisesRegex(taut.InputError, "error: -1; must be above 0"):
            taut.predict("hang", error=-1)
        with self.assertRaisesRegex(taut.InputError, "at most one of error, stiffness and budget"):
            taut.predict("hang", error=0.1, budget=1)

    def test_the_key_is_the_one_of_the_results_file(self):
        record = json.loads(self.taut("case", "hang", "jakobsen", "--dt", "1/60", "--duration", "0.5", "--json"))
        run = taut.simulate("hang", dt="1/60", duration=0.5)
        self.assertEqual(run.record["key"], record["key"])
        self.assertEqual(run.record["id"], record["id"])
        self.assertEqual(taut.simulate("hang", dt=1 / 60, duration=0.5).record["key"], record["key"], "a number of Python is as exact")

    def test_frames_and_series_stand_at_the_same_moments(self):
        scene = taut.scene(module.SMALL)
        for every, steps in ((1, range(33)), (5, [0, 5, 10, 15, 20, 25, 30, 32]), (32, [0, 32]), (100, [0, 32])):
            run = taut.simulate(scene, every=every)
            self.assertEqual(run.series["step"].tolist(), list(steps))
            self.assertEqual(run.t.tolist(), run.series["t"].tolist())
            self.assertEqual(run.t.tolist(), [k / 64 for k in steps])
            self.assertEqual(run.x.shape, (len(run.t), 64, 3))
            self.assertTrue(numpy.array_equal(run.x[-1], run.x_end))
            self.assertEqual(set(map(len, run.series.values())), {len(run.t)})
        links, rest = scene.links, scene.rest_lengths
        whole = taut.simulate(scene)
        strains = numpy.linalg.norm(whole.x[:, links[:, 1]] - whole.x[:, links[:, 0]], axis=2) / rest - 1
        families = numpy.array(scene.families)
        structural = strains[:, (families == "structural") | (families == "shear")]
        self.assertLess(abs(numpy.sqrt((structural ** 2).mean(axis=1)) - whole.series["stretch.rms"]).max(), 1e-12)
        none = taut.simulate(scene, every=0)
        self.assertEqual((none.x.shape, none.t.shape, none.series), ((0, 64, 3), (0,), {}))
        self.assertEqual((none.record["values"], none.record["digest"]), (whole.record["values"], whole.record["digest"]))

    def test_a_numerical_failure_is_a_status(self):
        run = taut.simulate(taut.scene(module.SMALL), "mass-spring:structural=1e9,substeps=1")
        self.assertEqual(run.status, "exploded")
        self.assertRegex(run.verdict, r"exploded \(\w+\) at step \d+")
        self.assertIn("exploded", repr(run))
        self.assertTrue(all(map(math.isnan, run.values.values())))
        self.assertEqual(len(run.t), run.record["status"]["step"], "frames up to the last stable one")
        self.assertTrue(numpy.isfinite(run.x).all())
        friction = taut.simulate("incline", "bullet:friction=refuse")
        self.assertEqual((friction.status, friction.x.shape[0], friction.x_end.shape), ("unsupported", 0, (0, 3)))
        self.assertIn("friction", friction.verdict)

    def test_cost_is_the_steps_alone(self):
        scene = taut.scene(module.SMALL)
        few, many = (min(taut.simulate(scene, f"jakobsen:substeps=1,iterations={k}", every=0).cpu_seconds for _ in range(5)) for k in (50, 2000))
        self.assertGreater(few, 0)
        self.assertGreater(many, 4 * few)

    def test_other_threads_run_meanwhile(self):
        ticks, done = [], threading.Event()

        def count():
            while not done.is_set():
                ticks.append(time.monotonic())
                time.sleep(0.001)

        other = threading.Thread(target=count)
        other.start()
        begin = time.monotonic()
        taut.simulate("hang", "jakobsen:substeps=1,iterations=60", every=0)
        end = time.monotonic()
        done.set()
        other.join()
        self.assertGreater(end - begin, 0.1)
        self.assertGreater(sum(begin < tick < end for tick in ticks), 50 * (end - begin), "of a thousand a second on a free machine")

    def test_runs_at_once_give_what_each_gives_alone(self):
        texts = ["jakobsen:threads=2", "xpbd", "bullet", "pd", "admm", "vbd", "implicit"]
        scene = taut.scene(module.SMALL, {"time.duration": 1})
        alone = {text: taut.simulate(scene, text).record["digest"] for text in texts}
        together, threads = {}, []
        for k, text in enumerate(2 * texts):
            threads.append(threading.Thread(target=lambda k=k, text=text: together.update({(k, text): taut.simulate(scene, text).record["digest"]})))
            threads[-1].start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(together), 2 * len(texts))
        for (_, text), digest in together.items():
            self.assertEqual(digest, alone[text], text)

    def test_ctrl_c_ends_a_run_and_nothing_else(self):
        timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        begin = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            taut.simulate("hang", "jakobsen:substeps=1,iterations=1000", duration=100)
        self.assertLess(time.monotonic() - begin, 3)
        self.assertEqual(taut.simulate(taut.scene(module.SMALL)).status, "ok")

    def test_python_ends_while_a_daemon_thread_runs(self):
        """Python would end the thread where it next takes the interpreter's lock, in the middle of C++."""
        for solver in ("jakobsen:threads=2", "bullet", "idle"):
            with self.subTest(solver):
                begin = time.monotonic()
                done = self.python("import threading, time, taut\n"
                                   "@taut.solver('idle')\n"
                                   "class Idle:\n"
                                   "    def load(self, scene, x, v): self.x, self.v = x, v\n"
                                   "    def step(self, t, dt): time.sleep(0)\n"
                                   "    def store(self): return self.x, self.v\n"
                                   "begun = threading.Event()\n"
                                   "def run():\n"
                                   "    while True:\n"
                                   "        begun.set()\n"
                                   f"        taut.simulate('hang', {solver!r}, duration=2000, every=100000)\n"
                                   "for _ in range(2): threading.Thread(target=run, daemon=True).start()\n"
                                   "begun.wait()\n"
                                   "time.sleep(0.2)\n"
                                   "print('the end')")
                self.assertEqual((done.stdout, done.stderr), ("the end\n", ""))
                self.assertLess(time.monotonic() - begin, 20)

    def test_a_process_that_was_forked_meanwhile_ends(self):
        done = self.python("import os, sys, threading, time, taut\n"
                           "threading.Thread(target=lambda: taut.simulate('hang', duration=2000, every=100000), daemon=True).start()\n"
                           "time.sleep(0.2)\n"
                           "if os.fork() == 0: sys.exit()  # which waits for no thread of its parent\n"
                           "print(os.wait()[1])")
        self.assertEqual((done.stdout, done.stderr), ("0\n", ""))

    def test_no_memory_grows(self):
        scene = taut.scene(module.SMALL, {"cloth.grid": [12, 12]})

        @taut.solver("lazy")
        class Lazy:
            def load(self, scene, x, v): self.x, self.v = x, v
            def step(self, t, dt): pass
            def store(self): return self.x, self.v

        def raises(self, t, dt):
            raise RuntimeError("no")
        taut.solver("raising")(type("Raising", (Lazy,), {"step": raises}))

        def once():
            run = taut.simulate(scene, "jakobsen:substeps=1")  # 33 frames of 144 vertices: 114 kB
            taut.score(scene, run.x)
            taut.simulate(scene, "lazy", duration="1/64")
            for wrong in ("jakobsen:nothing=1", "raising"):
                with self.assertRaises(Exception):
                    taut.simulate(scene, wrong)

        def resident():
            gc.collect()
            return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()

        for _ in range(100):
            once()
        before = resident()
        for _ in range(1000):
            once()
        self.assertLess((resident() - before) / 1000, 1000, "bytes a round; a frame has 3456")


if __name__ == "__main__":
    module.main()
