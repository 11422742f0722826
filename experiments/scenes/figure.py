#!/usr/bin/env python3
"""Writes what the scenes cape and skirt are made of, into the folder of this file or into FOLDER: walker.obj, a figure of
capsules joined to one closed surface; walker.npy, two seconds of its walk on the spot; cape.obj and skirt.obj.

Usage: figure.py [FOLDER]
"""
import math
import pathlib
import struct
import sys

# Metres; y is up, the figure looks along z. Capsules by bone: ends of the axis, radius.
SIDES = {"left": 1, "right": -1}
BONES = {"trunk": [((-0.09, 0.95, 0), (0.09, 0.95, 0), 0.12), ((0, 1.0, 0), (0, 1.25, 0), 0.13),
                   ((-0.1, 1.28, 0), (0.1, 1.28, 0), 0.12), ((-0.16, 1.36, 0), (0.16, 1.36, 0), 0.07),
                   ((0, 1.38, 0), (0, 1.5, 0), 0.055), ((0, 1.58, 0.01), (0, 1.66, 0.01), 0.095)]}
for side, s in SIDES.items():
    BONES["thigh " + side] = [((s * 0.115, 0.9, 0), (s * 0.12, 0.5, 0), 0.075)]
    BONES["shank " + side] = [((s * 0.12, 0.5, 0), (s * 0.12, 0.09, 0), 0.055), ((s * 0.12, 0.05, 0), (s * 0.12, 0.05, 0.15), 0.05)]
    BONES["arm " + side] = [((s * 0.19, 1.35, 0), (s * 0.31, 1.1, 0), 0.05)]
    BONES["forearm " + side] = [((s * 0.31, 1.1, 0), (s * 0.38, 0.86, 0.03), 0.045)]
JOINED = 0.03  # m, over which capsules run into each other
CELL = 0.045  # m, of the grid whose surface is taken
FPS, SECONDS, GAIT = 24, 2, 1.0  # 1/s, s, s


def distance(capsule, p):
    a, b, radius = capsule
    along = [b[k] - a[k] for k in range(3)]
    share = sum((p[k] - a[k]) * along[k] for k in range(3)) / sum(c * c for c in along)
    share = min(1.0, max(0.0, share))
    return math.dist(p, [a[k] + share * along[k] for k in range(3)]) - radius


def to_bone(bone, p):
    return min(distance(capsule, p) for capsule in BONES[bone])


def to_figure(p):
    """The distances of the capsules, joined smoothly (Quilez, Smooth minimum: the exponential one)."""
    return -JOINED / 3 * math.log(sum(math.exp(-3 * distance(c, p) / JOINED) for bone in BONES.values() for c in bone))


def normal(p):
    e = 1e-5
    g = [to_figure([p[j] + e * (j == k) for j in range(3)]) - to_figure([p[j] - e * (j == k) for j in range(3)]) for k in range(3)]
    length = math.hypot(*g)
    return [c / length for c in g]


def on_figure(p):
    for _ in range(3):
        out, d = normal(p), to_figure(p)
        p = [p[k] - d * out[k] for k in range(3)]
    return p


def surface():
    """Vertices and quads: one vertex in each cell that the surface crosses, moved on to it; one quad for each edge of the
    grid that it crosses (Gibson, Constrained Elastic Surface Nets, 1998)."""
    low = (-0.5, -0.06, -0.24)
    n = [round(length / CELL) for length in (1.0, 1.88, 0.52)]
    at = lambda cell: [low[k] + CELL * cell[k] for k in range(3)]
    inside = {}
    for i in range(n[0] + 1):
        for j in range(n[1] + 1):
            for k in range(n[2] + 1):
                inside[i, j, k] = to_figure(at((i, j, k))) < 0
    vertices, number, quads = [], {}, []
    corners = [(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)]

    def vertex(cell):
        if cell not in number:
            p = at([c + 0.5 for c in cell])
            number[cell] = len(vertices)
            vertices.append(p)
        return number[cell]

    for i, j, k in sorted(inside):
        for axis in range(3):
            step = tuple(int(axis == m) for m in range(3))
            end = (i + step[0], j + step[1], k + step[2])
            if end not in inside or inside[i, j, k] == inside[end]:
                continue
            u, v = (axis + 1) % 3, (axis + 2) % 3
            around = []
            for a, b in ((-1, -1), (0, -1), (0, 0), (-1, 0)):
                cell = [i, j, k]
                cell[u] += a
                cell[v] += b
                around.append(vertex(tuple(cell)))
            quads.append(around if inside[i, j, k] else around[::-1])
    beside = [set() for _ in vertices]
    for quad in quads:
        for a, b in zip(quad, quad[1:] + quad[:1]):
            beside[a].add(b)
            beside[b].add(a)
    for _ in range(12):  # each to the middle of its neighbours, and on to the surface
        vertices = [on_figure([sum(vertices[n][k] for n in sorted(around)) / len(around) for k in range(3)]) for around in beside]
    return vertices, quads


def turned(p, pivot, angle):
    """The point turned about the axis x; a positive angle turns it forward."""
    y, z = p[1] - pivot[1], p[2] - pivot[2]
    return [p[0], pivot[1] + math.cos(angle) * y + math.sin(angle) * z, pivot[2] - math.sin(angle) * y + math.cos(angle) * z]


def smooth(s):
    s = min(1.0, max(0.0, s))
    return s * s * (3 - 2 * s)


