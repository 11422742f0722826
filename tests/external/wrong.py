#!/usr/bin/env python3
"""Programs with one error each, which the probe has to name."""

import os
import random
import sys
import time

sys.path.insert(0, os.environ["TAUT_SDK"])
import taut_solver  # noqa: E402

MODE = sys.argv[1]


class Wrong:
    name, version = "wrong", MODE

    @staticmethod
    def cannot(scene, params):
        return ["pins that move"] if scene["pin_motions"] and MODE != "left" else []

    def __init__(self, scene, params):
        self.w, self.links, self.g = scene["inverse_mass"], scene["links"], list(scene["gravity"])
        if MODE == "down":
            self.g = [0, -9.75, 0]
        if MODE == "up":
            self.g = [-c for c in self.g]
        if MODE == "centimetres":
            self.g = [100 * c for c in self.g]
        if MODE == "weightless":
            self.g = [0, 0, 0]
        self.dt = 1 / 60 if MODE == "frames" else None
        self.kept = 0.0

    def load(self, x, v):
        self.x, self.v = list(x), list(v) if MODE != "forgets" else [0.0] * len(v)
        if MODE != "survives":
            self.kept = 0.0

    def step(self, t, dt):
        dt = self.dt or dt
        if MODE == "still":
            return
        self.kept += 1e-9
        for k in range(len(self.x)):
            if self.w[k // 3] > 0 or MODE == "pins":
                self.v[k] += dt * self.g[k % 3]
                self.x[k] += dt * self.v[k]
        if MODE == "chance":
            self.x[4] += 1e-9 * random.random()
        if MODE == "survives":
            self.x[4] += self.kept
        if MODE == "shrinks":
            self.x[3] -= 1e-3
        if MODE == "nan":
            self.x[-1] = float("nan")

    def store(self):
        if MODE == "frame-velocity":
            return self.x, [c * 60 for c in self.v]
        if MODE == "restart":
            return self.x, [0.9 * c for c in self.v] if min(self.w) == 0 else self.v
        return self.x, self.v


if MODE == "outlives":
    try:
        taut_solver.serve(Wrong)
    finally:
        time.sleep(1000)
taut_solver.serve(Wrong)
