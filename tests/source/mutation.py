#!/usr/bin/env python3
"""Shows that truths and tests notice: plants small errors in a copy of the sources, rebuilds what
they touch, and expects `taut verify` on the named truths, or the named tests, to turn red. What
survives its mutation is decoration.

Usage: mutation.py BUILD_DIR [NAME...]     BUILD_DIR: a Ninja build of this tree with `taut` and
                                           `tests/taut_tests` in it
"""
import concurrent.futures
import json
import os
import pathlib
import shlex
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent

# name: (file, what is there, what is planted, unit to recompile, truths that must break)
MUTATIONS = {
    "exact projection": ("core/solver/simd/distance.hpp", "return (length - rest) / length;",
                         "return (length + rest) / length;", "core/solver/constraints/relaxation.cpp",
                         ["exact-projection"]),
    "sqrt-free projection": ("core/solver/simd/distance.hpp", "/ (length2 + rest2);", "/ (length2 - rest2);",
                             "core/solver/constraints/relaxation.cpp", ["sqrt-free-projection"]),
    "shares": ("core/solver/simd/distance.hpp", "f2 = share2 * f", "f2 = share1 * f",
               "core/solver/constraints/relaxation.cpp", ["mass-weighted"]),
    "integrator": ("core/solver/jakobsen.cpp", "* dt * dt : 0", "/ dt * dt : 0",
                   "core/solver/jakobsen.cpp", ["free-fall"]),
    "damping": ("core/solver/jakobsen.cpp", "std::exp(-damping_ * dt)", "std::exp(+damping_ * dt)",
                "core/solver/jakobsen.cpp", ["damping-factor"]),
    "wind law": ("core/model/wind.hpp", "/ (6 * norm)", "/ (3 * norm)", "core/solver/jakobsen.cpp",
                 ["wind-face"]),
    "springs": ("core/solver/mass_spring.cpp", "(length - static_cast<Real>(l.rest))",
                "(length + static_cast<Real>(l.rest))", "core/solver/mass_spring.cpp",
                ["hooke-oscillator"]),
    "compliance": ("core/solver/xpbd.cpp", "c.compliance / (h * h)", "c.compliance * (h * h)",
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


SIMD = ["core/solver/simd/instruction_set.cpp"]  # four times
RESPONSES = ["core/solver/contact/responses.cpp"]
CLAIMS = [f"experiments/report/claims/{name}.cpp" for name in ("claim", "cost_claims", "physics_claims", "difference_claims")]
SEARCH = ["tests/solver/contact/self_collision_test.cpp"]  # which instantiates the templates itself

# name: (file, what is there, what is planted, units to recompile, tests that must break)
TESTED = {
    "contact pushes what is outside": (
        "core/solver/simd/contact.hpp", "where && depth > T(0)", "where && depth < T(0)", SIMD,
        "Contact.*"),
    "friction pushes on": ("core/solver/simd/contact.hpp", "out = out - select(sticks",
                           "out = out + select(sticks", SIMD, "Contact.*"),
    "friction without bound": ("core/solver/simd/contact.hpp", "sticks = length <= most",
                               "sticks = length >= T(0)", SIMD, "Contact.*"),
    "continuous test off": ("core/solver/simd/contact.hpp", "near && !surface.misses(from, x)",
                       "near && surface.misses(from, x)", SIMD, "Contact.*"),
    "a row of cells forgotten": (
        "core/solver/simd/neighbour_search_impl.hpp", "q.layer, q.layer + q.row}", "q.layer}", SIMD,
        "NeighbourGrid.*"),
    "pairs of one cell skipped": ("core/solver/simd/neighbour_search_impl.hpp", "m = k + 1; m < next_end",
                                  "m = end; m < next_end", SIMD, "NeighbourGrid.*"),
    "the next cell in x skipped": ("core/solver/simd/neighbour_search_impl.hpp",
                                   "return q.starts[bucket + 2]", "return q.starts[bucket + 1]",
                                   SIMD, "NeighbourGrid.*"),
    "lanes beyond a run count": ("core/solver/simd/neighbour_search_impl.hpp",
                                 "(1u << (count < width ? count : width)) - 1",
                                 "(1u << width) - 1 + 0 * count", SIMD, "NeighbourGrid.*"),
    "own way ignored": ("core/solver/simd/neighbour_search_impl.hpp", "more * more < T(4.0)",
                        "more * more < T(0.0)", SIMD, "NeighbourGrid.*"),
    "close at rest searched": ("core/solver/simd/neighbour_search_impl.hpp", ">= ignored2", ">= T(0.0)",
                               SIMD, "NeighbourGrid.*"),
    "a grid too narrow": ("core/solver/contact/neighbour_grid.hpp", "cells[3] = {8, 8, 8}",
                           "cells[3] = {2, 8, 32}", SEARCH, "NeighbourGrid.*"),
    "reach too small": ("core/solver/contact/self_collision.hpp",
                        "std::min(2 * motion, 4 * diameter_)", "0 * motion", RESPONSES,
                        "SelfCollision.*"),
    "searched too seldom": ("core/solver/contact/self_collision.hpp", "search, skin_ / 4)",
                            "search, 5 * skin_)", RESPONSES, "SelfCollision.*"),
    "skin too small": ("core/solver/contact/self_collision.hpp", "reach = diameter_ + skin_",
                       "reach = diameter_ + skin_ / 8", RESPONSES, "SelfCollision.*"),
    "those that have passed stay": ("core/solver/contact/self_collision.hpp",
                                    "dot(now, pair.before) < 0", "dot(now, pair.before) > 0",
                                    RESPONSES, "SelfCollision.*"),
    "neighbours fight at rest": ("core/solver/contact/self_collision.hpp",
                                 "std::min(distance, diameter_)", "diameter_", RESPONSES,
                                 "SelfCollision.*"),
    "the lighter one stays": ("core/solver/contact/self_collision.hpp", "wa / (wa + wb)",
                              "wb / (wa + wb)", RESPONSES, "SelfCollision.*"),
    "last second for peak": ("experiments/report/claims/physics_claims.cpp", "metric(value->name);",
                             'metric(value->name == "penetration.peak" ? "penetration.max" : value->name);',
                             CLAIMS, "Claims.*"),
    "vertices for faces": ("experiments/report/claims/physics_claims.cpp", "metric(value->name);",
                           'metric(value->name == "face.peak" ? "penetration.peak" : value->name);',
                           CLAIMS, "Claims.*"),
    "mean over failures": ("experiments/report/claims/claim.cpp", "completed(r.status) && std::isfinite(value)",
                           "std::isfinite(value)", CLAIMS, "Claims.*"),
    "a failure not counted": ("experiments/report/claims/physics_claims.cpp",
                              "if (completed(r->status) || r->status", "if (true || r->status", CLAIMS,
                              "Claims.*"),
    "a failed step skipped": ("experiments/report/claims/physics_claims.cpp",
                              "return completed(r->status); })) break;",
                              "return completed(r->status); })) continue;", CLAIMS, "Claims.*"),
    "tethers among what both have": ("experiments/report/claims/cost_claims.cpp",
                                     "theirs : ours).empty()", "theirs : ours).size() < 9", CLAIMS,
                                     "Claims.*"),
    "wrong count of a status": ("experiments/report/claims/physics_claims.cpp", "++failures, ++failed[",
                                "++failures, failed[\"x\"]++, ++failed[", CLAIMS, "Claims.*"),
    "largest for mean of stable steps": ("experiments/report/claims/physics_claims.cpp", "geometric_mean(found[i])",
                                         "found[i].back()", CLAIMS, "Claims.*"),
    "noise ignored": ("experiments/timing/statistics.cpp", "change <= std::log1p(noise)", "false",
                      ["experiments/timing/statistics.cpp"], "Claims.*"),
    "a thousandth is a difference": ("experiments/timing/statistics.cpp", "change <= std::log1p(tolerance)",
                                     "change <= 0", ["experiments/timing/statistics.cpp"], "Recommendation.*"),
}


def compile_commands(build, unit):
    """How `unit` is compiled: by itself, perhaps several times, or in a batch of files."""
    commands = []
    for entry in json.loads((build / "compile_commands.json").read_text()):
        file = pathlib.Path(entry["file"])
        if file == ROOT / unit or "Unity" in file.parts and f'"{ROOT / unit}"' in file.read_text():
            commands.append([word for word in shlex.split(entry["command"]) if word != "-Werror"])  # may be odd
    return commands or sys.exit(f"mutation: {unit} is not in {build}/compile_commands.json")


def link_command(build, target):
    lines = subprocess.run(["ninja", "-t", "commands", target], cwd=build, check=True,
                           capture_output=True, text=True).stdout.splitlines()
    link = next(line for line in reversed(lines) if f"-o {target} " in line)
    return shlex.split(link.removeprefix(": && ").split(" && ")[0])


def plant(build, folder, name, mutation, target):
    """`target` with the error in it."""
    file, there, planted, units = mutation[:4]
    text = (ROOT / file).read_text()
    if text.count(there) < 1:
        sys.exit(f"mutation '{name}': {file} no longer contains {there!r}")
    copy = folder / name.replace(" ", "-")
    (copy / file).parent.mkdir(parents=True)
    (copy / file).write_text(text.replace(there, planted))
    mutants = []
    for unit, command in ((unit, command) for unit in units for command in compile_commands(build, unit)):
        mutants.append(str(copy / f"{pathlib.Path(unit).stem}{len(mutants)}.o"))
        command[command.index("-o") + 1] = mutants[-1]
        command[command.index("-c") + 1] = str(copy / unit if unit == file else ROOT / unit)
        first = next(i for i, word in enumerate(command) if word.startswith("-I"))
        command.insert(first, f"-I{copy}")  # the planted file comes before the true one
        subprocess.run(command, cwd=build, check=True)
    link = link_command(build, target)
    program = copy / pathlib.Path(target).name
    link[link.index("-o") + 1] = str(program)
    # Of two definitions the first is taken: the unit's own may stand in a batch with others.
    link[1:1] = ["-Wl,--allow-multiple-definition", *mutants]
    subprocess.run(link, cwd=build, check=True)
    return program


def noticed(build, folder, name):
    """True if the truths or tests turned red."""
    if name in TESTED:
        program = plant(build, folder, name, TESTED[name], "tests/taut_tests")
        test = subprocess.run([program, f"--gtest_filter={TESTED[name][4]}", "--gtest_brief=1"],
                              capture_output=True, text=True)
        return test.returncode == 1 and "FAILED" in test.stdout
    file, there, planted, unit, truths = MUTATIONS[name]
    program = plant(build, folder, name, (file, there, planted, [unit]), "taut")
    verify = subprocess.run([program, "verify", "-j1", *truths], capture_output=True, text=True)
    return verify.returncode == 1 and " broken " in verify.stderr + " "


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    build = pathlib.Path(sys.argv[1]).resolve()
    every = sorted({truth for mutation in MUTATIONS.values() for truth in mutation[4]})
    sound = subprocess.run([build / "taut", "verify", "-j1", *every], capture_output=True, text=True)
    if sound.returncode != 0:
        sys.exit("mutation: the truths are red without any mutation\n" + sound.stdout)
    filters = ":".join(sorted({mutation[4] for mutation in TESTED.values()}))
    sound = subprocess.run([build / "tests/taut_tests", f"--gtest_filter={filters}",
                            "--gtest_brief=1"], capture_output=True, text=True)
    if sound.returncode != 0:
        sys.exit("mutation: the tests are red without any mutation\n" + sound.stdout)
    survivors = []
    with tempfile.TemporaryDirectory() as folder:
        planted = {**MUTATIONS, **TESTED}
        names = sys.argv[2:] or list(planted)
        pool = concurrent.futures.ThreadPoolExecutor(os.cpu_count())
        for name, red in zip(names, pool.map(lambda n: noticed(build, pathlib.Path(folder), n), names)):
            print(f"{'noticed ' if red else 'SURVIVED'}  {name}: {planted[name][1]}  ->  "
                  f"{planted[name][2]}", flush=True)
            if not red:
                survivors.append(name)
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main())
