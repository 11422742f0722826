#!/usr/bin/env python3
"""Plants random small errors in the sources and shows which of them no test notices.

Usage: mutate.py BUILD [--sample N] [--layers N] [--minutes M] [--seed S] [--layer L]... [--goal SHARE] [--limit SECONDS]
                       [--chosen FILE] [--jobs N] [--list]

1. BUILD is a Ninja build of this tree. N errors are drawn in some layers, which are drawn too. The layers take turns; for each error
   an operator is drawn (arithmetic, comparison, logic, a constant off by little or by much, a sign, an axis, min for max, a removed
   statement, swapped arguments), then a place. The same seed plants the same errors in the same sources.
2. All errors are planted at once: a function with an error has a second body, which runs if $TAUT_ERROR is the number of that error.
   So a layer is compiled only once, as BUILD compiles it, however many errors it has. Errors that do not compile are dropped.
3. A check is a unit test, a truth of `taut verify` or a test of the command line. For each error, the checks in the layer's own
   folder of tests run first, then the others, quick ones before slow ones (by their time when ctest last ran them in BUILD, or in a
   run here), until one is red or they took --limit seconds of CPU. Every run records which functions with errors it reaches, and
   checks that do not reach a function are not run for its errors. A check also counts as red if it takes more than four times the
   CPU time that it takes without an error. A check that is red without the error as well does not count.

Survivors are printed as differences. Errors that change no result are listed in equivalent_mutants.txt with the reason, and are not
drawn. Places outside functions or in constexpr ones, and headers that are included by layers which were not drawn, are left out and
counted. The aim is 92 % noticed, with no layer below 85 %. The run fails if the number noticed is so small that a sample of this size
has it less than once in a thousand times when the true share is --goal. It ends with 77, neither passed nor failed, if so few errors
were judged in --minutes that it would not have failed with three fifths of them unnoticed. The tests ask for a goal of 0.7: shares of
0.8 and more were measured while one test of the command line was red with any error that reached it, and counted as noticing it.

--chosen plants the errors of a file instead (chosen_mutants.txt). Every error must be noticed by the checks that
its line names, however long they take.
"""
import argparse
import concurrent.futures
import contextlib
import fnmatch
import functools
import itertools
import json
import math
import os
import pathlib
import random
import re
import resource
import shlex
import signal
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True
from mutation_checks import ROOT, TAUT, UNIT, checks_of, run  # noqa: E402
from mutation_operators import bodies, sites  # noqa: E402

EQUIVALENT = pathlib.Path(__file__).with_name("equivalent_mutants.txt")

# Layers and their libraries; the tests of each are in the folder of tests/ with its last name.
LAYERS = {"core/model": "taut_model", "core/io": "taut_io", "core/solver": "taut_solver", "core/reference": "taut_reference",
          "bullet_ref": "taut_bullet64", **{f"experiments/{name}": f"taut_{name}" for name in (
              "system", "answer", "metrics", "case", "external", "results", "study", "timing", "steps", "require", "baseline", "truths",
              "report", "render")}, "experiments/cli": "taut_commands", "experiments/command_line": "taut_commands"}
LEFT_OUT = re.compile(r"/(gl|font|shaders)\.[ch]pp$")  # contain no numbers
PROGRAMS = (UNIT, TAUT, "taut-f32", "taut-faulty")  # contain the errors; the others call the last two
MOST = 1 << 16  # largest number of errors at a time
CHOSEN = f"""
#include <fcntl.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>
int taut_error;
static unsigned char nowhere[{MOST}];
unsigned char* taut_reached = nowhere;
__attribute__((constructor(101))) static void choose(void) {{
  taut_error = getenv("TAUT_ERROR") ? atoi(getenv("TAUT_ERROR")) : 0;
  const char* file = getenv("TAUT_REACHED");
  const int descriptor = file ? open(file, O_RDWR) : -1;
  if (descriptor < 0) return;
  void* shared = mmap(0, {MOST}, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  if (shared != MAP_FAILED) taut_reached = shared;
  close(descriptor);
}}
"""
HEAD = """extern "C" int taut_error;
extern "C" unsigned char* taut_reached;
#define taut_has(number) (taut_reached[number] = 1, taut_error == number)
"""
CHANCE = 0.001


def chance(noticed, n, share):
    """Probability that at most `noticed` of n errors are noticed, if this share of all errors is"""
    return sum(math.comb(n, k) * share**k * (1 - share)**(n - k) for k in range(noticed + 1))


