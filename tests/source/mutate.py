#!/usr/bin/env python3
"""Plants random small errors in copies of single files and shows which of them no test notices.

Usage: mutate.py FOLDER [--sample N] [--minutes M] [--seed S] [--layer L]... [--goal SHARE] [--widest N] [--jobs N] [--list]

1. FOLDER gets a build of its own, unless it has one: file by file, at -O1 and without debug information, so that one
   error costs one object and a link.
2. N places are drawn: layers in turn, then an operator (arithmetic, comparison, logic, a constant off by little or by
   much, a sign, an axis, min for max, a removed statement, swapped arguments), then a place. What does not compile, or
   compiles to the same object code, is drawn again. The same seed plants the same errors in the same sources.
3. The objects with these places are compiled once more with gcov's counters, and every check runs once with them: a
   check is a suite of unit tests or a truth of `taut verify`. So it is known which checks run which line.
4. For each error the checks that run its line, those in the layer's own folder of tests first, quick ones before slow
   ones, until one is red. A check also notices if it takes ten times the CPU time that it took before.

Survivors are printed as a difference. Those that change no result are listed in equivalent_mutants.txt with the reason,
and are not drawn. Files on which more than --widest objects depend are left out, and counted: --sample 1000 --widest 999
is the long run. The aim is 92 % noticed, no layer below 85 %; --goal is the share below which the run fails, by more
than chance: two standard deviations of a sample of this size. The tests ask for 0.7 until large samples have been run: of
70 errors that somebody planted by hand all over the tree 48 were noticed (69 %), before tests were strengthened.
"""
import argparse
import concurrent.futures
import contextlib
import itertools
import json
import math
import os
import pathlib
import random
import re
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
EQUIVALENT = pathlib.Path(__file__).with_name("equivalent_mutants.txt")
UNIT, TRUTH = "tests/taut_tests", "taut"  # the programs whose checks notice

# Layers; the tests of each are in the folder of tests/ with its last name.
LAYERS = ["core/model", "core/io", "core/solver", "core/reference", "bullet_ref", "experiments/metrics", "experiments/case",
          "experiments/study", "experiments/timing", "experiments/baseline", "experiments/truths", "experiments/report",
          "experiments/render"]
LEFT_OUT = re.compile(r"/(gl|font|shaders)\.[ch]pp$")  # no numbers in them
NUMBER = r"(?<![\w.'])(\d+\.?\d*(?:e-?\d+)?)(?![\w.'])"


def scaled(factor, step):
    """A literal times `factor`; a whole number that this leaves alone, plus `step`."""
    def change(match):
        text = match[1]
        if text.isdigit():
            value = int(int(text) * factor)
            return str(value if value != int(text) else int(text) + step)
        return repr(float(text) * factor if float(text) else 0.1)
    return change


def exchanged(*couples):
    table = {a: b for x, y in couples for a, b in ((x, y), (y, x))}
    return lambda match: match[0].replace(match[1], table[match[1]])


# operator: (pattern on code without texts and comments, replacement)
OPERATORS = {
    "arithmetic": (r" ([-+*/]) (?=[\w(])", exchanged("+-", "*/")),
    "assignment": (r" ([-+*/])= ", exchanged("+-", "*/")),
    "border": (r" (<|>)(=?) ", lambda m: f" {m[1]}{'' if m[2] else '='} "),
    "direction": (r" ([<>])=? ", exchanged("<>")),
    "equality": (r" ([=!]=) ", exchanged(("==", "!="))),
    "logic": (r" (&&|\|\|) ", lambda m: " || " if m[1] == "&&" else " && "),
    "negation": (r"(?<=\()!(?=\w)", lambda m: ""),
    "little": (NUMBER, scaled(1.02, 1)),
    "much": (NUMBER, scaled(10, 1)),
    "sign": (r"(?<=[(,=] )-(?=[a-z(])|(?<=\()-(?=[a-z(])|(?<=return )-(?=[a-z(])", lambda m: ""),
    "axis": (r"(?<=[\w\])])\.([xyz])(?=\W)", lambda m: "." + "yzx"["xyz".index(m[1])]),
    "extreme": (r"\b(min|max)(?=[({])", lambda m: {"min": "max", "max": "min"}[m[1]]),
    "function": (r"\b(sin|cos|floor|ceil|front|back|begin|end)(?=\()",
                 exchanged(("sin", "cos"), ("floor", "ceil"), ("front", "back"), ("begin", "end"))),
    "constant": (r"\b(true|false)\b", lambda m: "false" if m[1] == "true" else "true"),
    "removed": (r"^ +((?!return|break|continue|const|auto|using|throw|delete|else|case|default)"
                r"[a-z_][\w.\[\]]*(->|\.|\(| [-+*/]?= |\+\+)[^{}]*;)$", lambda m: ";"),
    "swapped": (r"(?<=\w\()(\w+), (\w+)(?=\))", lambda m: f"{m[2]}, {m[1]}"),
}
NOT_CODE = re.compile(r"^\s*(#|//|assert\(|static_assert|if constexpr|template|using |EXPECT_|ASSERT_|TAUT_)")


