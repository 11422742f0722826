#!/usr/bin/env python3
"""A real run, small enough for a test, ends in a report; the browser then uses it as report.py does.

    real_run.py BINARIES OUT        exit 0: all is well; 1: it is not; 77: there is no Chromium
"""

import os
import pathlib
import subprocess
import sys

import chromium
import report

STUDY = """question = "Does a small run give a whole report?"
scenes = ["hang", "ball"]
solvers = ["jakobsen", "bullet"]
set = ["cloth.grid=[9, 9]", "time.duration=1"]

[axes]
iterations = [1, 4, 16]
"time.dt" = ["1/120", "1/60", "1/30"]
"""


def main(binaries, out):
    if chromium.find() is None:
        print("SKIPPED: no chromium on this machine")
        return 77
    folder = pathlib.Path(out).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "small.toml").write_text(STUDY)

    def taut(*words):
        done = subprocess.run([os.path.join(os.path.abspath(binaries), "taut"), *words], cwd=folder, text=True,
                              stdout=subprocess.PIPE)
        if done.returncode != 0:
            raise SystemExit(f"taut {' '.join(words)}: exit {done.returncode}")
        return done.stdout.splitlines()

    taut("run", "./small.toml", "--out", "results")
    taut("verify", "--section", "1", "--quiet", "--out", "results/verify.json")
    page = folder / taut("report", "./small.toml", "--results", "results", "--film", "disc", "--film", "twist")[-1]
    text = page.read_text()
    for what, holds in {
        "each scene has its film": text.count("<video") == 4,
        "what no study ran is shown apart": 'id="film-disc"' in text and 'id="film-twist"' in text,
        "who refuses a scene says why": "cannot run this scene</p><p>self-collision" in text,
        "both engines are in it": "Jakobsen" in text and "Bullet" in text,
        "captions name sweeps and substeps": "iterations · 5 substeps" in text and "iterations · 1 substep<" in text,
        "that substeps differ is said": "their substeps differ" in text and "not equal work" in text,
        "the truths are filled": "No truth is broken" in text,
        "what was not made names its command": "taut check --record" in text,
    }.items():
        print(("ok      " if holds else "FAILED  ") + what)
        if not holds:
            return 1
    return report.main(str(page), str(folder))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2]))
