#!/usr/bin/env python3
"""Plants random small errors in copies of single files and shows which of them no test notices.

Usage: mutate.py BUILD FOLDER [--sample N] [--minutes M] [--seed S] [--layer L]... [--goal SHARE] [--widest N] [--limit SECONDS]
                        [--planted FILE] [--jobs N] [--list]

1. BUILD is a Ninja build of this tree. The layers are built once more in FOLDER, file by file and at -O1, so that one error
   costs one object and a link; every block of code calls tests/source/executed.c. All else is taken from BUILD.
2. Every check runs once, alone; a check is a unit test, a truth of `taut verify` or a test of the command line. So it is
   known which checks run which block, and how long each takes. This is kept in FOLDER until a layer or the test's own
   file changes.
3. N places are drawn: layers in turn, then an operator (arithmetic, comparison, logic, a constant off by little or by
   much, a sign, an axis, min for max, a removed statement, swapped arguments), then a place. What does not compile, or
   compiles to the same code, is drawn again. The same seed plants the same errors in the same sources.
4. For each error the checks that run its line, those in the layer's own folder of tests first, quick ones before slow
   ones, until one is red or those tried take --limit seconds of CPU. A check also notices if it takes four times the
   CPU time that it took before.

Survivors are printed as a difference. Those that change no result are listed in equivalent_mutants.txt with the reason,
and are not drawn. Files on which more than --widest objects depend are left out, and counted: --sample 1000 --widest 999
is the long run. --planted plants the errors of a file in the same format instead. The aim is 92 % noticed, no layer below
85 %; --goal is the share below which the run fails, by more than chance: two standard deviations of a sample of this size.
The tests ask for 0.85: of 45 errors of three fresh samples (seeds 424242, 917301 and 551001) 41 were noticed, which is too few
to show 0.92.
"""
import argparse
import bisect
import concurrent.futures
import contextlib
import hashlib
import itertools
import json
import math
import os
import pathlib
import pickle
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

sys.dont_write_bytecode = True
from mutation_checks import ROOT, TAUT, UNIT, checks_of, run  # noqa: E402
from mutation_operators import sites  # noqa: E402

EQUIVALENT = pathlib.Path(__file__).with_name("equivalent_mutants.txt")
EXECUTED = pathlib.Path(__file__).with_name("executed.c")

# Layers and their libraries; the tests of each are in the folder of tests/ with its last name.
LAYERS = {"core/model": "taut_model", "core/io": "taut_io", "core/solver": "taut_solver", "core/reference": "taut_reference",
          "bullet_ref": "taut_bullet64", **{f"experiments/{name}": f"taut_{name}" for name in (
              "system", "metrics", "case", "external", "study", "timing", "require", "baseline", "truths",
              "report", "render")}}
LEFT_OUT = re.compile(r"/(gl|font|shaders)\.[ch]pp$")  # no numbers in them