def code_of(line):
    """The line with texts and comments blanked out, or "" if there is nothing to plant in it."""
    if NOT_CODE.match(line):
        return ""
    line = re.sub(r'"(\\.|[^"\\])*"', lambda m: '"' + "_" * (len(m[0]) - 2) + '"', line)
    line = re.sub(r"<[\w:, <>*&]*>", lambda m: "_" * len(m[0]), line)  # template arguments
    return re.sub(r"//.*", "", line).rstrip()


def sites(file):
    """operator -> every (line number, line with the error) in a file"""
    found = {}
    for number, line in enumerate(file.read_text().splitlines()):
        code = code_of(line)
        for name, (pattern, change) in OPERATORS.items():
            for match in re.finditer(pattern, code):
                planted = line[:match.start()] + change(match) + line[match.end():]
                if name == "removed":
                    planted = re.match(" *", line)[0] + ";"
                if planted != line:
                    found.setdefault(name, []).append((number, planted))
    return found


class Build:
    """The objects and programs of a build of this tree."""

    def __init__(self, folder):
        self.folder = folder
        if not (folder / "build.ninja").exists():
            subprocess.run(["cmake", "-G", "Ninja", "-S", ROOT, "-B", folder, "-DCMAKE_BUILD_TYPE=Debug", "-DTAUT_TESTS=ON",
                            "-DCMAKE_CXX_FLAGS_DEBUG=-O1 -g0", "-DTAUT_BATCH_SIZE=1"], check=True, stdout=subprocess.DEVNULL)
        subprocess.run(["cmake", "--build", folder, "--target", TRUTH, pathlib.Path(UNIT).name], check=True,
                       stdout=subprocess.DEVNULL)
        self.command = {}
        for entry in json.loads((folder / "compile_commands.json").read_text()):
            words = shlex.split(re.sub(r" -Werror\b| -MD -MT \S+ -MF \S+", "", entry["command"]))
            self.command[os.path.normpath(words[words.index("-o") + 1])] = words
        self.link_command = {}
        for program in (UNIT, TRUTH):
            lines = [line for line in self.ninja("-t", "commands", program).splitlines() if f"-o {program} " in line]
            self.link_command[program] = shlex.split(lines[-1].removeprefix(": && ").split(" && ")[0])
        self.dependents = {}
        current = None
        for line in self.ninja("-t", "deps").splitlines():
            if line and not line[0].isspace():
                current = os.path.normpath(line.split(":")[0])
            elif line.strip():
                path = os.path.normpath(os.path.join(folder, line.strip()))
                self.dependents.setdefault(path, set()).add(current)

    def ninja(self, *words):
        return subprocess.run(["ninja", *words], cwd=self.folder, check=True, text=True, capture_output=True).stdout

    def in_program(self, program, target):
        """Whether the program is linked with this object, in a library or by itself."""
        words = self.link_command[program]
        library = re.match(r"CMakeFiles/(\w+)\.dir/", target)
        return target in words or bool(library) and f"lib{library[1]}.a" in words

    def objects(self, file):
        """Those that depend on a source file and stand in one of the programs."""
        return sorted(target for target in self.dependents.get(str(ROOT / file), ())
                      if any(self.in_program(program, target) for program in self.link_command))

    def compile(self, target, out, more=(), changed=None):
        """The object `out`; False if it does not compile. changed: a folder whose files stand for the tree's."""
        words = list(self.command[target])
        words[words.index("-o") + 1] = str(out)
        if changed:
            source = pathlib.Path(words[words.index("-c") + 1])
            text = source.read_text()
            for file in changed.rglob("*.[ch]pp"):  # a batch of files includes them by their whole paths
                name = file.relative_to(changed)
                text = file.read_text() if source == ROOT / name else text.replace(f'"{ROOT / name}"', f'"{file}"')
            copy = out.parent / "from" / source.name
            copy.parent.mkdir(exist_ok=True)
            copy.write_text(text)
            words[words.index("-c") + 1] = str(copy)
            words.insert(words.index(f"-I{ROOT}"), f"-I{changed}")
            more = [*more, f"-fmacro-prefix-map={copy.parent}={source.parent}", f"-fmacro-prefix-map={changed}={ROOT}"]
        return subprocess.run(words + list(more), cwd=self.folder, capture_output=True).returncode == 0

    def link(self, program, objects, out, more=()):
        """The program with some objects in the place of its own; False if it does not link."""
        words = [str(objects.get(word, word)) for word in self.link_command[program]]
        words[words.index("-o") + 1] = str(out)
        # Members of libraries in front of these, which then have nothing left to give.
        words[1:1] = [str(new) for target, new in objects.items()
                      if target not in self.link_command[program] and self.in_program(program, target)]
        return subprocess.run(words + list(more), cwd=self.folder, capture_output=True).returncode == 0


