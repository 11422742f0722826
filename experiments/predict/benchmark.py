#!/usr/bin/env python3
"""taut.predict against runs: settings drawn at random, by a seed, and the ratio of the two strains.

    ./taut python experiments/predict/benchmark.py [--seed N] [--settings N]

Prints Markdown. Sheets, strips, nets between close pins and irregular meshes; pins, masses, links, steps, orders; each run is damped
until it rests. Settings that are refused are counted by reason and drawn again.
"""
import argparse
import collections
import pathlib
import random
import statistics
import tempfile

import taut

DURATION, DAMPING = 8, 2  # s, 1/s
WORK = 4e8  # links times sweeps of a whole run, at most


def irregular(draw, folder, n):
    """A sheet whose vertices are displaced and whose quads are cut at random, as a file; its upper row is pinned."""
    place = lambda i: i + draw.uniform(-0.25, 0.25) * (0 < i < n - 1)  # noqa: E731
    lines = [f"v {place(i) / (n - 1)} {-place(j) / (n - 1)} 0" for j in range(n) for i in range(n)]
    for j in range(n - 1):
        for i in range(n - 1):
            a, b, c, d = (1 + i + j * n, 2 + i + j * n, 2 + i + (j + 1) * n, 1 + i + (j + 1) * n)
            lines += [f"f {a} {d} {c}", f"f {a} {c} {b}"] if draw.random() < 0.5 else [f"f {a} {d} {b}", f"f {b} {d} {c}"]
    file = pathlib.Path(folder, f"irregular-{n}-{draw.randrange(10**6)}.obj")
    file.write_text("\n".join(lines) + "\n")
    return {"mesh": str(file), "pins": list(range(n))}


def scene(draw, folder):
    kind = draw.choice(["sheet", "sheet", "strip", "net", "irregular"])
    n = draw.randint(10, 36)
    links = {"structural": True, "shear": True, "bend": draw.random() < 0.2}
    if kind == "irregular":
        cloth = irregular(draw, folder, n)
    else:
        grid = [n, n] if kind != "strip" else [draw.randint(8, 12), draw.randint(20, 36)]
        cloth = {"grid": grid, "size": [(grid[0] - 1) / 30, (grid[1] - 1) / 30], "lumping": draw.choice(["area", "equal"]),
                 "pins": draw.choice([["top-left", "top-right"], ["top"], ["top-left", "bottom-right"]])}
    if kind == "net":
        cloth |= {"pins": ["top-left", "top-right"], "span": draw.uniform(0.7, 0.95) * cloth["size"][0]}
        links = {"structural": True, "shear": False, "bend": False}
    cloth["mass"] = 10 ** draw.uniform(-1.5, 0)
    text = lambda value: str(value).lower() if isinstance(value, bool) else repr(value).replace("'", '"')  # noqa: E731
    section = lambda name, keys: f"[{name}]\n" + "".join(f"{key} = {text(value)}\n" for key, value in keys.items())  # noqa: E731
    dt = draw.choice(["1/60", "1/120", "1/240"])
    return kind, taut.scene(f'summary = "{kind}"\n' + section("cloth", cloth) + (section("links", links) if kind != "irregular" else "") +
                            section("forces", {"damping": DAMPING}) + section("time", {"dt": dt, "duration": DURATION}), name=f"{folder}/{kind}")


def solver(draw):
    sweeps, substeps = round(10 ** draw.uniform(0, 1.7)), round(10 ** draw.uniform(0, 1))
    name = draw.choice(["jakobsen", "xpbd", "vbd"])
    text = f"{name}:iterations={sweeps},substeps={substeps},precision=double"
    if name == "jakobsen":
        text += f",order={draw.choice(['coloured', 'coloured', 'mesh', 'reversed', 'jolt'])},projection={draw.choice(['exact', 'sqrt-free'])}"
    elif name == "xpbd":
        compliance = 10 ** draw.uniform(-5, -1.5)
        text += f",order={draw.choice(['coloured', 'mesh'])},structural={compliance:.3g},shear={compliance:.3g},bend={compliance:.3g}"
    else:
        stiffness = 10 ** draw.uniform(2, 5)
        text += f",start=inertia,structural={stiffness:.3g},shear={stiffness:.3g},bend={stiffness:.3g}"
    return name, sweeps * substeps, text


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--settings", type=int, default=60)
    asked = parser.parse_args()
    draw = random.Random(asked.seed)
    rows, refused = [], collections.Counter()
    with tempfile.TemporaryDirectory() as folder:
        while len(rows) < asked.settings:
            kind, cloth = scene(draw, folder)
            name, sweeps, text = solver(draw)
            if len(cloth.links) * sweeps * cloth.steps * (5 if name == "vbd" else 1) > WORK:
                continue
            said = taut.predict(cloth, text)[0]
            if said["refused"]:
                refused[said["refused"][0].split(":")[0].split(" is ")[0]] += 1
                continue
            run = taut.simulate(cloth, text, every=0)
            got = {key: run.values.get(value, float("nan")) for key, value in (("rms", "stretch.rms"), ("largest", "stretch.max"))}
            rows.append((name, kind, len(cloth.x), text, run.status, said["rms"], said["rms"] / got["rms"], said["largest"] / got["largest"]))
    off = lambda ratio: abs(ratio - 1)  # noqa: E731
    print("| solver | settings | ratio, median | 95 % of the ratios | median error | within 5 % | largest stretch: ratio, median | its median error |\n"
          "|---|---|---|---|---|---|---|---|")
    for name in ("jakobsen", "xpbd", "vbd", "all"):
        some = [row for row in rows if name in (row[0], "all")]
        ratios, largest = sorted(row[6] for row in some), [row[7] for row in some]
        if not some:
            continue
        left_out = int(0.025 * len(ratios))
        print(f"| {name} | {len(some)} | {statistics.median(ratios):.3f} | {ratios[left_out]:.2f} to {ratios[-1 - left_out]:.2f} | "
              f"{100 * statistics.median(map(off, ratios)):.1f} % | {sum(off(r) <= 0.05 for r in ratios)} | "
              f"{statistics.median(largest):.3f} | {100 * statistics.median(map(off, largest)):.1f} % |")
    print("\nThe worst:\n\n| cloth | vertices | solver | status | RMS predicted | over run |\n|---|---|---|---|---|---|")
    for _, kind, vertices, text, status, rms, ratio, _ in sorted(rows, key=lambda row: -off(row[6]))[:10]:
        print(f"| {kind} | {vertices} | `{text}` | {status} | {100 * rms:.3g} % | {ratio:.3f} |")
    print(f"\nRefused: {', '.join(f'{why}: {n}' for why, n in refused.most_common())}.")


if __name__ == "__main__":
    main()