def interval(k, n):
    """95 % interval of a share of which k of n were seen (Wilson's score interval)"""
    z2 = 1.96**2
    middle, half = (k + z2 / 2) / (n + z2), math.sqrt(z2 * (k * (n - k) / n + z2 / 4)) / (n + z2)
    return f"{middle - half:.0%} to {middle + half:.0%}"


class Mutant:
    def __init__(self, layer, file, line, planted, checks="*", tests=()):
        self.layer, self.file, self.line, self.planted, self.checks, self.tests = layer, file, line, planted, checks, tests
        self.was = (ROOT / file).read_text().splitlines()[line - 1]
        self.program = None  # the program whose checks may notice it; None: several programs
        self.number, self.compiles = 0, True
        self.by, self.tried, self.seconds = None, 0, 0.0

    def text(self):
        return f"{self.file}:{self.line}\n    - {self.was.strip()}\n    + {self.planted.strip()}"

    def body(self, text):
        """(start, end, text): the place of its function's body in the file's text, and that body with the error. None outside functions."""
        lines = text.splitlines(keepends=True)
        changed = "".join([*lines[:self.line - 1], self.planted + "\n", *lines[self.line:]])
        first, more = len(os.path.commonprefix([text, changed])), len(changed) - len(text)
        return next(((start, end, changed[start:end + more]) for start, end in bodies(text)
                     if start <= first < end and text[end:] == changed[end + more:]), None)


class Build:
    """Compiles objects of the layers and links programs as BUILD does, but with errors in them."""

    def __init__(self, build, folder):
        self.build, self.folder = build, folder
        self.commands = {}
        for entry in json.loads((build / "compile_commands.json").read_text()):
            words = shlex.split(re.sub(r" -Werror\b| -MD -MT \S+ -MF \S+", "", entry["command"]))
            self.commands[os.path.normpath(words[words.index("-o") + 1])] = [words[0], "-w", *words[1:]]
        self.library = {word: f"lib{library}.a" for library in set(LAYERS.values())
                        for word in self.ninja("-t", "query", f"lib{library}.a").split("outputs:")[0].split()
                        if word in self.commands and "registry" not in word}
        self.dependents, object_ = {}, None
        for line in self.ninja("-t", "deps").splitlines():
            if line and not line[0].isspace():
                object_ = os.path.normpath(line.split(":")[0])
            elif line.strip():
                path = os.path.normpath(os.path.join(build, line.strip()))
                self.dependents.setdefault(path, set()).add(object_)

    def ninja(self, *words):
        return subprocess.run(["ninja", *words], cwd=self.build, check=True, text=True, capture_output=True).stdout

    def objects(self, file, tests=(), program=None):
        """The objects of the layers that depend on a source file (and are linked into `program`, if given), and the objects of these test files."""
        of_tests = [self.dependents[str(ROOT / test)] for test in tests]
        of_file = self.dependents.get(str(ROOT / file), set()) & self.library.keys()
        if program:
            linked = set(self.link_line(program))
            of_file = {target for target in of_file if self.library[target] in linked or target in linked}
        return of_file.union(*of_tests)

    @functools.cache
    def link_line(self, program):
        return shlex.split(next(line for line in reversed(self.ninja("-t", "commands", program).splitlines())
                                if f"-o {program} " in line).removeprefix(": && ").split(" && ")[0])

    def compile(self, target, mutants):
        """Compiles an object with all of these errors, except those that do not compile."""
        folder = self.folder / target.replace("/", "_")
        tree, out = folder / "tree", folder / "object.o"
        words = list(self.commands[target])
        words[words.index("-o") + 1] = str(out)
        words[1:1] = [f"-I{tree}", f"-fmacro-prefix-map={tree}={ROOT}"]  # searched before the tree itself
        source = pathlib.Path(words[words.index("-c") + 1])
        while mutants := [mutant for mutant in mutants if mutant.compiles]:
            ranges, text = {}, source.read_text()
            for file in {mutant.file for mutant in mutants}:
                of_file = [mutant for mutant in mutants if mutant.file == file]
                (tree / file).parent.mkdir(parents=True, exist_ok=True)
                (tree / file).write_text(planted((ROOT / file).read_text(), of_file, ranges))
                text = text.replace(f'"{ROOT / file}"', f'"{tree / file}"')  # a batch includes files by their full paths
            (folder / source.name).write_text(text)
            copy = tree / os.path.relpath(source, ROOT)
            words[words.index("-c") + 1] = str(copy if copy.exists() else folder / source.name)
            done = subprocess.run(words, cwd=self.build, capture_output=True, text=True)
            if done.returncode == 0:
                return out
            for error in (r":\d+: (?:fatal )?error:", ""):  # first the lines with errors, otherwise all lines that the compiler mentions
                told = re.findall(rf"{re.escape(str(tree))}/(\S+?):(\d+){error}", done.stderr)
                if bad := [m for m in mutants if any(name == m.file and int(line) in ranges[m] for name, line in told)]:
                    break
            for mutant in bad or mutants:
                mutant.compiles = False
        return None

    def link(self, program, objects, out):
        words = list(self.link_line(program))
        words[words.index("-o") + 1] = str(out)
        # Objects of the layers come first: the linker takes an inline function of a header from the first object that has it.
        mine = [target for target in objects if {target, self.library.get(target)} & set(words)]
        own = [str(objects[target]) for target in sorted(mine, key=lambda target: target not in self.library)]
        # Nothing is then left that the linker would take from BUILD's libraries.
        words = [words[0], "-Wl,--strip-debug", *own, str(self.folder / "chosen.o"), *(w for w in words[1:] if w not in objects)]
        subprocess.run(words, cwd=self.build, check=True)

    def plant(self, mutants, programs, pool):
        """Makes a folder with the programs that contain the errors and with everything else in BUILD. If all checks of an error
        belong to one program, only the objects of that program contain it."""
        beside, chosen = self.folder / "programs", self.folder / "chosen.c"
        for name in ("", "tests"):
            (beside / name).mkdir()
            for entry in (self.build / name).iterdir():
                if str(entry.relative_to(self.build)) not in (*programs, "tests"):
                    (beside / name / entry.name).symlink_to(entry)
        chosen.write_text(CHOSEN)
        subprocess.run(["cc", "-c", chosen, "-o", chosen.with_suffix(".o")], check=True)
        of = {}
        for mutant in mutants:
            for target in self.objects(mutant.file, mutant.tests, mutant.program):
                of.setdefault(target, []).append(mutant)
        # The largest come first, so that both cores stay busy to the end.
        targets = sorted(of, key=lambda target: -(self.build / target).stat().st_size)
        compiled = zip(targets, pool.map(lambda target: self.compile(target, of[target]), targets))
        objects = {target: object_ for target, object_ in compiled if object_}
        list(pool.map(lambda program: self.link(program, objects, beside / program), programs))
        return beside


