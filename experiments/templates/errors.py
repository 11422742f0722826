"""Error over iterations of three solvers on a scene:  ./taut python errors.py [SCENE] [PICTURE]

SCENE is a shipped name or a file of your own; without it the one below runs. Change what you like."""

import sys

import matplotlib.pyplot as plt
import taut

MINE = """
summary = "A sheet on two pins"
[cloth]
grid = [16, 16]
size = [1.0, 0.7]
mass = 0.2
pins = ["top-left", "top-right"]
[time]
dt = "1/60"
duration = 3.0
"""
SOLVERS = {"Jakobsen": "jakobsen:substeps=1,order=mesh,iterations={}", "XPBD": "xpbd:substeps=1,iterations={}",
           "Bullet": "bullet:iterations={}"}
SWEEPS = [2, 4, 8, 16, 32]
VALUE = "stretch.rms"  # any of taut.metrics()

scene = taut.scene(sys.argv[1] if len(sys.argv) > 1 else MINE)
for name, text in SOLVERS.items():
    runs = [taut.simulate(scene, text.format(sweeps), every=0) for sweeps in SWEEPS]
    for sweeps, run in zip(SWEEPS, runs):
        print(f"{name:10} {sweeps:3}  {VALUE} {run.values[VALUE]:.3e}  {run.verdict}")
    plt.loglog(SWEEPS, [run.values[VALUE] for run in runs], marker="o", label=name)  # a failure has no point
plt.xlabel("sweeps in a step")
plt.ylabel(f"{VALUE} on {scene.name}")
plt.legend()
plt.savefig(sys.argv[2] if len(sys.argv) > 2 else "errors.png", dpi=150)
