#!/usr/bin/env python3
"""Measures the cost of a clean build and of a build after an edit of one line in each of ten files, by the number of files that are
compiled as one (TAUT_BATCH_SIZE). It works in a copy of the sources, without a compiler cache, and builds `taut` and `taut-f32`, which
`./taut VERB` needs.

Usage: edits.py [BATCH_SIZE ...]     default: 0 (a whole layer as one) and the value in CMakeLists.txt
Prints a table. CPU time is the sum over all processes and hardly depends on what else the machine does; wall time does."""

import os
import pathlib
import re
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
EDITED = ["core/model/scene.cpp", "core/io/scene_io.cpp", "core/solver/xpbd.cpp", "core/solver/contact/projector.cpp",
          "core/reference/implicit_step.cpp", "bullet_ref/bullet_solver.cpp", "experiments/metrics/stretch.cpp",
          "experiments/timing/timing.cpp", "experiments/report/questions/winners.cpp", "experiments/cli/cost/bench.cpp"]


def copy_of_sources(folder):
    names = subprocess.run(["git", "-C", ROOT, "ls-files", "-z"], check=True, capture_output=True, text=True).stdout
    for name in filter(None, names.split("\0")):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, folder / name)


def timed(command):
    """CPU and wall time of a command [s]."""
    def cpu():
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        return used.ru_utime + used.ru_stime
    before, start = cpu(), time.monotonic()
    done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "CCACHE_DISABLE": "1"})
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
    return cpu() - before, time.monotonic() - start


def measure(tree, batch):
    """Times of a clean build, and of a build after an edit of each file."""
    build = tree / "build" / str(batch)
    timed(["cmake", "-S", tree, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=RelWithDebInfo", "-DTAUT_TESTS=OFF", "-DTAUT_PYTHON=OFF",
           f"-DTAUT_BATCH_SIZE={batch}"])
    command = ["cmake", "--build", build, "--parallel", str(len(os.sched_getaffinity(0))), "--target", "taut", "taut-f32"]
    clean = timed(command)
    print(f"batch {batch}: clean {clean[0]:.0f} s", file=sys.stderr)
    edits = {}
    for name in EDITED:
        file = tree / name
        file.write_text(file.read_text() + "static_assert(sizeof(int) > 0);\n")
        edits[name] = timed(command)
        print(f"batch {batch}: {name} {edits[name][0]:.1f} s", file=sys.stderr)
    return clean, edits


def main():
    usual = re.search(r"set\(TAUT_BATCH_SIZE (\d+)", (ROOT / "CMakeLists.txt").read_text())[1]
    batches = [int(word) for word in sys.argv[1:] or ("0", usual)]
    with tempfile.TemporaryDirectory() as folder:
        copy_of_sources(pathlib.Path(folder))
        found = {batch: measure(pathlib.Path(folder), batch) for batch in batches}

    def row(name, value):
        print("|", name, "|", " | ".join("{:.1f} | {:.1f}".format(*value(*found[batch])) for batch in batches), "|")

    print("| CPU and wall time [s] |", " | ".join(f"{batch or 'a layer'} as one, CPU | wall" for batch in batches), "|")
    print("|---|" + "---|---|" * len(batches))
    row("clean build", lambda clean, edits: clean)
    for name in EDITED:
        row(name, lambda clean, edits: edits[name])
    row("median of the edits", lambda clean, edits: [statistics.median(times) for times in zip(*edits.values())])


if __name__ == "__main__":
    main()