def planted(text, mutants, ranges):
    """The text of a file with every error, each in a body of its own. Stores their lines in `ranges`."""
    of = {}
    for mutant in mutants:
        start, end, body = mutant.body(text)
        of.setdefault((start, end), []).append((mutant, body))
    out, at = HEAD, 0
    for (start, end), chosen in sorted(of.items()):
        out += text[at:start]
        for mutant, body in chosen:
            first = out.count("\n") + 1
            out += f" if (taut_has({mutant.number})) {{{body}}} else"
            ranges[mutant] = range(first, out.count("\n") + 2)
        out += f" {{{text[start:end]}}}"
        at = end
    return out + text[at:]


def rows(file):
    """The columns of a list of errors, whose lines are `file | what is there | what is planted | more`"""
    return [[part.strip() for part in line.split(" | ")] for line in file.read_text().splitlines() if line and line[0] != "#"]


def chosen(file):
    """The errors that a file lists, each with the checks that must notice it"""
    for name, there, instead, checks, *tests in rows(file):
        lines = (ROOT / name).read_text().splitlines()
        found = [number for number, line in enumerate(lines) if there in line]
        if len(found) != 1:
            sys.exit(f"mutate: {name} contains {there!r} {len(found)} times, not once")
        layer = max((layer for layer in LAYERS if name.startswith(layer)), key=len)
        mutant = Mutant(layer, name, found[0] + 1, lines[found[0]].replace(there, instead), checks, tests)
        if mutant.body((ROOT / name).read_text()) is None:
            sys.exit(f"mutate: {there!r} of {name} is in no function")
        yield mutant


