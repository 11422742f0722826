#!/usr/bin/env python3
"""Jakobsen's algorithm (Advanced Character Physics, GDC 2001), link after link: a complete solver."""

import math

import taut_solver


class Toy:
    name, version = "toy-python", "1"
    summary, source = "Jakobsen's algorithm in Python", "Jakobsen, Advanced Character Physics, GDC 2001"
    params = {"iterations": {"type": "integer", "min": 0, "max": 1000000, "default": 8, "doc": "Sweeps over all links in a step"}}

    @staticmethod
    def cannot(scene, params):
        if scene["colliders"] or scene["wind"] or scene["self_collision"] or scene["pin_motions"] or scene["damping"]:
            return ["gravity, links and pins at rest are all that it knows"]
        return []

    def __init__(self, scene, params):
        self.w, self.links, self.gravity, self.dt = scene["inverse_mass"], scene["links"], scene["gravity"], scene["dt"]
        self.sweeps = params["iterations"]

    def load(self, x, v):
        self.x, self.before = list(x), [a - self.dt * b for a, b in zip(x, v)]

    def step(self, t, dt):
        x, before = self.x, self.before
        for i, w in enumerate(self.w):  # Verlet; pins have inverse mass 0
            for k in range(3 * i, 3 * i + 3):
                now = x[k]
                if w > 0:
                    x[k] += now - before[k] + dt * dt * self.gravity[k % 3]
                before[k] = now
        for _ in range(self.sweeps):
            for a, b, rest, family in self.links:  # restores each rest length in turn
                w, i, j = self.w[a] + self.w[b], 3 * a, 3 * b
                d = [x[j] - x[i], x[j + 1] - x[i + 1], x[j + 2] - x[i + 2]]
                length = math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
                if w == 0 or length == 0:
                    continue
                share = (length - rest) / (length * w)
                for k in range(3):
                    x[i + k] += self.w[a] * share * d[k]
                    x[j + k] -= self.w[b] * share * d[k]

    def store(self):
        return self.x, [(a - b) / self.dt for a, b in zip(self.x, self.before)]

    def plan(self):
        return [{"pass": "links", "items": len(self.links), "repeats": self.sweeps, "projections": True}]

    def settings(self):
        return {"projection": "exact", "precision": "double"}


taut_solver.serve(Toy)
