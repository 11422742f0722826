#!/usr/bin/env python3
"""What the law of taut.predict does not hold for, and by how much: a sheet of 17 x 17 vertices hung by two corners or a row, damped until it rests.

    ./taut python experiments/predict/others.py

Prints Markdown: the RMS stretch of the run over that of the law for a setting that it holds for, with the same sweeps.
"""
import taut

SWEEPS = 8, 32
LAW = "jakobsen:projection=exact,precision=double,substeps=1"
ELASTIC = "xpbd:precision=double,substeps=1,iterations=100000,structural=1e-4,shear=1e-4"  # springs, and hardly anything of sweeps
ROWS = [  # what, its setting (K: sweeps), the law's
    ("order `reversed`, by its own c", LAW + ",order=reversed,iterations=K", ""),
    ("Jacobi, corrections averaged, by its own c", LAW + ",method=jacobi-averaged,iterations=K", ""),
    ("Jacobi, corrections damped, by its own c", LAW + ",method=jacobi-underrelaxed,iterations=K", ""),
    ("Chebyshev, rho 0.9", LAW + ",chebyshev=0.9,iterations=K", LAW + ",iterations=K"),
    ("two levels", LAW + ",levels=2,iterations=K", LAW + ",iterations=K"),
    ("tethers", LAW + ",tethers=on,iterations=K", LAW + ",iterations=K"),
    ("`bullet`", "bullet:iterations=K", LAW + ",order=mesh,iterations=K"),
    ("`pd`, over its springs of 1e4 N/m", "pd:structural=1e4,shear=1e4,iterations=K", ELASTIC),
    ("`admm`, over its springs of 1e4 N/m", "admm:links=elastic,structural=1e4,shear=1e4,iterations=K", ELASTIC),
    ("`avbd`", "avbd:iterations=K", LAW + ",iterations=K"),
]
CONTACT = "on a slope of 45 degrees without friction, where gravity along it counts"
SCENE = """
[cloth]
grid = [17, 17]
size = [1, 1]
mass = 0.2
pins = [PINS]
[forces]
damping = 2
[time]
dt = "1/120"
duration = 8
"""
SLOPE = """
[[collider]]
type = "plane"
normal = [0, 1, -1]
"""


def stretch(scene, setting):
    try:
        run = taut.simulate(scene, setting, every=0)
    except Exception as error:  # noqa: BLE001  # what a solver refuses is a row of the table
        return None, str(error)
    return run.values.get("stretch.rms"), run.status


def main():
    print("| what | hung by | " + " | ".join(f"{k} sweeps" for k in SWEEPS) + " |\n|---|---|" + "---|" * len(SWEEPS))
    for what, other, law in [*ROWS, (CONTACT, LAW + ",iterations=K", LAW + ",iterations=K")]:
        for pins in ('"top"', '"top-left", "top-right"'):
            cells = []
            for k in SWEEPS:
                hung = SCENE.replace("PINS", pins)
                along = hung.replace("[forces]", f"[forces]\ngravity = [0, {-9.81 * 0.5 ** 0.5}, 0]")
                lying = hung.replace("[forces]", "v = [0, -1, -1]\n[forces]") + SLOPE
                said = taut.predict(taut.scene(along if what == CONTACT else hung), (law or other).replace("K", str(k)))[0]
                got, status = stretch(taut.scene(lying if what == CONTACT else hung), other.replace("K", str(k)))
                cells.append("refused by the law" if said["refused"] else str(status) if got is None else f"{got / said['rms']:.2f}")
            print(f"| {what} | {'a row' if 'left' not in pins else 'two corners'} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
