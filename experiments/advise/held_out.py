#!/usr/bin/env python3
"""Do the winners of the map win on scenes that the search never saw?

    experiments/advise/held_out.py PROGRAM [--base BENCH.json] [--seeds 1-20|1,5,9] [--references FOLDER [--only-references]]

Each seed draws a scene of one of the trade's kinds: grid, step, tilt, bending, damping, body. PROGRAM (taut) makes its reference, and
times the setting of every solver that is cheapest for an error on the kind's own scene: `taut bench trade --preset quick --json`, or the
file given by --base. References take most of the time and no quiet machine: --only-references makes them alone, in FOLDER, where a later run
finds them. Prints Markdown. Scenes and settings are those of the seeds and of the searched study; both are fixed by the commit.
"""
import argparse
import collections
import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
KINDS = {"swing": "swing:links.shear=false", "drape-swing": "drape-swing", "push": "push", "rail": "rail"}


def drawn(seed):
    """(kind, settings) of a seed"""
    draw = random.Random(seed)
    between = lambda low, high: f"{low + (high - low) * draw.random():.3g}"  # noqa: E731
    power = lambda low, high: f"{10 ** (low + (high - low) * draw.random()):.2g}"  # noqa: E731
    kind = list(KINDS)[(seed - 1) % len(KINDS)]
    n, other = (14 + int(30 * draw.random()) for _ in range(2))
    step = f'time.dt="1/{[60, 64, 90, 120][int(4 * draw.random())]}"'
    if kind == "swing":
        return kind, [f"cloth.grid=[{n},{other}]", f"cloth.size=[1.0,{between(0.6, 1.4)}]", f"cloth.tilt={between(20, 70)}", "links.shear=false", step]
    if kind == "drape-swing":
        return kind, [f"cloth.grid=[{n},{n}]", f"cloth.span={between(0.6, 0.9)}", f"cloth.tilt={between(5, 35)}", f"bending.stiffness={power(-4.5, -3.5)}",
                      f"forces.damping={between(0.3, 1)}", step]
    if kind == "push":
        return kind, [f"cloth.grid=[{n},{n}]", f"collider.0.radius={between(0.12, 0.22)}", f"collider.0.velocity=[0,0,{between(0.25, 0.5)}]",
                      f"collider.0.friction={between(0, 0.6)}", step]
    return kind, [f"cloth.grid=[{n // 2 + 2},{n}]", f"collider.0.radius={between(0.07, 0.14)}", f"collider.0.friction={between(0, 0.6)}",
                  f"bending.stiffness={power(-3.5, -2.5)}", step]


class Taut:
    """The program, with a folder of references of its own"""

    def __init__(self, program, folder, references):
        self.program, self.folder = program, folder
        (folder / "experiments").symlink_to(ROOT / "experiments")
        (folder / "results").mkdir()
        (references or folder).mkdir(parents=True, exist_ok=True)
        self.references = folder / "results" / "references"
        self.references.symlink_to(references.resolve() if references else folder)
        self.environment = os.environ | {"TAUT_DATA": str(folder / "experiments")}

    def run(self, *arguments):
        done = subprocess.run([self.program, *map(str, arguments)], cwd=self.folder, env=self.environment, text=True, capture_output=True)
        return done.stdout, done.stderr

    def make_reference(self, seed, kind, sets):
        made = self.references / f"seed-{seed}.txt"
        if not made.exists():
            out, err = self.run("reference", kind, *sets, "-o", self.references)
            made.write_text(out + err)

    def recommended(self, *arguments):
        """[target] {solver: (setting, CPU seconds a simulated second)} of each scene of a bench, the cheapest first"""
        out, err = self.run("bench", *arguments, "--json")
        if not out:
            sys.exit(f"taut bench {' '.join(map(str, arguments))}: {err}")
        return recommended_in(json.loads(out))


def recommended_in(bench):
    rows = bench["tables"]["recommended"]["rows"]
    found = collections.defaultdict(dict)
    for scene, target, solver, setting, _, cost, *_ in rows:
        if setting and "<=" in target:
            found[scene, target][solver] = text_of(setting), cost[1] if isinstance(cost, list) else cost
    return {at: dict(sorted(some.items(), key=lambda one: one[1][1])) for at, some in found.items()}


def text_of(cell):
    return cell["text"] if isinstance(cell, dict) else cell


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--base", type=pathlib.Path)
    parser.add_argument("--seeds", default="1-20")
    parser.add_argument("--references", type=pathlib.Path)
    parser.add_argument("--only-references", action="store_true")
    options = parser.parse_args()
    ends = [[int(n) for n in part.split("-")] for part in options.seeds.split(",")]
    seeds = [seed for part in ends for seed in range(part[0], part[-1] + 1)]
    program = options.program.resolve()
    with tempfile.TemporaryDirectory() as folder:
        taut = Taut(program, pathlib.Path(folder), options.references)
        base = {} if options.only_references else recommended_in(json.loads(options.base.read_text())) if options.base else taut.recommended("trade", "--preset", "quick")
        judged, unjudged, losses = [], [], []
        for seed in seeds:
            kind, settings = drawn(seed)
            sets = [word for one in settings for word in ("--set", one)]
            print(f"seed {seed}: {kind}", file=sys.stderr, flush=True)
            taut.make_reference(seed, kind, sets)
            if options.only_references:
                continue
            of_kind = {target: some for (scene, target), some in base.items() if scene.split(":")[0] == kind}
            solvers = sorted({setting for some in of_kind.values() for setting, _ in some.values()})
            study = taut.folder / f"seed-{seed}.toml"
            study.write_text(f'question = "Who is cheapest on a scene that no search saw?"\nscenes = ["{kind}"]\n'
                             f"set = {json.dumps(settings)}\nsolvers = {json.dumps(solvers)}\n")
            here = {target: some for (_, target), some in taut.recommended(f"./{study.name}").items()}
            here = {target: some for target, some in here.items() if target.startswith("motion.error") and target in of_kind}
            if not here:
                unjudged.append((seed, kind, settings))
            for target, some in here.items():
                winner, (setting, _) = next(iter(of_kind[target].items()))
                best, (_, least) = next(iter(some.items()))
                judged.append((kind, winner, winner == best, winner in some))
                if winner != best:
                    losses.append((seed, kind, target, winner, f"{some[winner][1] / least:.2f} times" if winner in some else "misses the error", best,
                                   " ".join(settings)))
    if not options.only_references:
        tell(judged, unjudged, losses)


def tell(judged, unjudged, losses):
    won = sum(one[2] for one in judged)
    print(f"In {won} of {len(judged)} cells (a scene and an error) the map's winner is the cheapest.\n")
    print("| kind | map's winner | cells | is the cheapest | reaches the error |\n|---|---|---|---|---|")
    for (kind, winner), some in sorted(collections.Counter((one[0], one[1]) for one in judged).items()):
        of = [one for one in judged if one[:2] == (kind, winner)]
        print(f"| {kind} | {winner} | {some} | {sum(one[2] for one in of)} | {sum(one[3] for one in of)} |")
    print("\nEvery loss:\n\n| seed | kind | error | map's winner | its cost | cheapest | settings |\n|---|---|---|---|---|---|---|")
    for row in losses:
        print("| " + " | ".join(str(cell).replace("|", "\\|") for cell in row) + " |")
    if unjudged:
        print("\nNot judged, since no setting reaches an error or references of the motion do not agree: " +
              "; ".join(f"seed {seed}, {kind}, {' '.join(settings)}" for seed, kind, settings in unjudged) + ".")


if __name__ == "__main__":
    main()
