"""Shared by the tests of the command line: a scratch folder, the built programs, a small study."""

import fcntl
import json
import os
import pathlib
import pty
import struct
import subprocess
import sys
import tempfile
import termios
import unittest

import stored

BINARIES = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "build/default").resolve()

SCENE = """
summary = "A small sheet"
[cloth]
grid = [4, 4]
size = [1, 1]
mass = 0.1
pins = ["top-left"]
[time]
dt = "1/64"
duration = 0.5
"""


def facts_of(answer):
    """{name: value} of the facts in an answer that a verb printed with --json"""
    return {name: fact["value"] for name, fact in answer["facts"].items()}


def rows_of(answer, table):
    """The rows of a table in an answer, each {name of the column: value}"""
    names = [column["name"] for column in answer["tables"][table]["columns"]]
    return [dict(zip(names, row, strict=True)) for row in answer["tables"][table]["rows"]]


class CommandLine(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        (self.folder / "small.toml").write_text(SCENE)

    def start(self, *words, program="taut", **more):
        return subprocess.Popen([BINARIES / program, *map(str, words)], cwd=self.folder, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, **more)

    def on_a_terminal(self, *words, columns=0, **environment):
        """Output of a verb whose stdout is a terminal with this many columns; 0: the width is unknown."""
        ours, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        process = subprocess.Popen([BINARIES / "taut", *words], cwd=self.folder, stdout=theirs, stderr=subprocess.DEVNULL,
                                   env={k: v for k, v in os.environ.items() if k != "NO_COLOR"} | environment)
        os.close(theirs)
        said = b""
        try:
            while chunk := os.read(ours, 65536):
                said += chunk
        except OSError:  # the other end is closed
            pass
        os.close(ours)
        process.wait(timeout=60)
        return said.decode()

    def taut(self, *words, expect=0, program="taut", **more):
        process = self.start(*words, program=program, **more)
        process.out, process.err = process.communicate(timeout=120)
        if expect is not None:
            self.assertEqual(process.returncode, expect, f"{words}\n{process.out}\n{process.err}")
        return process

    def answer(self, *words, **more):
        return json.loads(self.taut(*words, "--json", **more).out)

    def study(self, name="study.toml", scenes=("./small.toml",), solvers=("jakobsen",), rest=""):
        file = self.folder / name
        file.write_text('question = "Does it?"\n'
                        f"scenes = {json.dumps(list(scenes))}\nsolvers = {json.dumps(list(solvers))}\n{rest}")
        return "./" + name

    def store_digest(self, process):
        lines = [line.split() for line in (process.out + process.err).splitlines() if line.strip().startswith("store ")]
        return " ".join(lines[-1])

    def records(self, results="results/runs"):
        return stored.records(self.folder / results)

    def keys(self, results="results/runs"):
        """Keys of the stored cases."""
        return stored.keys(self.folder / results)


def main():
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)  # names skipped tests, which `taut test` repeats


assert os.name == "posix"
