"""The checks that notice errors planted by mutate.py: unit tests, truths and tests of the command line, run alone or in batches."""
import ast
import contextlib
import csv
import json
import os
import pathlib
import re
import resource
import signal
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
UNIT, TAUT = "tests/taut_tests", "taut"  # the programs that run checks
SCRIPTS = [file for folder in ("cli", "study/cluster", "external", "truths") for file in (ROOT / "tests" / folder).glob("*_test.py")
           if file.stem not in ("launcher_test", "contributing_test", "schedulers_test")]  # these build, or need a scheduler


class Check:
    """A unit test, a truth, or a test of a script."""

    def __init__(self, program, name, seconds, file=None):
        self.program, self.name, self.seconds = program, name, seconds
        self.script = file if file in SCRIPTS else None
        self.folder = file.relative_to(ROOT / "tests").parts[0] if file else "truths"


def checks_of(build):
    """Every check, with the seconds that it took when ctest last ran it in BUILD. Unit tests that ctest has not run are run once to
    learn their time, since a few slow ones at the start would use up the time for an error's checks. ctest runs the tests of a script
    together, and likewise all truths: each counts as the mean of these, or, if they were not run, as longer than most take."""
    took = {}
    with contextlib.suppress(OSError):
        took = {words[0]: float(words[2]) for line in (build / "Testing/Temporary/CTestCostData.txt").read_text().splitlines()
                if len(words := line.split()) == 3 and int(words[1])}
    file_of = {".".join(test): file for file in (ROOT / "tests").rglob("*_test.cpp")  # several files may have a suite of the same name
               for test in re.findall(r"^TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\)", file.read_text(), re.MULTILINE)}
    listed = subprocess.run([build / UNIT, "--gtest_list_tests", "--gtest_filter=-*.DISABLED_*"], check=True,
                            text=True, capture_output=True).stdout
    units, suite = [], ""
    for line in listed.splitlines():
        name = line.split("#")[0].strip()
        if line.startswith(" "):
            units.append(suite + name)
        elif name.endswith("."):
            suite = name
    took |= timed(build, [name for name in units if name not in took])
    checks = []
    for name in units:
        suite, test = name.split(".")
        checks.append(Check(UNIT, name, took.get(name, 15), file_of.get(f"{suite.split('/')[-1]}.{test.split('/')[0]}")))
    truths = subprocess.run([build / TAUT, "verify", "--list", "--csv"], check=True, text=True, capture_output=True).stdout
    names = [truth["name"] for truth in csv.DictReader(truths.splitlines())]
    # ctest runs the truths on two cores.
    checks += [Check(TAUT, name, 2 * took["truths"] / len(names) if "truths" in took else 15) for name in names]
    for script in SCRIPTS:
        names = [f"{of.name}.{test.name}" for of in ast.parse(script.read_text()).body if isinstance(of, ast.ClassDef)
                 for test in of.body if getattr(test, "name", "").startswith("test")]
        checks += [Check(TAUT, name, took[script.stem] / len(names) if script.stem in took else 30, script) for name in names]
    return checks


def timed(build, names):
    """Runs unit tests once and returns the seconds that each takes."""
    with tempfile.TemporaryDirectory() as where:
        environment = {**os.environ, "TMPDIR": where, "TEST_TMPDIR": where,
                       "GTEST_FILTER": ":".join(names), "GTEST_OUTPUT": f"json:{where}/took.json"}
        if names:
            subprocess.run([build / UNIT], cwd=where, env=environment, check=False, capture_output=True)
        with contextlib.suppress(OSError):
            suites = json.loads(pathlib.Path(where, "took.json").read_text())["testsuites"]
            return {f"{test['classname']}.{test['name']}": float(test["time"].rstrip("s")) for suite in suites
                    for test in suite["testsuite"]}
    return {}


def cpu_seconds(pid):
    """CPU time of a process and of those of its children that have ended; 0 if the process no longer exists."""
    with contextlib.suppress(OSError):
        times = pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[11:15]
        return sum(map(int, times)) / os.sysconf("SC_CLK_TCK")
    return 0


def run(checks, program, where, seconds=600.0, **environment):
    """Runs checks of one program and returns (name of a red check or None, CPU seconds). Checks are also red if they take more than
    `seconds` of CPU time, or hang."""
    # The tests write into a folder of their own, since several run at the same time.
    environment = {**os.environ, "TMPDIR": f"{where}/", "TEST_TMPDIR": f"{where}/", **environment}
    names = [check.name for check in checks]
    if checks[0].script:
        words = [sys.executable, checks[0].script, program.parent, *names]
    elif checks[0].program == UNIT:
        words = [program, "--gtest_filter=" + ":".join(names), "--gtest_fail_fast"]
    else:
        words = [program, "verify", "-j1", "--quiet", *names]
    with open(f"{where}/output", "w+") as output:
        process = subprocess.Popen(words, cwd=where, env=environment, start_new_session=True,
                                   stdin=subprocess.DEVNULL, stdout=output, stderr=output)

        def kill():
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
        with contextlib.suppress(ProcessLookupError):
            resource.prlimit(process.pid, resource.RLIMIT_DATA, (8 << 30, 8 << 30))
        hangs = threading.Timer(60 + 10 * seconds, kill)
        hangs.start()
        # RLIMIT_CPU is not used: if it is set, Linux counts a process's CPU time in ticks, so that anything shorter takes no time.
        ended, nap = 0, 0.001
        while not ended:
            ended, status, usage = os.wait4(process.pid, os.WNOHANG)
            if not ended and cpu_seconds(process.pid) > seconds:
                kill()
            time.sleep(0 if ended else nap)
            nap = min(0.1, 1.5 * nap)
        process.returncode = os.waitstatus_to_exitcode(status)
        hangs.cancel()
        kill()  # processes that it left behind
        output.seek(0)
        text = output.read()
        told = re.findall(r"^\[ ( FAILED |RUN     ) \] ([^\s,]+)", text, re.MULTILINE)
        told += [("FAILED", f"{of}.{test}") for test, of in re.findall(r"^(?:FAIL|ERROR): (\w+) \(__main__\.(\w+)", text, re.MULTILINE)]
    named = [name for word, name in told if "FAILED" in word] or [name for _, name in reversed(told)] or names
    return named[0] if process.returncode else None, usage.ru_utime + usage.ru_stime
