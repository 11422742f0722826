#!/usr/bin/env python3
"""taut.score judges an array as `taut external score` judges a file with it.

Usage: scores_test.py BUILD [TEST...]"""

import json
import math

import module
import numpy
import taut


class Scores(module.Case):
    def scored(self, *words):
        answer = json.loads(self.taut("external", "score", *words, "--json"))
        return {name: fact["value"] for name, fact in answer["facts"].items()}, answer

    def motion(self, scene, solver="jakobsen:iterations=4", **more):
        return taut.simulate(taut.scene(*scene) if isinstance(scene, tuple) else scene, solver, **more).x

    def test_values_are_those_of_the_command_line(self):
        grid = {"cloth.grid": [12, 12]}
        x = self.motion(("hang", grid), duration=1)
        y = self.motion(("ball", grid), duration=1)
        turned = numpy.stack([x[:, :, 0], -x[:, :, 2], x[:, :, 1]], axis=2) * 100  # cm, z up
        files = {"plain": ("hang", x, {}, ()), "single": ("hang", x.astype(numpy.float32), {}, ()),
                 "fps": ("hang", x[::2], {"fps": 32}, ("--fps", 32)), "contact": ("ball", y, {}, ()),
                 "turned": ("hang", turned, {"scale": 0.01, "up": "z"}, ("--scale", 0.01, "--z-up")),
                 "other_order": ("hang", x[:, ::-1], {}, ())}
        for name, (scene, array, said, words) in files.items():
            with self.subTest(name):
                numpy.save(self.folder / f"{name}.npy", array)
                facts, answer = self.scored(scene, f"{name}.npy", *words, "--set", "cloth.grid=[12, 12]")
                run = taut.score(taut.scene(scene, grid), array, **said)
                self.assertEqual(run.status, facts["status"])
                compared = 0
                for value, number in run.values.items():
                    if math.isnan(number):
                        self.assertNotIn(value, [key for key, fact in facts.items() if fact is not None])
                    else:
                        self.assertEqual(number, facts[value], value)
                        compared += 1
                self.assertGreater(compared, 15)
                self.assertEqual(run.record["digest"], facts["digest"])
                self.assertEqual([[s["name"], s["text"]] for s in run.record["resolved_settings"]], answer["tables"]["read"]["rows"])
                of_file = taut.score(taut.scene(scene, grid), self.folder / f"{name}.npy", **said)
                self.assertEqual(of_file.record["values"], run.record["values"])

    def test_any_memory_order_and_stride_is_the_same_array(self):
        scene = taut.scene(module.SMALL)
        x = self.motion(scene)
        want = taut.score(scene, x).record
        for array in (numpy.asfortranarray(x), numpy.ascontiguousarray(x[:, :, ::-1])[:, :, ::-1], numpy.repeat(x, 2, axis=0)[::2], x.tolist(), x.astype(">f8")):
            self.assertEqual(taut.score(scene, array).record["digest"], want["digest"])
        before = x.copy()
        x.flags.writeable = False
        taut.score(scene, x)
        self.assertEqual(x.tobytes(), before.tobytes())

    def test_a_score_of_a_run_is_its_own(self):
        scene = taut.scene(module.SMALL)
        run = taut.simulate(scene, "jakobsen:precision=double")
        scored = taut.score(scene, run.x)
        self.assertEqual(scored.x.tobytes(), run.x.tobytes())
        self.assertEqual(scored.t.tolist(), run.t.tolist())
        for value in ("stretch.rms", "stretch.max"):
            self.assertEqual(scored.values[value], run.values[value])
        self.assertTrue(math.isnan(scored.cpu_seconds))

    def test_a_shape_at_rest_says_the_order(self):
        scene = taut.scene("swing", {"cloth.grid": [8, 8]})
        x = self.motion(scene, duration=0.5)
        order = numpy.random.default_rng(1).permutation(64)
        late = x[4:, order]
        with self.refused("positions", "does not begin as swing does"):
            taut.score(scene, late)
        one_later = x[1:, order]  # its first step covers two steps of the motion
        run = taut.score(scene, one_later, rest=scene.rest[order])
        self.assertTrue(numpy.array_equal(run.x, x[1:]), "it begins where the positions do")
        self.assertTrue(numpy.array_equal(taut.score(scene, x[:, order]).x[1:], x[1:]), "the start says it, too")

    def test_what_is_no_motion_of_the_scene_is_refused_by_name(self):
        scene = taut.scene(module.SMALL)
        x = self.motion(scene)
        bad = x.copy()
        bad[7, 3, 1] = math.nan
        for array, said in ((x[:, :-1], ("positions", "(33, 63, 3)", "(frames, 64, 3)")), (x[0], ("positions", "(64, 3)")),
                            (x.reshape(33, -1), ("positions", "(33, 192)")), (x[:, :, :2], ("positions", "(33, 64, 2)")),
                            (x[:1], ("positions", "1 frames")), (x[:0], ("positions", "0 frames")), (x.astype(int), ("positions", "int64", "float64")),
                            (x.astype(complex), ("positions", "complex128")), (x.astype(str), ("positions", "<U")), (x.astype(object), ("positions", "object")),
                            (None, ("positions", "NoneType")), ({"x": 1}, ("positions", "dict")), ([[1, 2], [3]], ("positions", "list")),
                            (bad, ("positions", "frame 7, vertex 3", "not finite", "allow_nan")), (x + 1, ("positions", "does not begin", "vertex 0"))):
            with self.subTest(said), self.refused(*said):
                taut.score(scene, array)
        hidden = numpy.ma.masked_invalid(bad)
        for array in (hidden, list(hidden), numpy.ma.array(x)):
            with self.refused("positions: a masked array"):
                taut.score(scene, array)
        with self.refused("rest: a masked array"):
            taut.score(scene, x, rest=hidden[7])
        torn = x.copy()
        torn[20:, scene.pins[0]] += 0.1
        with self.refused("pins", "vertex 0"):
            taut.score(scene, torn)
        for said, parts in (({"fps": 0}, ("fps", "0")), ({"fps": math.nan}, ("fps", "nan")), ({"scale": -1}, ("scale", "-1")), ({"up": "x"}, ("up", "'x'")),
                            ({"fps": "1/24"}, ("fps: '1/24' is a str",)), ({"scale": None}, ("scale: None is a NoneType",)),
                            ({"rest": x[0, :-1]}, ("rest", "(63, 3)", "(64, 3)")), ({"every": -1}, ("every", "-1"))):
            with self.subTest(said), self.refused(*parts):
                taut.score(scene, x, **said)
        with self.refused("nowhere.npy"):
            taut.score(scene, "nowhere.npy")
        failed = taut.score(scene, bad, allow_nan=True)
        self.assertEqual((failed.status, failed.record["status"]["step"], failed.record["status"]["vertex"]), ("exploded", 7, 3))
        self.assertEqual(len(failed.t), 7)


if __name__ == "__main__":
    module.main()
