#!/usr/bin/env python3
"""Positions from files: in every format, a motion gets the metrics that it had in the program, up to the format's rounding."""

import array
import json
import math
import struct

from command_line import CommandLine, facts_of, main, rows_of

# With one substep, a frame contains everything that a step did, and the velocity is the difference of two frames.
SOLVER = "jakobsen:iterations=6,substeps=1,order=mesh,precision=double"


def frames_of(npy):
    data = npy.read_bytes()
    assert data[:8] == b"\x93NUMPY\x01\x00"
    length, = struct.unpack_from("<H", data, 8)
    shape = eval(data[10:10 + length].decode())["shape"]
    values = array.array("d", data[10 + length:])
    assert math.prod(shape) == len(values)
    vertices = [values[i:i + 3] for i in range(0, len(values), 3)]
    return [vertices[k:k + shape[1]] for k in range(0, len(vertices), shape[1])]


def flat(frames):
    return [c for frame in frames for x in frame for c in x]


class Files(CommandLine):
    def setUp(self):
        super().setUp()
        done = self.taut("case", "./small.toml", SOLVER, "--json", "--trajectory", "run.npy")
        self.inside = json.loads(done.out)
        self.frames = frames_of(self.folder / "run.npy")
        self.n = len(self.frames[0])

    def score(self, file, *words, expect=0):
        done = self.taut("external", "score", "./small.toml", file, *words, *(["--json"] if expect == 0 else []), expect=expect)
        if expect != 0:
            return done.err
        answer = json.loads(done.out)
        facts = facts_of(answer)
        return {**facts, "values": {name: facts[name] for name in self.inside["values"]},
                "resolved_settings": {row["what"]: row["how"] for row in rows_of(answer, "read")}}

    def assert_same(self, record, tolerance):
        self.assertEqual(record["status"], self.inside["status"]["kind"])
        for name, value in self.inside["values"].items():
            found = record["values"][name]
            if value is None or found is None:
                self.assertEqual(found, value, name)
            else:
                # Popping takes second differences of float32 positions: four roundings of 6e-8 m over (1/64 s)^2.
                most = tolerance * (100 if name.startswith("popping") else 1)
                self.assertLessEqual(abs(found - value), most * max(1, abs(value)), name)
        self.assertEqual(record["resolved_settings"]["cost"], "not measured")

    def test_what_taut_writes_scores_as_it_did_inside(self):
        # Velocities and energies take differences of float32 positions: 1e-7 m over 1/64 s.
        for file, tolerance in [("run.npy", 1e-12), ("run.obj", 1e-12), ("run.pc2", 1e-5)]:
            with self.subTest(file):
                self.taut("case", "./small.toml", SOLVER, "--trajectory", file)
                self.assert_same(self.score(file), tolerance)

    def test_what_others_write_does_too(self):
        count, n, frames = len(self.frames), self.n, self.frames
        values = flat(frames)
        folder = self.folder
        (folder / "a.pc2").write_bytes(struct.pack("<12siiffi", b"POINTCACHE2\0", 1, n, 1.0, 1.0, count)
                                       + struct.pack(f"<{len(values)}f", *values))
        for name, kind in [("f4", "<f"), ("f8", ">d")]:
            header = f"{{'descr': '{kind[0]}{name}', 'fortran_order': False, 'shape': ({count}, {n}, 3), }}".encode()
            header += b" " * (63 - (len(header) + 12) % 64) + b"\n"
            (folder / f"{name}.npy").write_bytes(b"\x93NUMPY\x02\x00" + struct.pack("<I", len(header)) + header
                                                 + struct.pack(f"{kind[0]}{len(values)}{kind[1]}", *values))
        for k, frame in enumerate(frames):
            (folder / f"cloth.{k + 1:04}.obj").write_text("o cloth\n" + "".join("v %.17g %.17g %.17g\n" % tuple(x) for x in frame))
        for file, tolerance in [("a.pc2", 1e-5), ("f4.npy", 1e-5), ("f8.npy", 1e-12), ("cloth.0001.obj", 1e-12)]:
            with self.subTest(file):
                self.assert_same(self.score(file), tolerance)

    def write(self, name, frames):
        header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({len(frames)}, {len(frames[0])}, 3), }}\n".encode()
        values = flat(frames)
        (self.folder / name).write_bytes(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header
                                         + struct.pack(f"<{len(values)}d", *values))
        return name

    def test_unit_axis_and_order_are_printed(self):
        blender = self.write("cm.npy", [[(100 * x, -100 * z, 100 * y) for x, y, z in reversed(frame)] for frame in self.frames])
        self.assertIn("does not begin as small does, at 1 unit is 1 m, y up: 15 of its 16", self.score(blender, expect=2))
        said = ("--scale", 0.01, "--z-up")
        self.assert_same(self.score(blender, *said), 1e-12)
        text = self.taut("external", "score", "./small.toml", blender, *said).out
        for part in ["1 unit is 0.01 m, z up", "matched by position", "0.015625 s a frame, assumed",
                     "float64", "strain.floor  ", "cost          not measured", "stretch.rms"]:
            self.assertIn(part, text)

    def test_time_is_said_or_the_scenes(self):
        every = self.write("half.npy", self.frames[::2])
        record = self.score(every, "--fps", 32)
        self.assertEqual((record["dt"], record["steps"]), (1 / 32, (len(self.frames) - 1) // 2))
        self.assertEqual(self.score(every, "--fps", "32032/1001")["dt"], self.score(every, "--fps", 32032 / 1001)["dt"])
        record = self.score(self.write("short.npy", self.frames[:9]))
        self.assertEqual((record["dt"], record["steps"]), (1 / 64, 8))

    def test_what_does_not_fit_is_refused(self):
        broken = [list(map(list, frame)) for frame in self.frames]
        broken[0][2][2] += 0.5
        self.assertIn("its vertex 2 is at", self.score(self.write("other.npy", broken), expect=2))
        self.assertIn("15 vertices, the scene has 16", self.score(self.write("few.npy", [f[:15] for f in self.frames]), expect=2))
        moved = [list(map(list, frame)) for frame in self.frames]
        moved[5][0][1] += 0.3
        self.assertIn("does not hold the scene's pins: vertex 0 is 0.3 m from", self.score(self.write("pins.npy", moved), expect=2))
        (self.folder / "cut.npy").write_bytes((self.folder / "run.npy").read_bytes()[:-1])
        self.assertIn("cut.npy: the header says", self.score("cut.npy", expect=2))
        self.assertIn("positions are in files that end in", self.score("run.xyz", expect=2))
        done = self.taut("case", "./small.toml", SOLVER, "--trajectory", "run.xyz", expect=2)
        self.assertIn(".npy, .pc2 or .obj", done.err)

    def test_positions_that_are_not_finite_are_an_explosion(self):
        bad = [list(map(list, frame)) for frame in self.frames]
        bad[7][3][1] = float("nan")
        record = self.score(self.write("nan.npy", bad))
        self.assertEqual((record["status"], record["step"], record["vertex"]), ("exploded", 7, 3))

    def test_pictures_and_values_over_time(self):
        (self.folder / "a folder").mkdir()
        (self.folder / "run.npy").rename(self.folder / "a folder/it's mine.npy")
        self.score("a folder/it's mine.npy", "--solver", SOLVER, "--picture", "end.png", "--series", "series.csv")
        self.assertTrue((self.folder / "end.png").read_bytes().startswith(b"\x89PNG"))
        self.taut("case", "./small.toml", SOLVER, "--series", "inside.csv")
        inside, outside = [[line.split(",") for line in (self.folder / name).read_text().splitlines()]
                           for name in ("inside.csv", "series.csv")]
        self.assertEqual(len(inside), len(outside))
        column = inside[0].index("stretch.rms")
        for a, b in zip(inside[1:], outside[1:]):
            self.assertAlmostEqual(float(a[column]), float(b[column]), delta=1e-12)


if __name__ == "__main__":
    main()
