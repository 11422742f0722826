#!/usr/bin/env python3
"""A real run, small enough for a test, ends in a report; the browser then uses it as report.py does.

    real_run.py BINARIES OUT        exit 0: all checks pass; 1: a check fails; 77: Chromium is missing
"""

import json
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
"time.dt" = ["1/120", "1/60", "1/4"]
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
    taut("bench", "./small.toml", "--rounds", "2", "--seconds", "0.0005", "--out", "results", "--quiet")
    taut("verify", "--section", "1", "--quiet", "--record", "--out", "results")
    page = folder / taut("report", "./small.toml", "--out", "results", "--film", "disc", "--film", "twist")[-1]
    text = page.read_text()
    model = json.loads(text.split('<script type="application/json" id="model">', 1)[1].split("</script>", 1)[0])
    scenes = {scene["id"]: scene for scene in model["scenes"]}
    for what, holds in {
        "some cases failed, and costs were measured": any(c["status"] == "extreme" for c in model["cases"]) and "cost" in model,
        "each scene has its film": all(scenes[name].get("film") for name in ("hang", "ball", "disc", "twist")),
        "what no study ran is shown apart": not scenes["disc"]["studied"] and scenes["hang"]["studied"],
        "who refuses a scene says why": any("self-collision" in r["reason"] for r in scenes["twist"].get("refusals", [])),
        "both engines are in it": {s["id"] for s in model["solvers"]} == {"jakobsen", "bullet"},
        "that substeps differ is said": any("substeps" in s.get("unequal", "") for s in model["method"]["studies"]),
        "the truths are filled": model.get("truths", {}).get("findings", 0) > 0,
        "what was not made names its command": any("taut check" in m.get("command", "") for m in model.get("missing", [])),
    }.items():
        print(("ok      " if holds else "FAILED  ") + what)
        if not holds:
            return 1
    return report.use(str(page), str(folder), report.ALL)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2]))
