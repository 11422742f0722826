#!/usr/bin/env python3
"""A solver in Python is judged like our solvers: the textbook's listing gives jakobsen's results.

Usage: solvers_test.py BUILD [TEST...]"""

import threading
import traceback

import module
import numpy
import taut


@taut.solver("textbook", parameters={"iterations": 8})
class Textbook:
    """Jakobsen 2001 with the square root, one link after another."""

    @staticmethod
    def unsupported(scene):
        return scene.effects

    def load(self, scene, x, v):
        self.scene, self.x, self.v = scene, x, v
        self.w, self.gravity = scene.inverse_mass, scene.gravity * (scene.inverse_mass[:, None] > 0)
        self.links, self.rest = scene.links.tolist(), scene.rest_lengths.tolist()

    def step(self, t, dt):
        x = self.x + dt * self.v + dt * dt * self.gravity
        for _ in range(self.iterations):
            for (a, b), rest in zip(self.links, self.rest):
                d = x[b] - x[a]
                length = numpy.sqrt(d @ d)
                if (w := self.w[a] + self.w[b]) > 0:
                    d *= (length - rest) / (length * w)
                    x[a] += self.w[a] * d
                    x[b] -= self.w[b] * d
        self.x, self.v = x, (x - self.x) / dt

    def store(self):
        return self.x, self.v


class Still:
    def load(self, scene, x, v): self.x, self.v = x, v
    def step(self, t, dt): pass
    def store(self): return self.x, self.v


class Falls:
    """Vertices without links, under this share of gravity."""
    share = 1.0

    @staticmethod
    def unsupported(scene): return scene.effects + (["links"] if len(scene.links) else [])
    def load(self, scene, x, v): self.x, self.v, self.gravity = x, v, self.share * scene.gravity * (scene.inverse_mass[:, None] > 0)

    def step(self, t, dt):
        if numpy.linalg.norm(self.gravity) > self.raises:
            raise ArithmeticError("too heavy")
        self.v = self.v + dt * self.gravity
        self.x = self.x + dt * self.v

    def store(self): return self.x, self.v
    raises = 1e300


def still(**methods):
    return type("Made", (Still,), methods)