class Build:
    """The objects of the layers in a folder, and how BUILD links programs with them."""

    def __init__(self, ordinary, folder):
        self.ordinary, self.folder = ordinary, folder
        self.end = folder / "executed.o"
        if not (folder / "build.ninja").exists():
            folder.mkdir(parents=True, exist_ok=True)
            subprocess.run(["cmake", "-G", "Ninja", "-S", ROOT, "-B", folder, "-DCMAKE_BUILD_TYPE=Debug", "-DTAUT_TESTS=OFF",
                            "-DTAUT_BATCH_SIZE=1", "-DCMAKE_CXX_FLAGS_DEBUG=-O1 -g1 -gno-column-info -fsanitize-coverage=trace-pc"],
                           check=True, stdout=subprocess.DEVNULL)
        subprocess.run(["cc", "-O2", "-c", EXECUTED, "-o", self.end], check=True)
        for where, targets in (folder, LAYERS.values()), (ordinary, (TAUT, pathlib.Path(UNIT).name)):
            subprocess.run(["cmake", "--build", where, "--target", *targets], check=True, stdout=subprocess.DEVNULL)
        self.own = [word for library in LAYERS.values()
                    for word in self.ninja(folder, "-t", "query", f"lib{library}.a").split("outputs:")[0].split()
                    if word.endswith(".o") and "registry" not in word]
        self.command = {}
        for entry in json.loads((folder / "compile_commands.json").read_text()):
            words = shlex.split(re.sub(r" -Werror\b| -MD -MT \S+ -MF \S+", "", entry["command"]))
            self.command[os.path.normpath(words[words.index("-o") + 1])] = words
        linker = next((f"-fuse-ld={name}" for name in ("lld", "gold") if shutil.which(f"ld.{name}")), "-fuse-ld=bfd")
        self.link_command = {}
        self.beside(folder / "programs")
        for program in (UNIT, TAUT):
            lines = [line for line in self.ninja(ordinary, "-t", "commands", program).splitlines() if f"-o {program} " in line]
            words = shlex.split(lines[-1].removeprefix(": && ").split(" && ")[0])
            self.link_command[program] = [words[0], linker, "-Wl,--strip-debug", *words[1:], str(self.end)]
            if not self.link(program, {}, self.program(program)):
                sys.exit(f"mutate: {program} cannot be linked")
        self.dependents = {}
        current = None
        for line in self.ninja(folder, "-t", "deps").splitlines():
            if line and not line[0].isspace():
                current = os.path.normpath(line.split(":")[0])
            elif line.strip():
                path = os.path.normpath(os.path.join(folder, line.strip()))
                self.dependents.setdefault(path, set()).add(current)

    def program(self, program):
        """Where the program without any error is."""
        return self.folder / "programs" / pathlib.Path(program).name

    def beside(self, folder):
        """A folder with all that BUILD holds but the programs with errors: these are linked into it."""
        folder.mkdir(exist_ok=True)
        for entry in self.ordinary.iterdir():
            if entry.name not in (TAUT, "mutants") and not (folder / entry.name).is_symlink():
                (folder / entry.name).symlink_to(entry)
        return folder

    @staticmethod
    def ninja(where, *words):
        return subprocess.run(["ninja", *words], cwd=where, check=True, text=True, capture_output=True).stdout

    def objects(self, file):
        """Those of the layers that depend on a source file."""
        return sorted(self.dependents.get(str(ROOT / file), set()).intersection(self.own))

    def compile(self, target, out, changed):
        """The object `out`, with the files of a folder in the place of the tree's; False if it does not compile."""
        words = list(self.command[target])
        words[words.index("-o") + 1] = str(out)
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
        words += [f"-fmacro-prefix-map={copy.parent}={source.parent}", f"-fmacro-prefix-map={changed}={ROOT}"]
        return subprocess.run(words, cwd=self.folder, capture_output=True).returncode == 0

    def link(self, program, objects, out):
        """The program with some objects in the place of its own; False if it does not link."""
        words = list(self.link_command[program])
        words[words.index("-o") + 1] = str(out)
        # In front of BUILD's libraries, which then have nothing left to give.
        words[3:3] = [str(objects.get(target, self.folder / target)) for target in self.own]
        return subprocess.run(words, cwd=self.ordinary, capture_output=True).returncode == 0


def code(object_, out):
    """What an object file holds besides its line numbers."""
    subprocess.run(["objcopy", "--strip-debug", object_, out], check=True)
    return out.read_bytes()


