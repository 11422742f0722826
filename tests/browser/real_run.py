#!/usr/bin/env python3
"""A real run, small enough for a test, ends in a report whose model says what was run.

    real_run.py BINARIES OUT        exit 0: all is well; 1: it is not
"""

import json
import os
import pathlib
import subprocess
import sys

STUDY = """question = "Does a small run give a whole report?"
scenes = ["hang", "ball"]
solvers = ["jakobsen", "bullet"]
set = ["cloth.grid=[9, 9]", "time.duration=1"]

[axes]
iterations = [1, 4, 16]
"time.dt" = ["1/120", "1/60", "1/30"]
"""


def main(binaries, out):
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
    model = json.loads(page.read_text().split('id="model">')[1].split("</script>")[0])
    scenes = {scene["id"]: scene for scene in model["scenes"]}
    films = {film["id"]: film for film in model["films"]}
    cases = {case["key"]: case for case in model["cases"]}
    claims = {claim["id"]: claim for claim in model["claims"]}
    missing = {one["section"]: one["command"] for one in model["missing"]}
    own = [cases[panel["case"]] for panel in films["film-ball"]["panels"]]
    again = subprocess.run(["sh", "-c", own[0]["command"].replace("taut", os.path.abspath(binaries) + "/taut", 1) +
                            " --json"], cwd="/", capture_output=True, text=True)
    for what, holds in {
        "each scene has its film": all(scene.get("films") for scene in scenes.values()) and len(films) == 4,
        "what no study ran is shown apart": [scenes[s]["studied"] for s in ("ball", "disc", "twist")] == [1, 0, 0],
        "who refuses a scene says why": any("self" in r["reason"] for r in scenes["twist"]["refusals"]),
        "panels name substeps and sweeps": [p["settings"][:6] for p in films["film-ball"]["panels"]] == ["5 × 16", "1 × 16"],
        "work that is not equal is said": "unequal work" in claims["stretch"]["sentence"],
        "a film shows what the sentence is about": claims["stretch-ball"]["film"] == "film-ball",
        "both engines are in every comparison": all(name in claims["depth"]["sentence"] for name in ("Jakobsen", "Bullet")),
        "the truths are there": model["truths"]["verdicts"].get("broken", 0) == 0 < model["truths"]["truths"],
        "what was not made names its command": missing.get("regressions") == "taut check --record",
        "a case's command makes it again, in any folder": json.loads(again.stdout)["values"].items() >= own[0]["values"].items(),
        "the page heads with its question": model["meta"]["question"].startswith("Does a small run"),
    }.items():
        print(("ok      " if holds else "FAILED  ") + what)
        if not holds:
            return 1
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2]))
