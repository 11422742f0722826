#!/usr/bin/env python3
"""Depths and passages that runs record at a body of triangles, against a second implementation that searches all triangles.

Usage: bodies_test.py BUILD [TEST...]
       bodies_test.py BUILD some.obj [sides=both] [sizes=8,16,32] [solvers='xpbd:substeps=1;pd']
           the same for any other body, under sheets with these numbers of vertices per side"""

import math
import pathlib
import sys
import unittest

import module
import numpy as np
import taut

SOLVERS = ("jakobsen:substeps=1,precision=double,contact=discrete", "xpbd:substeps=1,precision=double", "implicit:faces=edges", "vbd:precision=double,contact=discrete")
VELOCITY, SPIN, START = np.array([0.3, 2.5, 0.0]), np.array([0.4, 1.0, -0.7]), np.array([0.03, -0.45, 0.02])


def read_obj(path):
    """Vertices, with coincident ones merged, and triangles."""
    places, number, own, triangles = {}, [], [], []
    for line in pathlib.Path(path).read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            place = tuple(float(word) for word in words[1:4])
            number.append(places.setdefault(place, len(places)))
        elif words[:1] == ["f"]:
            corners = [int(word.split("/")[0]) for word in words[1:]]
            corners = [number[c - 1 if c > 0 else c] for c in corners]
            triangles += [(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]
    return np.array(list(places)), np.array(triangles)


def write_obj(path, vertices, triangles):
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in triangles.tolist()]
    path.write_text("\n".join(lines) + "\n")


def lumpy_torus(around, across):
    vertices, triangles = [], []
    for i in range(around):
        for j in range(across):
            u, v = 2 * math.pi * i / around, 2 * math.pi * j / across
            r = 0.12 + 0.02 * math.sin(7.3 * i + 11.9 * j)
            vertices.append(((0.3 + r * math.cos(v)) * math.cos(u), r * math.sin(v), (0.3 + r * math.cos(v)) * math.sin(u)))
            at = lambda a, b: (i + a) % around * across + (j + b) % across
            triangles += [(at(0, 0), at(0, 1), at(1, 0)), (at(1, 0), at(0, 1), at(1, 1))]
    return np.array(vertices), np.array(triangles)


def turned(t):
    angle = np.linalg.norm(SPIN) * t
    x, y, z = SPIN / np.linalg.norm(SPIN)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def dot(a, b):
    return np.einsum("...i,...i", a, b)