class Coverage:
    """Which check runs which line, and how long each check takes."""

    def __init__(self, build, checks, pool):
        self.build, self.lines, self.lock = build, {}, threading.Lock()
        self.functions = {program: self.functions_of(program) for program in build.link_command}
        layers = hashlib.sha256(b"".join((build.folder / target).read_bytes() for target in build.own)).digest()
        kept, of, known = build.folder / "executed.pickle", None, {}
        with contextlib.suppress(OSError, EOFError):
            with open(kept, "rb") as file:
                of, self.runs, known = pickle.load(file)
        if of != layers:
            # (function, offset) of a block -> a bit for each check.
            self.runs, known = {program: {} for program in build.link_command}, {}
        self.bit, new = {}, []
        unused = itertools.count(1 + max((bit for _, bit, _, _ in known.values()), default=-1))
        for check in checks:
            source, self.bit[check], check.seconds, check.green = known.get(check.name, (None, 0, 0.0, True))
            if source != check.source or not check.green:
                self.bit[check] = next(unused)
                new.append(check)
        for first in range(0, len(new), 100):  # kept now and then: an interruption costs little
            some = new[first:first + 100]
            list(pool.map(self.measure, some))
            known |= {check.name: (check.source, self.bit[check], check.seconds, check.green) for check in some}
            with open(kept, "wb") as file:
                pickle.dump((layers, self.runs, known), file)

    def functions_of(self, program):
        """Places of functions, ascending; their names; where the program begins."""
        names, begin = {}, 0
        for line in subprocess.run(["nm", self.build.program(program)], check=True, text=True,
                                   capture_output=True).stdout.splitlines():
            words = line.split()
            if len(words) == 3 and words[1] in "tTwW":
                names.setdefault(int(words[0], 16), []).append(words[2])
            if words[-1] == "__executable_start":
                begin = int(words[0], 16)
        return sorted(names), names, begin

    def measure(self, check):
        with tempfile.TemporaryDirectory() as where:
            red, check.seconds = run([check], self.build.program(check.program), where, TAUT_EXECUTED=f"{where}/executed")
            check.green = red is None
            marked = pathlib.Path(f"{where}/executed.{pathlib.Path(check.program).name}")
            places, names, begin = self.functions[check.program]
            blocks = [match.start() + begin for match in re.finditer(rb"\x01", marked.read_bytes())] if marked.exists() else []
        with self.lock:
            runs = self.runs[check.program]
            for block in blocks:
                place = places[bisect.bisect_right(places, block) - 1]
                for name in names[place]:
                    runs[name, block - place] = runs.get((name, block - place), 0) | 1 << self.bit[check]

    def blocks(self, target):
        """file -> line -> (function, offset) of each block with code of this line, of an object"""
        with self.lock:
            if target in self.lines:
                return self.lines[target]
        found, function, start, line, block, first = {}, "", 0, None, None, []
        listing = subprocess.run(["objdump", "-d", "-l", "-r", "--no-show-raw-insn", self.build.folder / target], check=True,
                                 text=True, errors="replace", capture_output=True).stdout
        called = False
        for text in listing.splitlines():
            if place := re.match(r"(/.*):(\d+)( \(discriminator \d+\))?$", text):
                inside = place[1].startswith(f"{ROOT}/")
                line = (os.path.relpath(place[1], ROOT), int(place[2])) if inside else None
            elif text.endswith(">:"):
                function, start = text.split("<")[1][:-2], int(text.split()[0], 16)
                line, block, first = None, None, []
            elif text.endswith("__sanitizer_cov_trace_pc-0x4"):
                called = True
            elif re.match(r" +[0-9a-f]+:\t", text):
                if called:
                    called, block = False, (function, int(text.split(":")[0], 16) - start)
                    if first is not None:  # what stands in front of the first call
                        for before in first:
                            found.setdefault(before, set()).add(block)
                        first = None
                if line and block is None:
                    first.append(line)
                elif line:
                    found.setdefault(line, set()).add(block)
        files = {}
        for (file, number), blocks in found.items():
            files.setdefault(file, {})[number] = blocks
        with self.lock:
            self.lines[target] = files
        return files

    def checks(self, targets, file, number):
        """Bits of the checks that run a line. Where it has no code (a constant), or none runs it, as when global objects
        are made: of those that run anything of the file."""
        def running(of_line):
            bits = 0
            for target in targets:
                for line, blocks in self.blocks(target).get(file, {}).items():
                    for block in blocks if of_line(line) else ():
                        for runs in self.runs.values():
                            bits |= runs.get(block, 0)
            return bits
        return running(lambda line: line == number) or running(lambda line: True)


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
        self.by, self.tried, self.running, self.seconds = None, 0, 0, 0.0

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
            if not build.compile(target, out, folder / "tree"):
                return False
            if code(out, folder / "new") != code(build.folder / target, folder / "old"):
                self.objects[target] = out
        return bool(self.objects)

    def judge(self, build, folder, checks, coverage, limit):
        """Sets by whom it is noticed, and what that took. False if it does not link."""
        own, programs = self.layer.split("/")[-1], {}
        bits = coverage.checks(self.objects, self.file, self.number)
        running = sorted((check for check in checks if bits >> coverage.bit[check] & 1 and check.green),
                         key=lambda c: (c.folder != own, c.seconds))
        self.running = len(running)
        while running and self.seconds < limit:
            # Quick ones of a program go into one process.
            batch = [running[0]]
            for check in running[1:]:
                alike = (check.program, check.script) == (batch[0].program, batch[0].script)
                if alike and sum(c.seconds for c in batch) + check.seconds < 2:
                    batch.append(check)
            running = [check for check in running if check not in batch]
            program = batch[0].program
            if program not in programs:
                programs[program] = build.beside(folder / "programs") / pathlib.Path(program).name
                if not build.link(program, self.objects, programs[program]):
                    return False
            with tempfile.TemporaryDirectory(dir=folder) as where:
                self.by, seconds = run(batch, programs[program], where, 5 + 4 * sum(check.seconds for check in batch))
            self.tried, self.seconds = self.tried + len(batch), self.seconds + seconds
            if self.by:
                break
        return True