class Check:
    """A suite of unit tests, or a truth."""

    def __init__(self, program, name, folder):
        self.program, self.name, self.folder = program, name, folder
        self.seconds = 0.0  # CPU time that it takes

    def words(self, program):
        if self.program == UNIT:
            return [program, f"--gtest_filter={self.name}.*", "--gtest_brief=1"]
        return [program, "verify", "-j1", "--quiet", self.name]


def checks_of(build):
    folder_of = {suite: file.parent.name for file in (ROOT / "tests").glob("*/*_test.cpp")
                 for suite in re.findall(r"^(?:TYPED_)?TEST(?:_F|_P)?\((\w+),", file.read_text(), re.MULTILINE)}
    listed = subprocess.run([build.folder / UNIT, "--gtest_list_tests", "--gtest_filter=-*.DISABLED_*"], check=True,
                            text=True, capture_output=True).stdout
    suites = [line.split("#")[0].strip().rstrip(".") for line in listed.splitlines() if line and not line[0].isspace()]
    truths = subprocess.run([build.folder / TRUTH, "verify", "--list"], check=True, text=True, capture_output=True).stdout
    return ([Check(UNIT, suite, folder_of.get(suite.split("/")[-1], "")) for suite in suites if "Running main" not in suite]
            + [Check(TRUTH, line.split("\t")[1], "truths") for line in truths.splitlines()])


