#!/usr/bin/env python3
"""`taut require` on made-up scenes: what it has to drop and to keep, that the smallest model keeps the answers, patience,
and interruption."""

import json
import math
import signal
import time

from command_line import CommandLine, facts_of, main, rows_of


def sheet(cloth="", rest="", grid=(9, 9), duration=2):
    return (f'summary = "A small sheet"\n[cloth]\ngrid = {list(grid)}\nsize = [1, 1]\nmass = 0.1\n{cloth}\n{rest}\n'
            f'[time]\ndt = "1/64"\nduration = {duration}\n')


HUNG = 'pins = ["top-left", "top-right"]'
CALM = sheet('pins = ["top"]', """[links]
bend = true
[wind]
velocity = [3, 0, 1]
strength = 0
[self_collision]
radius = 0.01
""")
FAST = sheet("origin = [-0.5, 1, -0.5]\nv = [0, 0, 1]\nvelocity = [0, -20, 0]", """[[collider]]
type = "box"
center = [0, 0, 0]
half_extents = [0.8, 0.005, 0.8]
friction = 0.5
""", duration=1)
HEAVY = sheet('pins = ["top"]\nweights = [{ vertices = ["bottom"], factor = 300 }]')
FALLING = sheet("origin = [-0.4, 1.3, 0]\nu = [1, 0, 0.1]\nv = [0, -1, 0.15]\nthickness = 0.01", """[links]
bend = true
[[collider]]
type = "plane"
friction = 0.5
[self_collision]
radius = 0.012
""", grid=(17, 17))


def slope(friction):
    return sheet("origin = [0.0025, 0.004330127018922193, 0]\nu = [0.8660254037844386, -0.5, 0]\nv = [0, 0, 1]\n"
                 "thickness = 0.005", f"""[[collider]]
type = "plane"
normal = [0.5, 0.8660254037844386, 0]
friction = {friction}
""")


class Require(CommandLine):
    def require(self, scene, *words, solver="jakobsen", expect=0):
        (self.folder / "made.toml").write_text(scene)
        return self.answer("require", "./made.toml", solver, *words, expect=expect)

    def verdicts(self, found):
        return {effect["name"]: effect["verdict"].split(":")[0] for effect in rows_of(found, "effects")}

    def test_what_does_nothing_goes(self):
        found = self.require(CALM)
        verdicts = self.verdicts(found)
        for name in ("wind", "bend links", "self-collision"):
            self.assertEqual(verdicts[name], "drop", found)
        self.assertEqual(facts_of(found)["chaotic"], "no")
        text = (self.folder / facts_of(found)["file"]).read_text()
        self.assertNotIn("[wind]", text)
        self.assertNotIn("[self_collision]", text)

    def test_the_smallest_model_runs_and_keeps_the_answers(self):
        found = self.require(CALM)
        self.assertIs(facts_of(found)["verified"], True)
        case = json.loads(self.taut(*facts_of(found)["smallest"].split()[1:], "--json").out)
        for answer in rows_of(found, "answers")[1:]:
            least = max(answer["tolerance"], answer["noise"])
            if answer["name"] not in case["values"]:  # a model without self-collision has no crossings
                continue
            self.assertLessEqual(abs(case["values"][answer["name"]] - answer["value"]), least, answer)
        full = json.loads(self.taut("case", "./made.toml", "jakobsen", "--json").out)
        self.assertLess(case["links"] * case["steps"], 0.7 * full["links"] * full["steps"])

    def test_a_tolerance_above_the_value_is_said(self):
        for tolerance, says in (("90%", self.assertIn), ("0.0001%", self.assertNotIn)):
            found = self.require(CALM, "--keep", "stretch.max:" + tolerance)
            says("LARGER THAN THE VALUE: SAYS NOTHING", json.dumps(found["tables"]["answers"]["notes"]))

    def test_friction_is_kept_on_a_slope_about_to_slide(self):
        for share in (0.98, 1.02):
            found = self.require(slope(share * math.tan(math.radians(30))))
            self.assertEqual(self.verdicts(found)["friction"], "keep", found)

    def test_a_fast_sheet_needs_swept_tests(self):
        self.assertEqual(self.verdicts(self.require(FAST))["continuous detection"], "keep")

    def test_a_heavy_weight_needs_substeps(self):
        found = self.require(HEAVY, solver="jakobsen:substeps=16,iterations=1")
        self.assertEqual(self.verdicts(found)["substeps"], "keep", found)

    def test_a_falling_sheet_is_chaotic_and_keeps_statistics_only(self):
        found = self.require(FALLING, "--keep", "shape", "--keep", "stretch.rms")
        self.assertRegex(facts_of(found)["chaotic"], "after .* s")
        self.assertTrue(0 < facts_of(found)["horizon"] <= 2)
        self.assertEqual([answer["name"] for answer in rows_of(found, "answers")], ["stretch.rms"])
        self.assertEqual(len(rows_of(found, "not_kept")), 1)

    def test_patience_is_kept_and_the_same_command_goes_on(self):
        (self.folder / "made.toml").write_text(sheet(HUNG, grid=(33, 33), duration=10))
        for patience in (1, 3):
            process = self.start("require", "./made.toml", "--patience", patience, "--json")
            found = facts_of(json.loads(process.communicate(timeout=60)[0]))
            self.assertLess(found["seconds"], 1.1 * patience + 1)
            self.assertEqual(process.returncode, 0 if found["complete"] else 3)
        stored = len(self.keys())
        found = facts_of(self.answer("require", "./made.toml"))
        self.assertTrue(found["complete"])
        self.assertGreaterEqual(found["cases"] - found["ran"], stored)

    def test_interrupted_it_goes_on(self):
        (self.folder / "made.toml").write_text(sheet(HUNG, grid=(33, 33), duration=10))
        process = self.start("require", "./made.toml", "jakobsen")
        for _ in range(600):
            time.sleep(0.05)
            if self.keys():  # most of its cases are still to be run
                break
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)
        stored = len(self.keys())
        found = facts_of(self.answer("require", "./made.toml", "jakobsen"))
        self.assertGreaterEqual(found["cases"] - found["ran"], min(stored, 3))

    def test_bad_input_runs_nothing(self):
        (self.folder / "made.toml").write_text(CALM)
        refused = self.taut("require", "./made.toml", "--keep", "strech.max", expect=2)
        self.assertIn("did you mean 'stretch.max'", refused.err)
        self.assertEqual(self.keys(), [], "nothing ran")
        for words in (["./made.toml", "--keep", "shape:-1"], ["./none.toml"], ["./made.toml", "nobody"],
                      ["./made.toml", "--patience", "0"]):
            self.taut("require", *words, expect=2)


if __name__ == "__main__":
    main()
