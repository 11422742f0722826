#!/usr/bin/env python3
"""`taut verify` as a whole: no truth is broken, each makes the promises in promises.tsv, and each compares something.

A promise is a value that a truth expects of a subject, with its tolerance; measured values are not part of it. Loosening a tolerance
or leaving out a solver changes a line there: promises_test.py BUILD --write. A new truth has no promises yet.
"""
import json
import math
import os
import pathlib
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROMISES = pathlib.Path(__file__).with_name("promises.tsv")
BUILD = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "build/default").resolve()

# Errors that are exactly 0 by construction, and not because nothing was compared.
ZERO = ("strain of 1 % after ten passes", "speed two steps after the impact", "height at rest", "depth at rest in a box",
        "largest acceleration at rest, without gravity's", "their overlap", "face.excess of the same face",
        "distance from the side, for it is put out there, not where it came in", "the same where its way is tested",
        "way of a vertex along the floor in 10 s, mu = 0.0", "way of a vertex along the floor in 10 s, mu = 0.5",
        "way of a vertex along the floor in 10 s, mu = 1.0", "way of two pinned vertices in 1 s", "way of a sheet at rest that nothing moves, in 1 s",
        "distance of the pin from its motion at the release", "distance of two moving pins from their places, within 1 s",
        "distance on a million segments from the box's", "depth of the chord, faces=edges",
        "distance of the velocity from v0", "distance of three moving pins from their places, within 1 s",
        "way in 1 s of a chain of springs that starts at rest, over its sag", "height over its place at rest, from 0.05 s after the impact on",
        "way at mu = 1.05 tan(30 degrees)", "way at mu = 1.05 tan(30 degrees), above a smooth plane", "share that passes a box of 0.4 ways",
        "distance of a run that goes on from its state after 0.25 s", "the same of runs with a moving pin, after 0.25 s",
        "height in a grip at rest after 0.25 s, mu = 0.5", "height in a grip that rises at 0.1 m/s after 0.25 s, mu = 0.5",
        "creep on a slope of 20 degrees, mu = 0.6", "creep on a slope of 30 degrees, mu = 1.05 tan(30 degrees)")


def verify():
    environment = {**os.environ, "TAUT_DATA": str(ROOT / "experiments")}
    done = subprocess.run([BUILD / "taut", "verify", "--json"], cwd=ROOT, env=environment, text=True, capture_output=True)
    table = json.loads(done.stdout)["tables"]["findings"]
    findings = [dict(zip((column["name"] for column in table["columns"]), row)) for row in table["rows"]]
    return done, [(f["truth"], f) for f in findings]


def promise(truth, finding):
    """The line of a finding: its texts, and its numbers."""
    words = truth, finding["subject"], finding["quantity"], finding["unit"], finding["verdict"]
    return words, [math.nan if number is None else number for number in (finding["expected"], finding["tolerance"])]


class Promises(unittest.TestCase):
    def test_every_truth_holds_what_is_promised_and_compares_something(self):
        done, findings = verify()
        self.assertEqual(done.returncode, 0, done.stderr + done.stdout[-2000:])
        kept = [line.split("\t") for line in PROMISES.read_text().splitlines()]
        made = [made for made in (promise(*one) for one in findings) if made[0][0] in {line[0] for line in kept}]
        self.assertEqual(["\t".join(words) for words, _ in made], ["\t".join(line[:5]) for line in kept])
        for (words, numbers), line in zip(made, kept):
            for number, text in zip(numbers, line[5:]):
                same = math.isnan(number) if text == "nan" else math.isclose(number, float(text), rel_tol=1e-6, abs_tol=1e-300)
                self.assertTrue(same, f"{words}: {number} was promised as {text}")
        for truth, f in findings:
            if f["expected"] == 0 and f["tolerance"] > 0 and f["quantity"] not in ZERO:
                self.assertNotEqual(f["measured"], 0, f"{truth}, {f['subject']}, {f['quantity']}: was anything compared?")


if __name__ == "__main__":
    if "--write" in sys.argv:
        lines = ["\t".join([*words, *map(repr, numbers)]) for words, numbers in (promise(*one) for one in verify()[1])]
        PROMISES.write_text("\n".join(lines) + "\n")
    else:
        unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
