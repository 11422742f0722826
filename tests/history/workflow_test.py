#!/usr/bin/env python3
"""The workflow in experiments/external/README.md, which other repositories copy. Its steps that use taut run in a repository of a
solver in Python, for each commit with the results of the commit before.

Usage: workflow_test.py FOLDER_OF_TAUT [README] [SDK]"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

HERE = pathlib.Path(__file__).resolve().parent
OUTSIDE = HERE.parents[1] / "experiments" / "external" if len(HERE.parents) > 1 else HERE
PROGRAM = pathlib.Path(sys.argv[1]).resolve()
README = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else OUTSIDE / "README.md")
SDK = pathlib.Path(sys.argv[3] if len(sys.argv) > 3 else OUTSIDE / "sdk")
SCENE = """summary = "A small sheet"
cloth = { grid = [4, 4], size = [1, 1], mass = 0.1, pins = ["top-left"] }
time = { dt = "1/64", duration = 0.5 }
"""
STUDY = """question = "Does my cloth still hang as it did?"
scenes = ["./sheet.toml"]
solvers = ["mine:cmd='python3 mine.py'"]
axes.iterations = [2, 4]
"""

workflow, = re.findall(r"```yaml\n(on: .*?)```", README.read_text(), re.DOTALL)
assert len(workflow.splitlines()) <= 22, "twenty lines or so"
steps = [step for step in re.findall(r"- run: (.*)", workflow) if re.search(r"\btaut (run|report|history) ", step)]
assert len(steps) == 3, steps

folder = pathlib.Path(tempfile.mkdtemp())
try:
    toy = (SDK / "toy.py").read_text()
    relaxed = toy.replace("(length - rest) / (length * w)", "0.94 * (length - rest) / (length * w)")
    assert relaxed != toy
    for file, text in [("sheet.toml", SCENE), ("cloth.toml", STUDY), ("taut_solver.py", (SDK / "taut_solver.py").read_text())]:
        (folder / file).write_text(text)
    environment = os.environ | {"PATH": f"{PROGRAM}:{os.environ['PATH']}", "PYTHONDONTWRITEBYTECODE": "1"}
    for sha, text, expected in [("a" * 40, toy, 4), ("b" * 40, toy, 0), ("c" * 40, relaxed, 1), ("d" * 40, relaxed, 0)]:
        (folder / "mine.py").write_text(text)
        for step in steps:
            command = step.replace("${{ github.sha }}", sha)
            ended = subprocess.run(command, shell=True, cwd=folder, env=environment, text=True, capture_output=True, timeout=120)
            if "taut history" not in command:
                assert ended.returncode == 0, (command, ended.stdout, ended.stderr)
        assert ended.returncode == expected, (sha, ended.returncode, ended.stdout, ended.stderr)
        found = xml.etree.ElementTree.parse(folder / "cloth.xml").getroot()[0]
        assert (found.get("tests"), found.get("failures")) == ("2", "2" if expected == 1 else "0"), (sha, found.attrib)
        page = (folder / "cloth.html").read_text()
        assert ('"history":[{' in page) == (sha[0] != "a"), "the page shows the builds once there are two"
        print(f"commit {sha[:4]}: exit {ended.returncode}")
finally:
    shutil.rmtree(folder)
print("ok")
