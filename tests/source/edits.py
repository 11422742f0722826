#!/usr/bin/env python3
"""Measures what builds cost: of the programs in a clean copy of the sources, of the unit tests, and after an edit of one line in each of
ten files, in a test and in a header that everything includes. There is no compiler cache.

Usage: edits.py [BATCH_SIZE]     how many files are compiled as one (TAUT_BATCH_SIZE); default: the value in cmake/batches.cmake
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
TEST, HEADER = "tests/solver/contact/contact_test.cpp", "core/model/scene.hpp"


def copy_of_sources(folder):
    """A repository with one commit, since a file that differs from it leaves its batch."""
    names = subprocess.run(["git", "-C", ROOT, "ls-files", "-z"], check=True, capture_output=True, text=True).stdout
    for name in filter(None, names.split("\0")):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, folder / name)
    for words in (["init", "-q"], ["add", "."], ["-c", "user.name=x", "-c", "user.email=x", "commit", "-qm", "as it is"]):
        subprocess.run(["git", "-C", folder, *words], check=True)


def timed(*commands):
    """CPU and wall time of commands [s]."""
    def cpu():
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        return used.ru_utime + used.ru_stime
    before, start = cpu(), time.monotonic()
    for command in commands:
        done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "CCACHE_DISABLE": "1"})
        if done.returncode:
            sys.exit(f"{' '.join(map(str, command))}\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
    return cpu() - before, time.monotonic() - start


def edit(file):
    file.write_text(file.read_text() + "static_assert(sizeof(int) > 0);\n")


def measure(tree, batch):
    """Yields names and times."""
    build = tree / "build"
    configure = ["cmake", "-S", tree, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DTAUT_PYTHON=OFF",
                 f"-DTAUT_BATCH_SIZE={batch}"]

    def make(*targets):
        return ["cmake", "--build", build, "--parallel", str(len(os.sched_getaffinity(0))), "--target", *targets]
    yield "clean build of what `./taut run` needs", timed(configure, make("taut", "taut-f32"))
    firsts, nexts = [], []
    for name in EDITED:
        edit(tree / name)
        firsts.append(timed(configure, make("taut")))  # ./taut configures when other files differ from the commit
        edit(tree / name)
        nexts.append(timed(make("taut")))
        yield f"`{name}`: the first edit", firsts[-1]
        yield f"`{name}`: the next", nexts[-1]
    for kind, of in (("the first edit", firsts), ("the next", nexts)):
        yield f"median: {kind}", [statistics.median(times) for times in zip(*of)]
    yield "the unit tests, after the program", timed(make("taut_tests"))
    for kind in ("the first edit", "the next"):
        edit(tree / TEST)
        yield f"`{TEST}`: {kind}", timed(configure, make("taut_tests"))
    edit(tree / HEADER)
    yield f"`{HEADER}`, which everything includes: `taut`", timed(make("taut"))


def main():
    usual = re.search(r"set\(TAUT_BATCH_SIZE (\d+)", (ROOT / "cmake/batches.cmake").read_text())[1]
    print("| | CPU time [s] | wall time [s] |\n|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        copy_of_sources(pathlib.Path(folder))
        for name, (cpu, wall) in measure(pathlib.Path(folder), sys.argv[1] if len(sys.argv) > 1 else usual):
            print(f"| {name} | {cpu:.1f} | {wall:.1f} |", flush=True)


if __name__ == "__main__":
    main()
