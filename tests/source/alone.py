#!/usr/bin/env python3
"""Compiles each source file by itself, without precompiled headers and without the other files of its batch, to check
that it includes what it uses. Usage: alone.py BUILD [-j JOBS] [FOLDER ...]; `alone.py BUILD --self-test` plants a file
that lacks an include.
"""
import argparse
import concurrent.futures
import json
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ["core", "bullet_ref", "experiments"]


def sources_of(unit: pathlib.Path):
    """The source files of a batch; any other file is its own source."""
    if "Unity" not in unit.parts:
        return [unit]
    return [pathlib.Path(name) for name in re.findall(r'^#include "(.*\.cpp)"$', unit.read_text(), re.M)]


def alone(words):
    """The command that checks a file with the flags of its target, except for the precompiled header and the output."""
    kept = []
    for before, word in zip([""] + words, words):
        takes_one = before in ("-o", "-c", "-include", "-Xclang")
        if not takes_one and word not in ("-o", "-c", "-include", "-Xclang", "-Winvalid-pch", "-fpch-preprocess"):
            kept.append(word)
    return [*kept, "-fsyntax-only", "-w"]


def commands(build: pathlib.Path, folders):
    """Source file -> command. A file that belongs to several targets has the command of the first."""
    found = {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        for source in sources_of(pathlib.Path(entry["directory"], entry["file"])):
            inside = source.is_relative_to(HERE) and source.relative_to(HERE).parts[0] in folders
            if inside and source not in found:
                found[source] = (alone(shlex.split(entry["command"])), entry["directory"])
    return found


def first_error(source, command, directory):
    done = subprocess.run([*command, str(source)], cwd=directory, capture_output=True, text=True)
    if done.returncode == 0:
        return None
    lines = [line for line in done.stderr.splitlines() if "error" in line]
    return (lines or done.stderr.splitlines() or ["no message"])[0]


def failures(all_commands, jobs):
    """The first error of each file that has errors. Prints each as it is found."""
    found = []
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for line in pool.map(lambda one: first_error(one[0], *one[1]), all_commands.items()):
            if line:
                print(line, flush=True)
                found.append(line)
    return found


def self_test(build, jobs):
    """Checks that a file is found if and only if it lacks an include."""
    command, directory = next(iter(commands(build, FOLDERS).values()))
    with tempfile.TemporaryDirectory() as folder:
        planted = pathlib.Path(folder, "planted.cpp")
        text = "std::size_t planted(const std::vector<int>& all) { return all.size(); }\n"
        planted.write_text(text)
        lacks = failures({planted: (command, directory)}, jobs)
        planted.write_text("#include <vector>\n" + text)
        has = failures({planted: (command, directory)}, jobs)
    return [] if len(lacks) == 1 and not has else [f"self-test: {lacks} without the include, {has} with it"]


def main():
    options = argparse.ArgumentParser()
    options.add_argument("build", type=pathlib.Path)
    options.add_argument("folders", nargs="*", default=FOLDERS)
    options.add_argument("-j", dest="jobs", type=int, default=2)
    options.add_argument("--self-test", action="store_true")
    o = options.parse_args()
    build = o.build.resolve()
    if o.self_test:
        wrong = self_test(build, o.jobs)
        print("\n".join(wrong))
        sys.exit(1 if wrong else 0)
    checked = commands(build, o.folders)
    found = failures(checked, o.jobs)
    print(f"{len(checked)} files, {len(found)} of which do not compile by themselves")
    sys.exit(1 if found or not checked else 0)


if __name__ == "__main__":
    main()