def written(file):
    """Every mutant that a file states: lines `file | line as it is | line with the error | reason`"""
    for line in file.read_text().splitlines():
        if line and not line.startswith("#"):
            name, was, planted, *_ = (part.strip() for part in line.split(" | "))
            lines = [text.strip() for text in (ROOT / name).read_text().splitlines()]
            layer = max((layer for layer in LAYERS if name.startswith(layer)), key=len, default=name)
            if was not in lines:
                print(f"{name} no longer contains: {was}", flush=True)
                continue
            yield Mutant(layer, name, lines.index(was) + 1, planted)


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


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--sample", type=int, default=60)
    parser.add_argument("--minutes", type=float, default=1e9, help="judge no more errors after this time")
    parser.add_argument("--seed", type=int, default=int(time.time()))
    parser.add_argument("--layer", action="append", choices=list(LAYERS))
    parser.add_argument("--goal", type=float, default=0.92, help="least share noticed")
    parser.add_argument("--widest", type=int, default=4)
    parser.add_argument("--limit", type=float, default=60, help="CPU seconds of checks for an error")
    parser.add_argument("--planted", type=pathlib.Path, help="errors to plant, written as in equivalent_mutants.txt")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--list", action="store_true", help="only print what would be planted")
    options = parser.parse_args()
    # Ignored where this runs in the background; what it runs would inherit that.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    build = Build(options.build.resolve(), options.folder.resolve())
    layers = options.layer or list(LAYERS)
    mutants = written(options.planted) if options.planted else draw(layers, options.seed, build, options.widest)
    if options.list:
        for mutant in itertools.islice(mutants, options.sample):
            print(mutant.text())
        return 0
    os.environ["CCACHE_DISABLE"] = "1"  # nothing of what follows is compiled twice
    start = time.monotonic()

    def spent():
        cpu = resource.getrusage(resource.RUSAGE_CHILDREN)
        return f"{time.monotonic() - start:.0f} s, {cpu.ru_utime + cpu.ru_stime:.0f} s of CPU"
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        checks = checks_of(build)
        coverage = Coverage(build, checks, pool)
        print(f"{len(checks)} checks take {sum(c.seconds for c in checks):.0f} s of CPU; red without any error: "
              f"{[check.name for check in checks if not check.green]}: {spent()}", flush=True)

        def judge(mutant):
            """Whether it was judged: it compiles to something else than without the error, and there was time."""
            if time.monotonic() - start > 60 * options.minutes:
                return False
            with tempfile.TemporaryDirectory() as where:
                if not (mutant.compile(build, pathlib.Path(where))
                        and mutant.judge(build, pathlib.Path(where), checks, coverage, options.limit)):
                    return False
            how = f"noticed by {mutant.by}" if mutant.by else f"SURVIVED {mutant.tried} of {mutant.running} checks that run it"
            print(f"{how}: {mutant.text()}   ({mutant.seconds:.0f} s)", flush=True)
            return True
        judged, drawn = [], 0
        while more := list(itertools.islice(mutants, options.sample - len(judged))):
            drawn += len(more)
            judged += [mutant for mutant, done in zip(more, pool.map(judge, more)) if done]
    for layer in dict.fromkeys(mutant.layer for mutant in judged):
        of_layer = [mutant for mutant in judged if mutant.layer == layer]
        print(f"{layer:22} {sum(m.by is not None for m in of_layer):3} of {len(of_layer):3}")
    if not judged:
        sys.exit("mutate: not a single one was judged")
    noticed = sum(mutant.by is not None for mutant in judged)
    share = noticed / len(judged)
    bar = options.goal - 2 * math.sqrt(options.goal * (1 - options.goal) / len(judged))
    print(f"noticed: {noticed} of {len(judged)} ({share:.0%}), {drawn - len(judged)} more did not compile, made no difference "
          f"or had no time: {spent()}; the goal is {options.goal:.0%}, a sample of this "
          f"size fails below {bar:.0%}")
    return 0 if share >= bar else 1


if __name__ == "__main__":
    sys.exit(main())