def draw(layers, random_, build):
    """Draws mutants endlessly: from the layers in turn, with a random operator and place."""
    known, pools, wide, outside = {tuple(row[:3]) for row in rows(EQUIVALENT)}, {layer: {} for layer in layers}, 0, 0
    for layer in layers:
        for file in sorted(ROOT.glob(f"{layer}/**/*.[ch]pp")):
            name = str(file.relative_to(ROOT))
            if LEFT_OUT.search(name) or not build.objects(name):
                continue
            if not {build.library[target] for target in build.objects(name)} <= {f"lib{LAYERS[drawn]}.a" for drawn in layers}:
                wide += 1
                continue
            text = file.read_text()
            lines = text.splitlines()
            inside = {line for start, end in bodies(text)
                      for line in range(text.count("\n", 0, start) + 1, text.count("\n", 0, end) + 2)}
            for operator, places in sites(file).items():
                places = [(name, line + 1, planted_) for line, planted_ in places
                          if (name, lines[line].strip(), planted_.strip()) not in known]
                outside += sum(line not in inside for _, line, _ in places)
                pools[layer].setdefault(operator, []).extend(place for place in places if place[1] in inside)
    print(f"{sum(len(p) for pool in pools.values() for p in pool.values())} places in {', '.join(layers)}; left out: {outside} outside "
          f"of functions, {wide} headers that other layers include", flush=True)
    while any(place for pool in pools.values() for place in pool.values()):
        for layer, pool in pools.items():
            if operators := sorted(operator for operator in pool if pool[operator]):
                operator = random_.choice(operators)
                mutant = Mutant(layer, *pool[operator].pop(random_.randrange(len(pool[operator]))))
                if mutant.body((ROOT / mutant.file).read_text()):
                    yield mutant


@contextlib.contextmanager
def scratch():
    """A folder that any user may enter, since tests run the program as another user."""
    with tempfile.TemporaryDirectory() as folder:
        os.chmod(folder, 0o755)
        yield folder


class Batch:
    """Checks of one program and folder that run in one process."""

    def __init__(self, checks):
        self.checks, self.folder = checks, checks[0].folder
        self.seconds = sum(check.seconds for check in checks) / len(checks)  # mean time of a check
        self.unharmed = None  # CPU seconds in the program with the errors, with none of them chosen; None: not run yet
        self.reached = None  # by number of an error: whether the checks run its function; None: unknown

    def unharmed_seconds(self, program):
        """The program with the errors is slower than BUILD's, by how much depends on where they are."""
        if self.unharmed is None:
            with scratch() as where:
                _, self.unharmed = run(self.checks, program, where, 60 + 20 * sum(check.seconds for check in self.checks))
        return self.unharmed


def batches_of(checks):
    """Groups checks of the same program and folder into batches of up to 3 s, quick ones first."""
    def program(check):
        return check.folder, check.program, str(check.script)
    for _, group in itertools.groupby(sorted(checks, key=lambda check: (*program(check), check.seconds)), program):
        batch = []
        for check in group:
            if batch and sum(one.seconds for one in batch) + check.seconds >= 3:
                yield Batch(batch)
                batch = []
            batch.append(check)
        yield Batch(batch)


