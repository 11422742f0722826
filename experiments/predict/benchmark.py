#!/usr/bin/env python3
"""taut.predict against runs: scenes by their seeds (taut new scene), a setting of each solver in each, and the ratio of the two strains.

    ./taut python experiments/predict/benchmark.py [--scenes N] [--seed FIRST | --commit HASH]

Prints Markdown. --commit takes the seeds from a commit's hash, which nobody can choose: the code of the prediction was fixed before.
"""
import argparse
import collections
import hashlib
import pathlib
import random
import statistics
import subprocess
import tempfile
import time

import taut

ROOT = pathlib.Path(__file__).resolve().parents[2]
FROZEN = ["core/reference/resting_springs.*", "core/reference/strain_at_rest.*", "experiments/predict/prediction.*", "experiments/predict/benchmark.py"]
SOLVERS = "jakobsen", "xpbd", "vbd"
WORK = 1e8  # links times sweeps of a whole run, at most


def digest():
    """SHA-256 of the sources of the prediction and of this benchmark"""
    files = sorted(file for pattern in FROZEN for file in ROOT.glob(pattern) if file.is_file())
    return hashlib.sha256(b"".join(str(file.relative_to(ROOT)).encode() + b"\0" + file.read_bytes() for file in files)).hexdigest()


def setting(draw, name, cloth):
    """(text, order) of a solver with sweeps and substeps that take at most WORK"""
    sweeps, substeps = round(10 ** (1.7 * draw.random())), round(10 ** draw.random())
    most = WORK / (len(cloth.links) * cloth.steps * (5 if name == "vbd" else 1))
    substeps = max(1, min(substeps, int(most)))
    sweeps = max(1, min(sweeps, int(most / substeps)))
    one_of = lambda *values: values[int(draw.random() * len(values))]  # noqa: E731
    text = f"{name}:iterations={sweeps},substeps={substeps},precision=double"
    order = "by vertex" if name == "vbd" else one_of("coloured", "coloured", "mesh", "reversed", "jolt") if name == "jakobsen" else one_of("coloured", "mesh")
    if name == "jakobsen":
        return text + f",order={order},projection={one_of('exact', 'sqrt-free')}", order
    own = f"{10 ** (3.5 * draw.random() - 5):.2g}" if name == "xpbd" else f"{10 ** (2 + 3 * draw.random()):.2g}"
    return text + (f",order={order}" if name == "xpbd" else ",start=inertia") + "".join(f",{family}={own}" for family in ("structural", "shear", "bend")), order


def table(title, rows, groups, of):
    """A row for each group: how many, and how far predicted and run are apart"""
    off = lambda ratio: abs(ratio - 1)  # noqa: E731
    print(f"\n| {title} | settings | ratio, median | 95 % of the ratios | median error | within 5 % | within 15 % | largest stretch: ratio, median |\n"
          "|---|---|---|---|---|---|---|---|")
    for name in groups:
        some = [row for row in rows if of(row) == name]
        if not some:
            continue
        ratios = sorted(row["ratio"] for row in some)
        left_out = int(0.025 * len(ratios))
        print(f"| {name} | {len(some)} | {statistics.median(ratios):.3f} | {ratios[left_out]:.2f} to {ratios[-1 - left_out]:.2f} | "
              f"{100 * statistics.median(map(off, ratios)):.1f} % | {sum(off(r) <= 0.05 for r in ratios)} | {sum(off(r) <= 0.15 for r in ratios)} | "
              f"{statistics.median(row['largest'] for row in some):.3f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1, help="the first; the others follow it")
    parser.add_argument("--commit", help="the first seed is the number that its first 12 digits are")
    asked = parser.parse_args()
    first = int(asked.commit[:12], 16) if asked.commit else asked.seed
    print(f"Seeds {first} to {first + asked.scenes - 1}; digest of the prediction's sources {digest()[:16]}.")
    rows, refused = [], collections.Counter()
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(first, first + asked.scenes):
            subprocess.run([ROOT / "build/default/taut", "new", "scene", f"{folder}/drawn-{seed}", "--seed", str(seed), "--quiet"], check=True)
            cloth = taut.scene(f"{folder}/drawn-{seed}.toml")
            kind = cloth.summary.split(" of ")[0].split(",")[0].removeprefix("a ")
            for number, name in enumerate(SOLVERS):
                text, order = setting(random.Random(len(SOLVERS) * seed + number), name, cloth)
                said = taut.predict(cloth, text)[0]
                if said["refused"]:
                    refused[name, said["refused"][0].split(":")[0].split(" is ")[0]] += 1
                    continue
                run = taut.simulate(cloth, text, every=0)
                rows.append({"solver": name, "order": order, "kind": kind, "seed": seed, "setting": text, "status": run.status, "rms": said["rms"],
                             "s": said["s"], "ratio": said["rms"] / run.values.get("stretch.rms", float("nan")),
                             "largest": said["largest"] / run.values.get("stretch.max", float("nan")), "settled": run.values.get("settle.time"),
                             "weights": "weights" in pathlib.Path(folder, f"drawn-{seed}.toml").read_text()})
    lost = [row for row in rows if not row["ratio"] > 0]
    rows = [row for row in rows if row["ratio"] > 0]
    table("solver", rows, SOLVERS, lambda row: row["solver"])
    table("order", rows, ("coloured", "mesh", "reversed", "jolt", "by vertex"), lambda row: row["order"])
    table("cloth", rows, sorted({row["kind"] for row in rows}), lambda row: row["kind"])
    table("lower row", rows, ("as heavy", "3 to 30 times as heavy"), lambda row: "3 to 30 times as heavy" if row["weights"] else "as heavy")
    table("all", rows, ("all",), lambda row: "all")
    print("\nThe worst:\n\n| seed | cloth | solver | status | settled [s] | s | RMS predicted | over run |\n|---|---|---|---|---|---|---|---|")
    for row in sorted(rows, key=lambda row: -abs(row["ratio"] - 1))[:10]:
        print(f"| {row['seed']} | {row['kind']}{', heavy lower row' if row['weights'] else ''} | `{row['setting']}` | {row['status']} | {row['settled']:.2g} | "
              f"{row['s']:.2g} | {100 * row['rms']:.3g} % | {row['ratio']:.3f} |")
    print(f"\nRefused: {', '.join(f'{name}, {why}: {n}' for (name, why), n in sorted(refused.items()))}.")
    if lost:
        print("\nPredicted, but the run has no stretch: " + "; ".join(f"seed {row['seed']}, `{row['setting']}`, {row['status']}" for row in lost) + ".")
    print(f"\nCPU time: {time.process_time():.0f} s.")


if __name__ == "__main__":
    main()