class Solvers(module.Case):
    def broken(self, **members):
        taut.solver("falls")(type("Made", (Falls,), members))
        rows = taut.verify("falls")
        self.assertEqual(len({row["phenomenon"] for row in rows}), len({row["test"] for row in rows}))
        self.assertIn("not applicable", {row["verdict"] for row in rows if row["phenomenon"] == "pendulum"})
        return [row for row in rows if row["verdict"] == "broken"]

    def test_the_conformance_suite_names_what_a_class_gets_wrong(self):
        self.assertEqual(self.broken(), [])
        self.assertEqual([row["phenomenon"] for row in self.broken(share=0.5)], ["free fall"] * 2)
        one, = {(row["phenomenon"], row["why"].split("\n")[0]) for row in self.broken(raises=1) if row["phenomenon"] == "free fall"}
        self.assertEqual(one, ("free fall", "ArithmeticError: too heavy"))
        fall = [row for row in taut.verify("jakobsen") if row["test"] == "any-pendulum"][0]
        self.assertAlmostEqual(fall["ratio"], fall["value"] / fall["closed_form"])
        with self.assertRaisesRegex(taut.InputError, "nobody"):
            taut.verify("nobody")

    def test_the_textbook_gives_what_ours_gives(self):
        scene = taut.scene(module.SMALL)
        ours = taut.simulate(scene, "jakobsen:substeps=1,order=mesh,projection=exact,precision=double,iterations=4")
        run = taut.simulate(scene, "textbook:iterations=4")
        self.assertLess(abs(run.x - ours.x).max(), 1e-12)
        self.assertEqual(run.status, "ok")
        for name, value in ours.values.items():
            if value == value:
                self.assertAlmostEqual(run.values[name], value, delta=1e-9 * max(1, abs(value)), msg=name)
        self.assertEqual(run.record["params"], {"iterations": "4"})
        self.assertEqual(run.record["sweeps"], 4)
        self.assertGreater(abs(taut.simulate(scene, "textbook").x - ours.x).max(), 1e-4, "eight by default")
        self.assertIn("textbook", [one["name"] for one in taut.solvers()])
        self.assertEqual(taut.simulate("ball", "textbook").verdict, "unsupported (colliders)")

    def test_each_parameter_is_an_attribute_of_its_type(self):
        seen = {}

        def load(self, scene, x, v):
            Still.load(self, scene, x, v)
            seen.update({name: getattr(self, name) for name in ("sweeps", "omega", "text", "kind")})
        taut.solver("typed", parameters={"sweeps": 3, "omega": 1.5, "text": "a", "kind": ("soft", "hard")})(still(load=load))
        scene = taut.scene(module.SMALL)
        taut.simulate(scene, "typed", duration=0.1)
        self.assertEqual(seen, {"sweeps": 3, "omega": 1.5, "text": "a", "kind": "soft"})
        taut.simulate(scene, "typed:sweeps=-2,omega=1e-3,text='b, c',kind=hard", duration=0.1)
        self.assertEqual(seen, {"sweeps": -2, "omega": 1e-3, "text": "b, c", "kind": "hard"})
        self.assertIs(type(seen["sweeps"]), int)
        for wrong, said in (("sweeps=1.5", "sweeps"), ("kind=harder", "soft"), ("swoops=1", "sweeps")):
            with self.refused("typed", said):
                taut.simulate(scene, f"typed:{wrong}")

    def test_a_name_may_be_given_again(self):
        scene = taut.scene(module.SMALL)
        for shift in (0.0, 1e-3):
            def step(self, t, dt, shift=shift):
                self.x[20] += shift
            taut.solver("again")(still(step=step))
            self.assertEqual(taut.simulate(scene, "again", duration="1/64").x[-1, 20, 0] - scene.x[20, 0] > 1e-4, shift > 0)
        self.assertEqual([one["name"] for one in taut.solvers()].count("again"), 1)

    def test_its_arrays_are_its_own(self):
        scene = taut.scene(module.SMALL)
        taut.solver("writes")(still(load=lambda self, scene, x, v: (Still.load(self, scene, x, v), x.__iadd__(0))[0]))
        start = scene.x
        run = taut.simulate(scene, "writes", duration="1/64")
        run.x[:] = 7
        self.assertTrue(numpy.array_equal(scene.x, start))
        scene.x[:] = 7
        self.assertTrue(numpy.array_equal(scene.x, start))

    def test_what_is_no_solver_is_refused_when_it_is_said(self):
        without = {name: type("Without", (), {m: getattr(Still, m) for m in ("load", "step", "store") if m != name}) for name in ("load", "step", "store")}
        for name, cls in without.items():
            with self.refused("'mine'", "class Without", f"no method '{name}'"):
                taut.solver("mine")(cls)
        with self.refused("no method 'step'"):
            taut.solver("mine")(still(step=3))
        with self.refused("must be a class"):
            taut.solver("mine")(lambda: 1)
        for name, said in (("jakobsen", "already"), ("a:b", "letters"), ("", "letters"), ("a b", "letters")):
            with self.refused(said):
                taut.solver(name)(Still)
        for key, value, said in (("flag", True, "bool"), ("n", None, "NoneType"), ("l", [1], "list"), ("two words", 1, "two words"),
                                 ("step", 1, "step"), ("none", (), "tuple")):
            with self.refused("'mine'", said):
                taut.solver("mine", parameters={key: value})(Still)
        with self.refused("unknown solver 'mine'"):
            taut.simulate(taut.scene(module.SMALL), "mine")

    def test_what_it_raises_is_raised_with_its_place(self):
        scene = taut.scene(module.SMALL)

        def fails(self, *_):
            raise ZeroDivisionError("in the user's code")
        for method, where in (("load", "load()"), ("step", "step() at t = 0 s"), ("store", "store()")):
            taut.solver("failing")(still(**{method: fails}))
            try:
                taut.simulate(scene, "failing")
                self.fail("nothing was raised")
            except ZeroDivisionError:
                text = traceback.format_exc()
            self.assertIn("in the user's code", text)
            self.assertIn(f"in {where} of solver 'failing'", text)
            self.assertIn("solvers_test.py", text)
        taut.solver("failing")(type("Failing", (Still,), {"__init__": fails}))
        with self.assertRaises(ZeroDivisionError):
            taut.simulate(scene, "failing")
        taut.solver("failing")(still(step=lambda self, t, dt: exec("raise KeyboardInterrupt")))
        with self.assertRaises(KeyboardInterrupt):
            taut.simulate(scene, "failing")
        self.assertEqual(taut.simulate(scene).status, "ok")

    def test_what_it_stores_is_checked(self):
        scene = taut.scene(module.SMALL)
        x = scene.x
        for stored, said in ((lambda self: None, ("store()", "NoneType", "pair")), (lambda self: (x,), ("pair",)), (lambda self: (x[:3], x), ("x", "(3, 3)", "(64, 3)")),
                             (lambda self: (x, x[:, :2]), (" v", "(64, 2)")), (lambda self: (x, "v"), (" v",)), (lambda self: (x * 1j, x), ("complex128",)),
                             (lambda self: (x, None), (" v",))):
            taut.solver("storing")(still(store=stored))
            with self.subTest(said), self.refused("solver 'storing'", *said):
                taut.simulate(scene, "storing")
        taut.solver("storing")(still(store=lambda self: (x.astype(numpy.float32).tolist(), numpy.asfortranarray(0 * x))))
        self.assertEqual(taut.simulate(scene, "storing", duration="1/64").x.shape, (2, 64, 3))

        def explode(self, t, dt):
            self.x[9, 2] = numpy.inf
        taut.solver("storing")(still(step=explode))
        run = taut.simulate(scene, "storing")
        self.assertEqual(run.verdict, "exploded (nonfinite) at step 1, vertex 9", "its numbers are a result")

    def test_its_pins_are_those_of_the_scene(self):
        scene = taut.scene(module.SMALL)

        def falls(self, t, dt):
            self.x[scene.pins[1], 1] -= 0.1 * dt
        taut.solver("falls")(still(step=falls))
        run = taut.simulate(scene, "falls")
        self.assertEqual((run.status, run.record["status"]["step"], run.record["status"]["vertex"]), ("protocol", 1, scene.pins[1]))
        self.assertIn("does not hold the scene's pins: vertex 7 is 0.00156 m from", run.record["status"]["reason"])
        moved = taut.scene(module.SMALL + '[[pin_motion]]\nvertices = ["top-left", "top-right"]\nvelocity = [0, 0, 1]\n')
        taut.solver("stays")(Still)
        self.assertEqual(taut.simulate(moved, "stays").status, "protocol")

        def follows(self, t, dt):
            self.x[moved.pins] = moved.pin_positions(t + dt).astype(numpy.float32)
        taut.solver("follows")(still(step=follows))
        self.assertEqual(taut.simulate(moved, "follows", duration=0.1).status, "ok")

    def test_two_threads_run_solvers_of_python_at_once(self):
        scene = taut.scene(module.SMALL, {"time.duration": 0.2})
        want = taut.simulate(scene, "textbook:iterations=2").record["digest"]
        digests = []
        threads = [threading.Thread(target=lambda: digests.append(taut.simulate(scene, "textbook:iterations=2").record["digest"])) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(digests, [want] * 4)


if __name__ == "__main__":
    module.main()