class Body:
    """A body in its own frame."""

    def __init__(self, vertices, triangles):
        self.vertices, self.triangles = vertices, triangles
        self.corners = vertices[np.unique(triangles)]  # files of scanned meshes have vertices without triangles
        self.a, self.b, self.c = (vertices[triangles[:, k]] for k in range(3))
        self.normals = np.cross(self.b - self.a, self.c - self.a)
        self.low, self.high = np.minimum(np.minimum(self.a, self.b), self.c), np.maximum(np.maximum(self.a, self.b), self.c)
        self.edges = np.unique(np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1), axis=0)

    def contains(self, p):
        """Whether p is inside, by the solid angle of the triangles."""
        if (p < self.low.min(0)).any() or (p > self.high.max(0)).any():
            return False
        a, b, c = self.a - p, self.b - p, self.c - p
        la, lb, lc = (np.linalg.norm(one, axis=1) for one in (a, b, c))
        angle = np.arctan2(dot(a, np.cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)
        return abs(angle.sum()) > math.pi

    def distance(self, p):
        least = np.inf
        for start, end in ((self.a, self.b), (self.b, self.c), (self.c, self.a)):
            way = end - start
            share = np.clip(dot(p - start, way) / dot(way, way), 0, 1)[:, None]
            least = min(least, np.linalg.norm(start + share * way - p, axis=1).min())
        n = self.normals / np.linalg.norm(self.normals, axis=1)[:, None]
        height = dot(p - self.a, n)
        foot = p - height[:, None] * n
        over = np.ones(len(n), bool)
        for start, end in ((self.a, self.b), (self.b, self.c), (self.c, self.a)):
            over &= dot(np.cross(end - start, foot - start), n) >= 0
        return min(least, abs(height[over]).min(initial=np.inf))

    def hits(self, p, q):
        """(share, triangle, inward) of all triangles that a straight path crosses."""
        near = np.flatnonzero((self.low <= np.maximum(p, q)).all(1) & (self.high >= np.minimum(p, q)).all(1))
        found = []
        for t in near:
            before, after = dot(p - self.a[t], self.normals[t]), dot(q - self.a[t], self.normals[t])
            if (before > 0) == (after > 0):
                continue
            share = before / (before - after)
            at = p + share * (q - p)
            if all(dot(np.cross(end - start, at - start), self.normals[t]) >= 0
                   for start, end in ((self.a[t], self.b[t]), (self.b[t], self.c[t]), (self.c[t], self.a[t]))):
                found.append((share, t, before > 0))
        return sorted(found)


def passages_of_vertices(body, thin, frames):
    """Passages of vertices; frames: [steps + 1, n, 3] in the body's frame."""
    events = 0
    for way in frames.transpose(1, 0, 2):
        inside, entry = False, None
        for p, q in zip(way, way[1:]):
            for _, triangle, inward in body.hits(p, q):
                if thin:
                    events += 1
                elif inward and not inside:
                    inside, entry = True, body.normals[triangle]
                elif not inward and inside:
                    inside = False
                    events += dot(entry, body.normals[triangle]) < 0
    return events


def roots(values, degree):
    """Roots in [0, 1) of n polynomials, as [(share, which)]. values: [degree + 1, n], equally spaced from 0 to 1."""
    found = []
    coefficients = np.linalg.solve(np.vander(np.linspace(0, 1, degree + 1)), values)
    for which in np.flatnonzero((values.min(0) <= 0) & (values.max(0) >= 0) | (degree * abs(coefficients[:-1]).max(0) >= abs(values).min(0))):
        found += [(root.real, which) for root in np.roots(coefficients[:, which]) if abs(root.imag) < 1e-12 and 0 <= root.real < 1]
    return found


def boxes_meet(low, high, others_low, others_high):
    return np.flatnonzero((others_low <= high).all(-1) & (others_high >= low).all(-1))


def moving(pieces, was, now, low, high):
    """The pieces whose swept box meets the body's box."""
    corners = np.concatenate([was[pieces], now[pieces]], axis=1)
    return boxes_meet(low, high, corners.min(1), corners.max(1))


def passages_of_edges(body, edges, frames):
    start, way = body.vertices[body.edges[:, 0]], body.vertices[body.edges[:, 1]] - body.vertices[body.edges[:, 0]]
    low, high = np.minimum(start, start + way), np.maximum(start, start + way)
    edges, count = np.array(edges), 0
    for was, now in zip(frames, frames[1:]):
        for i, j in edges[moving(edges, was, now, low.min(0), high.max(0))]:
            four = np.array([was[i], was[j], now[i], now[j]])
            near = boxes_meet(four.min(0), four.max(0), low, high)
            at = lambda s: (was[i] + s * (now[i] - was[i]), was[j] + s * (now[j] - was[j]))
            volumes = [dot(np.cross(q - p, way[near]), p - start[near]) for p, q in map(at, (0, 0.5, 1))]
            for s, which in roots(np.array(volumes), 2):
                k = near[which]
                p, q = at(s)
                shares, _, rank, _ = np.linalg.lstsq(np.array([q - p, -way[k]]).T, start[k] - p, rcond=None)
                count += rank == 2 and (shares >= 0).all() and (shares < 1).all()  # parallel lines do not meet
    return count


def passages_of_faces(body, faces, frames):
    low, high, count = body.corners.min(0), body.corners.max(0), 0
    for was, now in zip(frames, frames[1:]):
        for face in faces[moving(faces, was, now, low, high)]:
            six = np.concatenate([was[face], now[face]])
            near = body.corners[boxes_meet(six.min(0), six.max(0), body.corners, body.corners)]
            at = lambda s: was[face] + s * (now[face] - was[face])
            volumes = [np.linalg.det(at(s) - near[:, None]) for s in np.linspace(0, 1, 4)]
            for s, which in roots(np.array(volumes), 3):
                t = at(s) - near[which]
                normal = np.cross(t[1] - t[0], t[2] - t[0])
                count += all(dot(np.cross(t[m], t[(m + 1) % 3]), normal) >= 0 for m in range(3))
    return count


def scene(path, scale, center, n, sides):
    return taut.scene(f"""
summary = "A body goes through a cloth"
[cloth]
grid = [{n}, {n}]
size = [1.0, 1.0]
origin = [-0.5, 0, 0.5]
v = [0, 0, -1]
mass = 0.2
thickness = 0.003
pins = ["top-left", "top-right", "bottom-left", "bottom-right"]
[[collider]]
type = "mesh"
file = "{path}"
scale = {scale!r}
center = [{", ".join(repr(float(c)) for c in center)}]
sides = "{sides}"
velocity = [{", ".join(map(str, VELOCITY))}]
spin = [{", ".join(map(str, SPIN))}]
friction = 0.2
[time]
dt = "1/64"
duration = 0.5
""")


def compare(case, path, solvers, sizes, sides="out", size=0.7):
    vertices, triangles = read_obj(path)
    extent = vertices.max(0) - vertices.min(0)
    scale = float(size / extent.max())
    center = START - scale * (vertices.max(0) + vertices.min(0)) / 2
    body = Body(scale * vertices, triangles)
    met = 0
    for n in sizes:
        setup = scene(path, scale, center, n, sides)
        pins = {0, n - 1, n * (n - 1), n * n - 1}
        free = [i for i in range(n * n) if i not in pins]
        faces = setup.triangles
        edges = {tuple(sorted(pair)) for f in faces.tolist() for pair in (f[:2], f[1:], f[::2])}
        edges |= {tuple(sorted(link)) for link, family in zip(setup.links.tolist(), setup.families) if family == "structural"}
        edges = sorted(pair for pair in edges if not set(pair) <= pins)
        for solver in solvers:
            if sides == "both" and "faces=" in solver:
                continue
            run = taut.simulate(setup, solver)
            case.assertIn(run.status, ("ok", "extreme"), solver)
            frames = np.array([(x - center - VELOCITY * t) @ turned(t) for t, x in zip(run.t, run.x)])
            inside = [body.distance(p) for x in frames for p in x[free] if sides == "out" and body.contains(p)]
            seen = {"penetration.mesh.peak": max(inside, default=0.0),
                    "tunnelling.events": passages_of_vertices(body, sides == "both", frames[:, free]),
                    "edge.passages": passages_of_edges(body, edges, frames),
                    "face.passages": passages_of_faces(body, faces, frames)}
            if sides == "both":
                del seen["penetration.mesh.peak"]
            what = f"{path.name}, {n} x {n}, {solver}"
            print(f"  {what}: " + ", ".join(f"{key} {value:.6g} ({run.values[key]:.6g})" for key, value in seen.items()), flush=True)
            for key, value in seen.items():
                case.assertAlmostEqual(run.values[key], value, delta=1e-9, msg=f"{what}: {key}")
            met += seen["edge.passages"]
            if not any(word in solver for word in ("contact=discrete", "faces=", "bullet")):
                case.assertEqual(seen["tunnelling.events"], 0, what)
    case.assertGreater(met, 0, "nothing passed: the comparison says nothing")


class Bodies(module.Case):
    def test_an_edge_that_turns_parallel_beside_another_does_not_pass(self):
        body = Body(np.array([[0, 0, 0], [1, 0.75, 0], [-1, -2, 0]]), np.array([[0, 1, 2]]))
        turning = np.array([[[0.5, 0.5, -0.25], [0, 0.125, 0.25]], [[0.5, 0.5, 0.25], [0, 0.125, -0.25]]])
        self.assertEqual(passages_of_edges(body, [(0, 1)], turning), 0)
        turning[1] -= [0, 0.375, 0]
        self.assertEqual(passages_of_edges(body, [(0, 1)], turning), 1)

    def test_depths_and_passages_are_those_of_the_second_implementation(self):
        path = self.folder / "torus.obj"
        write_obj(path, *lumpy_torus(9, 6))
        compare(self, path, SOLVERS, (9,))

    def test_also_of_a_body_with_holes(self):
        path = self.folder / "open.obj"
        vertices, triangles = lumpy_torus(9, 6)
        write_obj(path, vertices, triangles[7:])
        with self.refused("open.obj:", "closed"):
            scene(path, 1.0, START, 9, "out")
        compare(self, path, SOLVERS, (9,), "both")


def main():
    if len(sys.argv) > 2 and sys.argv[2].endswith(".obj"):
        said = {"sides": "out", "sizes": "8,16,32", "solvers": ";".join(SOLVERS)} | dict(word.split("=", 1) for word in sys.argv[3:])
        path, sizes = pathlib.Path(sys.argv[2]).resolve(), [int(n) for n in said["sizes"].split(",")]
        case = type("Given", (unittest.TestCase,), {"runTest": lambda self: compare(self, path, said["solvers"].split(";"), sizes, said["sides"])})()
        sys.exit(not unittest.TextTestRunner(verbosity=2).run(case).wasSuccessful())
    module.main()


if __name__ == "__main__":
    main()