def pose(t):
    """How each bone moves a point of the standing figure, at time t."""
    size, moves = smooth(t / 0.5), {"trunk": lambda p: p}
    for side, s in SIDES.items():
        phase = 2 * math.pi * t / GAIT + (0 if s > 0 else math.pi)
        hip, knee = 0.42 * size * math.sin(phase), size * (0.12 + 0.5 * max(0.0, math.sin(phase + 1.9)) ** 2)
        shoulder, elbow = -0.35 * size * math.sin(phase), 0.3 * size

        def thigh(p, s=s, hip=hip):
            return turned(p, (0, 0.92, 0), hip)

        def arm(p, s=s, shoulder=shoulder):
            return turned(p, (0, 1.35, 0), shoulder)

        moves["thigh " + side] = thigh
        moves["shank " + side] = lambda p, thigh=thigh, knee=knee: thigh(turned(p, (0, 0.5, 0), -knee))
        moves["arm " + side] = arm
        moves["forearm " + side] = lambda p, arm=arm, elbow=elbow: arm(turned(p, (0, 1.1, 0), elbow))
    return moves


def weights(p):
    """Share of each bone at a point of the standing figure; only the nearest bones count."""
    near = {bone: math.exp(-max(0.0, to_bone(bone, p)) / 0.02) for bone in BONES}
    whole = sum(near.values())
    return {bone: w / whole for bone, w in near.items() if w > 0.01 * whole}


def walk(vertices):
    shares = [weights(p) for p in vertices]
    for frame in range(FPS * SECONDS + 1):
        moves = pose(frame / FPS)
        placed = []
        for p, share in zip(vertices, shares):
            whole, x = sum(share.values()), [0.0, 0.0, 0.0]
            for bone, w in share.items():
                q = moves[bone](p)
                x = [x[k] + w / whole * q[k] for k in range(3)]
            placed.append(x)
        yield placed


def write_obj(path, what, vertices, faces):
    with open(path, "w") as out:
        out.write(f"# {what}; made by figure.py\n")
        for p in vertices:
            out.write("v " + " ".join(f"{c + 0:.5f}".replace("-0.00000", "0.00000") for c in p) + "\n")
        for face in faces:
            out.write("f " + " ".join(str(v + 1) for v in face) + "\n")


def write_npy(path, frames):
    """float32, to 0.01 mm as the OBJ file: the same on every machine."""
    frames = list(frames)
    header = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({len(frames)}, {len(frames[0])}, 3), }}"
    header = header.ljust(117) + "\n"
    with open(path, "wb") as out:
        out.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode())
        for frame in frames:
            for p in frame:
                out.write(struct.pack("<3f", *(round(c, 5) + 0.0 for c in p)))


def between(profile, s):
    """A line of points at equal shares of its length."""
    lengths = [math.dist(a, b) for a, b in zip(profile, profile[1:])]
    way = s * sum(lengths)
    for a, b, length in zip(profile, profile[1:], lengths):
        if way <= length or b is profile[-1]:
            share = min(1.0, way / length)
            return [a[k] + share * (b[k] - a[k]) for k in range(len(a))]
        way -= length


def cape(columns=48, rows=64):
    """Round the neck, over shoulders and arms, open in front. Profile: height, half width, half depth."""
    profile = [(1.475, 0.09, 0.085), (1.455, 0.17, 0.115), (1.42, 0.245, 0.15), (1.3, 0.33, 0.185), (1.1, 0.42, 0.22), (0.86, 0.47, 0.26), (0.42, 0.5, 0.36)]
    vertices = []
    for j in range(rows):
        y, width, depth = between(profile, j / (rows - 1))
        for i in range(columns):
            angle = math.radians(-105 + 210 * i / (columns - 1))
            vertices.append([width * math.sin(angle), y, -depth * math.cos(angle)])
    quads = [[j * columns + i, j * columns + i + 1, (j + 1) * columns + i + 1, (j + 1) * columns + i]
             for j in range(rows - 1) for i in range(columns - 1)]
    return vertices, quads


def skirt(around=72, rows=30):
    """A tube of triangles; the row at its waist is at a height of 1 m."""
    profile = [(1.0, 0.235, 0.16), (0.9, 0.27, 0.19), (0.45, 0.36, 0.31)]
    vertices, triangles = [], []
    for j in range(rows):
        y, width, depth = between(profile, j / (rows - 1))
        for i in range(around):
            angle = 2 * math.pi * (i + 0.5 * (j % 2)) / around
            vertices.append([width * math.sin(angle), y, depth * math.cos(angle)])
    for j in range(rows - 1):
        for i in range(around):
            a, b = j * around + i, j * around + (i + 1) % around
            c, d = a + around, b + around
            triangles += [[a, c, b], [b, c, d]] if j % 2 else [[a, c, d], [a, d, b]]
    return vertices, triangles


if __name__ == "__main__":
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).parent
    figure, quads = surface()
    write_obj(folder / "walker.obj", "A figure of capsules joined to one surface, 1.76 m tall", figure, quads)
    write_npy(folder / "walker.npy", walk(figure))
    write_obj(folder / "cape.obj", "A cape, 48 x 64 vertices, as it lies on the shoulders of walker.obj", *cape())
    write_obj(folder / "skirt.obj", "A skirt, 72 x 30 vertices, as it hangs from the waist of walker.obj", *skirt())