def run(check, program, where, seconds=600.0, **environment):
    """(whether it is green, CPU seconds); red if it takes more CPU time, or hangs"""
    # A folder of its own for what the tests write: several run at the same time.
    environment = {**os.environ, "TMPDIR": f"{where}/", "TEST_TMPDIR": f"{where}/", **environment}
    process = subprocess.Popen(check.words(program), cwd=where, env=environment, start_new_session=True,
                               stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def kill():
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    for limit, most in ((resource.RLIMIT_CPU, math.ceil(seconds)), (resource.RLIMIT_DATA, 8 << 30)):
        with contextlib.suppress(ProcessLookupError):
            resource.prlimit(process.pid, limit, (most, most))
    hangs = threading.Timer(60 + 10 * seconds, kill)
    hangs.start()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    hangs.cancel()
    kill()  # what it left behind
    return process.returncode == 0, usage.ru_utime + usage.ru_stime


class Coverage:
    """Which check runs which line of the given objects, and how long each check takes."""

    def __init__(self, build, objects, checks, folder, pool):
        self.folder, self.lines, self.lock = folder, {}, threading.Lock()
        (folder / "counted").mkdir(parents=True)
        self.counted = {target: folder / "counted" / target.replace("/", "_") for target in objects}
        list(pool.map(lambda t: build.compile(t, self.counted[t], ["--coverage", "-fprofile-update=atomic"]), self.counted))
        programs = {}
        for program in build.link_command:
            programs[program] = folder / pathlib.Path(program).name
            if not build.link(program, self.counted, programs[program], ["--coverage"]):
                sys.exit(f"mutate: {program} cannot be linked with counters")
        def count(check):
            with tempfile.TemporaryDirectory() as where:
                green, check.seconds = run(check, programs[check.program], where, GCOV_PREFIX=str(folder / check.name))
            return green
        self.idle = {UNIT: Check(UNIT, "None", ""), TRUTH: Check(TRUTH, "--list", "")}
        for check in self.idle.values():
            count(check)
        self.red = [check.name for check, green in zip(checks, pool.map(count, checks)) if not green]

    def counters(self, check, target):
        counted = self.counted[target].with_suffix(".gcda")
        return pathlib.Path(f"{self.folder / check.name}{counted}")

    def executed(self, check, target):
        """file -> line -> how often, where the check runs this object at all"""
        key = check.name, target
        if key not in self.lines:
            data, idle = self.counters(check, target), self.counters(self.idle[check.program], target)
            self.lines[key] = {}
            if data.exists() and not (idle.exists() and idle.read_bytes() == data.read_bytes()):
                notes = data.with_suffix(".gcno")
                if not notes.exists():
                    notes.symlink_to(self.counted[target].with_suffix(".gcno"))
                report = subprocess.run(["gcov", "--json-format", "--stdout", "-r", "-s", ROOT, data], cwd=data.parent,
                                        capture_output=True, text=True).stdout
                for file in json.loads(report)["files"] if report else []:
                    name = os.path.relpath(os.path.join(ROOT, file["file"]), ROOT)
                    counts = self.lines[key].setdefault(name, {})
                    for line in file["lines"]:
                        counts[line["line_number"]] = counts.get(line["line_number"], 0) + line["count"]
        return self.lines[key]

    def runs(self, check, targets, file, number):
        """Whether the check runs a line. What gcov does not list (a constant, the rest of a statement) counts as run."""
        for target in targets:
            counts = self.executed(check, target).get(file)
            if counts is not None and counts.get(number, 1) > 0:
                return True
        return False


def equivalents():
    """(file, line, line with the error) of every mutant that is known to change nothing"""
    known = set()
    for line in EQUIVALENT.read_text().splitlines():
        if line and not line.startswith("#"):
            file, was, planted, reason = (part.strip() for part in line.split(" | "))
            assert reason, line
            known.add((file, was, planted))
    return known


class Mutant:
    def __init__(self, layer, file, number, planted):
        self.layer, self.file, self.number, self.planted = layer, file, number, planted
        self.was = (ROOT / file).read_text().splitlines()[number - 1]
        self.objects = {}  # target -> the object with the error in it
        self.by, self.checks, self.seconds = None, 0, 0.0

    def text(self):
        return f"{self.file}:{self.number}\n    - {self.was.strip()}\n    + {self.planted.strip()}"

    def compile(self, build, folder):
        """Whether it compiles, to something else than without the error."""
        changed = folder / "tree" / self.file
        changed.parent.mkdir(parents=True)
        lines = (ROOT / self.file).read_text().splitlines()
        lines[self.number - 1] = self.planted
        changed.write_text("\n".join(lines) + "\n")
        for target in build.objects(self.file):
            out = folder / target.replace("/", "_")
            if not build.compile(target, out, changed=folder / "tree"):
                return False
            if out.read_bytes() != (build.folder / target).read_bytes():
                self.objects[target] = out
        return bool(self.objects)

    def judge(self, build, folder, checks, coverage):
        """Sets by whom it is noticed, and what that took."""
        own, programs = self.layer.split("/")[-1], {}
        for check in sorted(checks, key=lambda c: (c.folder != own, c.seconds)):
            if not coverage.runs(check, self.objects, self.file, self.number):
                continue
            if check.program not in programs:
                programs[check.program] = folder / pathlib.Path(check.program).name
                if not build.link(check.program, self.objects, programs[check.program]):
                    self.by = "the linker"
                    return
            with tempfile.TemporaryDirectory(dir=folder) as where:
                green, seconds = run(check, programs[check.program], where, max(10.0, 10 * check.seconds))
            self.checks, self.seconds = self.checks + 1, self.seconds + seconds
            if not green:
                self.by = check.name
                return


def draw(layers, seed, build, widest):
    """Mutants without end: layers in turn, then a random operator and place."""
    random_ = random.Random(seed)
    known, pools, wide = equivalents(), {}, 0
    for layer in layers:
        pools[layer] = {}
        for file in sorted(ROOT.glob(f"{layer}/**/*.[ch]pp")):
            name = str(file.relative_to(ROOT))
            if LEFT_OUT.search(name) or not build.objects(name):
                continue
            if len(build.objects(name)) > widest:
                wide += 1
                continue
            lines = file.read_text().splitlines()
            for operator, places in sites(file).items():
                pools[layer].setdefault(operator, []).extend(
                    (name, number + 1, planted) for number, planted in places
                    if (name, lines[number].strip(), planted.strip()) not in known)
    places = sum(len(p) for pool in pools.values() for p in pool.values())
    print(f"seed {seed}: {places} places in {len(layers)} layers; left out, as too much depends on them: {wide} files",
          flush=True)
    while any(place for pool in pools.values() for place in pool.values()):
        for layer, pool in pools.items():
            operators = sorted(o for o in pool if pool[o])
            if operators:
                operator = random_.choice(operators)
                yield Mutant(layer, *pool[operator].pop(random_.randrange(len(pool[operator]))))


def compiled(mutants, sample, build, folder, pool):
    """The first `sample` of the mutants that compile; and how many did not, or not to anything else."""
    good, idle, batch = [], 0, 0
    while len(good) < sample:
        more = list(itertools.islice(mutants, sample - len(good)))
        if not more:
            break
        folders = [folder / f"{batch + i}" for i in range(len(more))]
        batch += len(more)
        done = list(pool.map(lambda m, f: m.compile(build, f), more, folders))
        good += [(mutant, where) for mutant, where, fine in zip(more, folders, done) if fine]
        idle += done.count(False)
    return good, idle


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--sample", type=int, default=60)
    parser.add_argument("--minutes", type=float, default=1e9, help="judge no more errors after this time")
    parser.add_argument("--seed", type=int, default=int(time.time()))
    parser.add_argument("--layer", action="append", choices=LAYERS)
    parser.add_argument("--goal", type=float, default=0.92, help="least share noticed")
    parser.add_argument("--widest", type=int, default=4)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--list", action="store_true", help="only print what would be planted")
    options = parser.parse_args()
    build = Build(options.folder.resolve())
    mutants = draw(options.layer or LAYERS, options.seed, build, options.widest)
    if options.list:
        for mutant in itertools.islice(mutants, options.sample):
            print(mutant.text())
        return 0
    os.environ["CCACHE_DISABLE"] = "1"  # nothing of what follows is compiled twice
    start = time.monotonic()

    def spent():
        cpu = resource.getrusage(resource.RUSAGE_CHILDREN)
        return f"{time.monotonic() - start:.0f} s, {cpu.ru_utime + cpu.ru_stime:.0f} s of CPU"
    with tempfile.TemporaryDirectory() as scratch, concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        folder = pathlib.Path(scratch)
        good, idle = compiled(mutants, options.sample, build, folder, pool)
        print(f"{len(good)} compiled, {idle} did not or made no difference: {spent()}", flush=True)
        checks = checks_of(build)
        coverage = Coverage(build, sorted({t for mutant, _ in good for t in mutant.objects}), checks, folder / "coverage", pool)
        print(f"{len(checks)} checks take {sum(c.seconds for c in checks):.0f} s of CPU: {spent()}", flush=True)
        if coverage.red:
            sys.exit(f"mutate: red without any error: {', '.join(coverage.red)}")

        def judge(mutant, where):
            if time.monotonic() - start < 60 * options.minutes:
                mutant.judge(build, where, checks, coverage)
                shutil.rmtree(where)
                how = (f"noticed by {mutant.by}: {mutant.file}:{mutant.number}" if mutant.by else
                       f"SURVIVED {mutant.checks} checks that run it: {mutant.text()}")
                print(f"{how}   ({mutant.seconds:.0f} s)", flush=True)
                return mutant
            return None
        judged = [mutant for mutant in pool.map(judge, *zip(*good)) if mutant]
    for layer in options.layer or LAYERS:
        of_layer = [mutant for mutant in judged if mutant.layer == layer]
        print(f"{layer:22} {sum(m.by is not None for m in of_layer):3} of {len(of_layer):3}")
    if not judged:
        sys.exit("mutate: no time for a single one")
    noticed = sum(mutant.by is not None for mutant in judged)
    share = noticed / len(judged)
    bar = options.goal - 2 * math.sqrt(options.goal * (1 - options.goal) / len(judged))
    print(f"noticed: {noticed} of {len(judged)} ({share:.0%}) in {spent()}; the goal is {options.goal:.0%}, a sample of this "
          f"size fails below {bar:.0%}")
    return 0 if share >= bar else 1


if __name__ == "__main__":
    sys.exit(main())
