#!/usr/bin/env python3
"""Shows that the truths notice: plants one-character errors in a copy of the sources, rebuilds what
they touch, and expects `taut verify` on the named truths to turn red. A truth that survives its
mutation is decoration.

Usage: mutation.py BUILD_DIR [NAME...]     BUILD_DIR: a Ninja build of this tree with `taut` in it
"""
import json
import pathlib
import shlex
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent

# name: (file, what is there, what is planted, unit to recompile, truths that must break)
MUTATIONS = {
    "exact projection": ("core/solver/distance.hpp", "return (length - rest) / length;",
                         "return (length + rest) / length;", "core/solver/relaxation.cpp",
                         ["exact-projection"]),
    "sqrt-free projection": ("core/solver/distance.hpp", "/ (length2 + rest2);", "/ (length2 - rest2);",
                             "core/solver/relaxation.cpp", ["sqrt-free-projection"]),
    "shares": ("core/solver/distance.hpp", "f2 = share2 * f", "f2 = share1 * f",
               "core/solver/relaxation.cpp", ["mass-weighted"]),
    "integrator": ("core/solver/jakobsen.cpp", "* dt * dt : 0", "/ dt * dt : 0",
                   "core/solver/jakobsen.cpp", ["free-fall"]),
    "damping": ("core/solver/jakobsen.cpp", "std::exp(-damping_ * dt)", "std::exp(+damping_ * dt)",
                "core/solver/jakobsen.cpp", ["damping-factor"]),
    "wind law": ("core/model/wind.hpp", "/ (6 * norm)", "/ (3 * norm)", "core/solver/jakobsen.cpp",
                 ["wind-face"]),
    "springs": ("core/solver/mass_spring.cpp", "(length - static_cast<Real>(l.rest))",
                "(length + static_cast<Real>(l.rest))", "core/solver/mass_spring.cpp",
                ["hooke-oscillator"]),
    "compliance": ("core/solver/xpbd.cpp", "rod.compliance / (h * h)", "rod.compliance * (h * h)",
                   "core/solver/xpbd.cpp", ["xpbd-spring"]),
    "metric strain": ("experiments/metrics/stretch.cpp", ".norm() - l.rest) / l.rest",
                      ".norm() + l.rest) / l.rest", "experiments/metrics/stretch.cpp",
                      ["metric-stretch"]),
    "metric depth": ("experiments/metrics/penetration.cpp", "any.add(-distance)",
                     "any.add(+distance)", "experiments/metrics/penetration.cpp",
                     ["metric-penetration"]),
    "metric energy": ("experiments/metrics/energy.cpp", "potential -= mass_", "potential += mass_",
                      "experiments/metrics/energy.cpp", ["metric-energy"]),
}


def compile_command(build, unit):
    """How `unit` is compiled, by itself or in a batch of files (TAUT_UNITY)."""
    for entry in json.loads((build / "compile_commands.json").read_text()):
        file = pathlib.Path(entry["file"])
        if file == ROOT / unit or "Unity" in file.parts and f'"{ROOT / unit}"' in file.read_text():
            return shlex.split(entry["command"])
    sys.exit(f"mutation: {unit} is not in {build}/compile_commands.json")


def link_command(build):
    lines = subprocess.run(["ninja", "-t", "commands", "taut"], cwd=build, check=True,
                           capture_output=True, text=True).stdout.splitlines()
    line = lines[-1].removeprefix(": && ").removesuffix(" && :")
    return shlex.split(line)


def mutate(build, folder, name):
    """True if the truths noticed."""
    file, there, planted, unit, truths = MUTATIONS[name]
    text = (ROOT / file).read_text()
    if text.count(there) < 1:
        sys.exit(f"mutation '{name}': {file} no longer contains {there!r}")
    copy = folder / name.replace(" ", "-")
    (copy / file).parent.mkdir(parents=True)
    (copy / file).write_text(text.replace(there, planted))
    command = [word for word in compile_command(build, unit) if word != "-Werror"]  # it may be odd
    command[command.index("-o") + 1] = str(copy / "mutant.o")
    command[command.index("-c") + 1] = str(copy / unit if unit == file else ROOT / unit)
    first = next(i for i, word in enumerate(command) if word.startswith("-I"))
    command.insert(first, f"-I{copy}")  # the planted file comes before the true one
    subprocess.run(command, cwd=build, check=True)
    link = link_command(build)
    link[link.index("-o") + 1] = str(copy / "taut")
    # Of two definitions the first is taken: the unit's own may stand in a batch with others.
    link[1:1] = ["-Wl,--allow-multiple-definition", str(copy / "mutant.o")]
    subprocess.run(link, cwd=build, check=True)
    verify = subprocess.run([copy / "taut", "verify", "-j1", *truths], capture_output=True, text=True)
    return verify.returncode == 1 and " broken " in verify.stderr + " "


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    build = pathlib.Path(sys.argv[1]).resolve()
    every = sorted({truth for mutation in MUTATIONS.values() for truth in mutation[4]})
    sound = subprocess.run([build / "taut", "verify", "-j1", *every], capture_output=True, text=True)
    if sound.returncode != 0:
        sys.exit("mutation: the truths are red without any mutation\n" + sound.stdout)
    survivors = []
    with tempfile.TemporaryDirectory() as folder:
        for name in sys.argv[2:] or MUTATIONS:
            noticed = mutate(build, pathlib.Path(folder), name)
            print(f"{'noticed ' if noticed else 'SURVIVED'}  {name}: {MUTATIONS[name][1]}  ->  "
                  f"{MUTATIONS[name][2]}", flush=True)
            if not noticed:
                survivors.append(name)
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main())
