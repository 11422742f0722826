#!/usr/bin/env python3
"""Prints a regular expression, for `ctest -R`, of the tests that a change since COMMIT may turn red: the checks of the sources, the tests of
each layer in which a file changed, and every unit test that includes a changed file, directly or through others.

Usage: changed.py [COMMIT]    (default: where this branch left main, or HEAD)

A file with its own header counts as one with it. What reaches a solver without including it, by its name, is not seen; `./taut test` is."""

import collections
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
CODE = ("core", "bullet_ref", "experiments", "tests")
CHECKS = ("documents", "format", "layers", "fingerprints")  # a few seconds each
# Whose tests start the program.
OF_PROGRAM = {"command_line": "cli"}


def git(*words):
    try:
        done = subprocess.run(["git", "-C", ROOT, *words], text=True, capture_output=True)
    except FileNotFoundError:
        sys.exit("changed.py: git is missing")
    return done.stdout.split("\n")[:-1] if done.returncode == 0 else None


def base():
    for main in ("origin/main", "origin/master", "main"):
        if found := git("merge-base", "HEAD", main):
            return found[0]
    return "HEAD"


def module(path):
    return path.rsplit(".", 1)[0]


def dependents():
    """For each module those that include it. A module is a header with the source of its name."""
    direct = collections.defaultdict(set)
    for folder in CODE:
        for path in (ROOT / folder).rglob("*.[ch]pp"):
            own = str(path.relative_to(ROOT))
            for included in re.findall(r'^#include "([^"]+)"', path.read_text(), re.MULTILINE):
                direct[module(included)].add(module(own))
    return direct


def closure(modules):
    direct, found, ahead = dependents(), set(modules), list(modules)
    while ahead:
        new = direct[ahead.pop()] - found
        found |= new
        ahead += new
    return found


def layer(path):
    """The folder of tests that belongs to a file: core/solver/pd.cpp has tests/solver."""
    parts = path.split("/")
    folder = parts[0] if parts[0] == "bullet_ref" else parts[1] if len(parts) > 2 else ""
    return OF_PROGRAM.get(folder, folder)


def suites(path):
    return set(re.findall(r"^(?:TYPED_)?TEST(?:_[FP])?\((\w+),", path.read_text(), re.MULTILINE))


def tests_of(changed):
    names, layers = {f"^{check}$" for check in CHECKS}, {layer(path) for path in changed}
    reached = closure({module(path) for path in changed})
    for path in (ROOT / "tests").rglob("*_test.*"):
        own = str(path.relative_to(ROOT))
        if path.suffix == ".cpp" and (layer(own) in layers or module(own) in reached):
            names |= {rf"{before}{suite}[./]" for suite in suites(path) for before in ("^", "[./]")}
        if path.suffix == ".py" and layer(own) in layers:
            names |= {rf"^{part}{path.stem.removesuffix('_test')}{end}$" for part in ("", r"python\.") for end in ("", "_test")}
    return names


def main(commit):
    files = git("diff", "--name-only", "--no-renames", commit, "--")
    if files is None:
        sys.exit(f"changed.py: no commit '{commit}'")
    files += git("ls-files", "--others", "--exclude-standard")
    changed = [path for path in files if path.startswith(tuple(f"{folder}/" for folder in CODE))]
    print(f"{len(files)} files differ from {commit[:10]}", file=sys.stderr)
    print("|".join(sorted(tests_of(changed))))  # ctest takes few parentheses


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else base())