def judge(mutant, batches, programs, limit, sound):
    """Runs checks until one notices the error, and sets `by` and the cost. `sound`: names of checks known to be green without any error."""
    own = mutant.layer.split("/")[-1]
    for batch in sorted(batches, key=lambda batch: (batch.folder != own, batch.seconds)):
        while batch.checks and (batch.reached is None or batch.reached[mutant.number]):
            checks = batch.checks
            program = programs / checks[0].program
            allowed = 5 + 4 * batch.unharmed_seconds(program)
            with scratch() as where:
                reached = pathlib.Path(where, "reached")
                reached.write_bytes(bytes(MOST))
                red, seconds = run(checks, program, where, allowed, TAUT_ERROR=str(mutant.number), TAUT_REACHED=str(reached))
                seen = reached.read_bytes()
            mutant.tried, mutant.seconds = mutant.tried + len(checks) * seen[mutant.number], mutant.seconds + seconds
            if not red:
                batch.reached = seen
                break
            culprits = [check for check in checks if check.name == red]
            with scratch() as where:
                if not culprits or red in sound or not run(culprits, program, where, allowed)[0]:
                    sound.add(red)
                    mutant.by = red
                    return
            print(f"red without any error: {red}", flush=True)
            batch.checks = [check for check in checks if check not in culprits]
        if mutant.seconds >= limit:
            return


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--sample", type=int, default=60)
    parser.add_argument("--layers", type=int, default=4, help="how many layers are drawn")
    parser.add_argument("--minutes", type=float, default=1e9, help="judge no more errors after this time")
    parser.add_argument("--seed", type=int, default=int(time.time()))
    parser.add_argument("--layer", action="append", choices=list(LAYERS))
    parser.add_argument("--goal", type=float, default=0.92, help="least share noticed")
    parser.add_argument("--limit", type=float, default=30, help="CPU seconds of checks for an error")
    parser.add_argument("--chosen", type=pathlib.Path, help="errors to plant in the place of drawn ones")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--list", action="store_true", help="only print what would be planted")
    options = parser.parse_args()
    # A process in the background ignores SIGINT, and its children would inherit that.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    start = time.monotonic()

    def spent():
        cpu = resource.getrusage(resource.RUSAGE_CHILDREN)
        return f"{time.monotonic() - start:.0f} s, {cpu.ru_utime + cpu.ru_stime:.0f} s of CPU"
    with scratch() as folder, concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        build = Build(options.build.resolve(), pathlib.Path(folder))
        random_ = random.Random(options.seed)
        layers = options.layer or sorted(random_.sample(list(LAYERS), options.layers))
        if options.chosen:
            mutants = list(chosen(options.chosen))
        else:  # draws more than the sample, since some do not compile
            print(f"seed {options.seed}", flush=True)
            mutants = list(itertools.islice(draw(layers, random_, build), options.sample * 4 // 3))
        for number, mutant in enumerate(mutants, 1):
            mutant.number = number
            if options.list:
                print(mutant.text())
        if options.list:
            return 0
        checks, batches, needed = checks_of(build.build), {}, set()
        for asked in {mutant.checks for mutant in mutants}:
            named = [check for check in checks if fnmatch.fnmatch(check.name, asked)]
            batches[asked] = list(batches_of(named))
            of = {program for check in named for program in (PROGRAMS if check.script else [check.program])}
            needed |= of
            for mutant in mutants:
                if mutant.checks == asked and len(of) == 1:
                    mutant.program, = of
        programs = build.plant(mutants, [program for program in PROGRAMS if program in needed], pool)
        compiled, sound = [mutant for mutant in mutants if mutant.compiles], set()
        print(f"{len(compiled)} of {len(mutants)} errors compile; {len(checks)} checks: {spent()}", flush=True)

        def judged(mutant):
            if time.monotonic() - start > 60 * options.minutes:
                return False
            judge(mutant, batches[mutant.checks], programs, math.inf if options.chosen else options.limit, sound)
            how = f"noticed by {mutant.by}" if mutant.by else f"SURVIVED {mutant.tried} checks"
            print(f"{how}: {mutant.text()}   ({mutant.seconds:.0f} s)", flush=True)
            return True
        asked = mutants if options.chosen else compiled[:options.sample]
        judged = [mutant for mutant, done in zip(asked, pool.map(judged, asked)) if done]
    if options.chosen:
        noticed = sum(mutant.by is not None for mutant in asked)
        print(f"noticed: {noticed} of {len(asked)}: {spent()}")
        return 0 if noticed == len(asked) else 1
    for layer in layers:
        of_layer = [mutant for mutant in judged if mutant.layer == layer]
        seen = sum(m.by is not None for m in of_layer)
        if of_layer:
            print(f"{layer:22} {seen:3} of {len(of_layer):3} ({interval(seen, len(of_layer))})")
    if not judged:
        sys.exit("mutate: not a single one was judged")
    n, noticed = len(judged), sum(mutant.by is not None for mutant in judged)
    print(f"noticed: {noticed} of {n} ({noticed / n:.0%}, {interval(noticed, n)}); of {options.sample} that were asked for {n} were judged: {spent()}. So few or "
          f"fewer have a chance of {chance(noticed, n, options.goal):.3g} where {options.goal:.0%} of all errors are noticed; below "
          f"{CHANCE} this fails")
    if chance(noticed, n, options.goal) < CHANCE:
        return 1
    if chance(n * 2 // 5, n, options.goal) >= CHANCE:
        print(f"TOO FEW JUDGED: of {n} two fifths could be noticed, and this would not fail")
        return 77
    return 0


if __name__ == "__main__":
    sys.exit(main())
