#!/usr/bin/env python3
"""`taut render` and the report's pictures if something is missing: no renderer, no fonts, no ffmpeg, a run
that explodes. Each costs only pictures, and a message says what to do."""

import json
import os
import pathlib
import shutil

from command_line import CommandLine, main

SIDE_BY_SIDE = ["--solver", "jakobsen", "--solver", "bullet"]
SMALL = ["--quality", "draft", "--size", "640x360"]


def png_size(file: pathlib.Path):
    head = file.read_bytes()[:24]
    return int.from_bytes(head[16:20], "big"), int.from_bytes(head[20:24], "big")


class Pictures(CommandLine):
    def render(self, *words, expect=0, **environment):
        return self.taut("render", "./small.toml", *words, expect=expect, env={**os.environ, **environment})

    def files(self):
        return sorted(f.name for f in self.folder.rglob("*") if f.is_file() and f.name != "small.toml")

    def test_stills_carry_their_moments_in_their_names(self):
        self.render(*SIDE_BY_SIDE, *SMALL, "--at", "0.25", "--at", "0.5", "-o", "two.png")
        self.assertEqual(self.files(), ["two-t0.25.png", "two-t0.50.png"])
        self.assertEqual(png_size(self.folder / "two-t0.25.png"), (640, 360))

    def test_the_same_picture_twice_has_the_same_bytes(self):
        for name in ["a.png", "b.png"]:
            self.render(*SIDE_BY_SIDE, *SMALL, "-o", name)
        self.assertEqual((self.folder / "a.png").read_bytes(), (self.folder / "b.png").read_bytes())

    def test_what_contradicts_itself_is_refused_before_anything_is_simulated(self):
        for words in [["--video", "--sheet"], ["-o", "a.jpg"], ["--video", "-o", "a.png"], ["-o", "."]]:
            self.taut("render", *SIDE_BY_SIDE, *words, expect=2)
        self.assertIn("--at 100 is after the end at ", self.render(*SIDE_BY_SIDE, "--at", "0.1", "--at", "100", expect=2).err)
        for first, second in [(["--set", "cloth.mass=1"], ["--set", "cloth.mass = 2"]),
                              (["--dt", "1/60"], ["--set", 'time.dt="1/120"']),
                              (["--duration", "1"], ["--set", "time.duration=2"])]:
            key = second[1].split("=")[0].strip()
            said = self.render(*SIDE_BY_SIDE, *first, *second, expect=2).err
            self.assertIn(f"both set {key}: leave out one of them", said)
            self.assertNotIn("running", said, "the error comes first")
        self.assertEqual(self.files(), [])

    def test_a_video_says_what_a_frame_takes(self):
        done = self.render(*SIDE_BY_SIDE, "--video", "--duration", "0.1", "-o", "film.mp4")
        self.assertRegex(done.err, r"frame (\d+)/\1  [0-9.e-]+ s each")

    def test_without_a_renderer_the_error_names_the_package_and_the_rest_works(self):
        damaged = self.folder / "libraries"
        damaged.mkdir()
        (damaged / "libOSMesa.so.8").touch()  # found first, but not a library
        nothing = {"LD_LIBRARY_PATH": str(damaged)}
        done = self.render(*SIDE_BY_SIDE, *SMALL, "-o", "a.png", expect=2, **nothing)
        for text in ["libOSMesa.so.8", "libosmesa6"]:
            self.assertIn(text, done.err)
        self.assertEqual(self.files(), ["libOSMesa.so.8"])
        study = self.study(solvers=["jakobsen:iterations=2", "bullet:iterations=2"])
        self.taut("run", study)
        done = self.taut("report", study, env={**os.environ, **nothing})
        self.assertIn("small not filmed: pictures need off-screen OpenGL", done.err)
        page = (self.folder / done.out.splitlines()[-1]).read_text()
        self.assertIn("No pictures were rendered.", page)

    def test_without_fonts_it_says_what_to_install(self):
        done = self.render(*SIDE_BY_SIDE, *SMALL, "-o", "a.png", expect=2, TAUT_FONTS="/nowhere")
        self.assertIn("fonts-dejavu-core", done.err)
        self.assertIn("/nowhere", done.err)
        self.assertEqual(self.files(), [])

    def test_without_ffmpeg_there_is_a_picture(self):
        tools = self.folder / "tools"
        tools.mkdir()
        for tool in ["sh", "timeout"]:
            (tools / tool).symlink_to(shutil.which(tool))
        done = self.render(*SIDE_BY_SIDE, *SMALL, "--video", "-o", "film.mp4", PATH=str(tools))
        self.assertIn("ffmpeg", done.err)
        self.assertEqual(png_size(self.folder / "film.png"), (640, 360))
        self.assertFalse((self.folder / "film.mp4").exists())

    def test_a_run_that_explodes_is_drawn_up_to_its_last_sound_state(self):
        exploding, long = "jakobsen:iterations=1,omega=1.9", ["--dt", "1/10", "--duration", "5"]
        ended = json.loads(self.taut("case", "./small.toml", exploding, *long, "--json").out)["status"]
        self.assertEqual(ended["kind"], "exploded")
        self.render("--solver", "jakobsen", "--solver", exploding, *SMALL, *long, "-o", "a.png")
        self.assertEqual(self.files(), ["a.png"])

    def test_a_motion_of_a_file_is_drawn_as_if_it_were_run(self):
        self.taut("case", "./small.toml", "jakobsen", "--trajectory", "run.npy")
        self.render("--solver", "positions:file=run.npy", *SMALL, "-o", "stored.png")
        self.assertIn("stored.png", self.files())

    def test_sheet_view_colour_and_moments(self):
        plain = ["--solver", "jakobsen", *SMALL]
        self.render(*plain, "-o", "plain.png")
        for words in [["--view", "top"], ["--view", "70,10"], ["--colour", "penetration"], ["--colour", "speed"],
                      ["--at", "0.25"], ["--range", "50"], ["--dark"]]:
            self.render(*plain, *words, "-o", "other.png")
            self.assertNotEqual((self.folder / "plain.png").read_bytes(), (self.folder / "other.png").read_bytes(), words)
        self.render(*SIDE_BY_SIDE, "--quality", "draft", "--size", "320x240", "--sheet", "--at", "0.1", "--at", "0.5", "-o", "s.png")
        width, height = png_size(self.folder / "s.png")
        self.assertGreaterEqual(width, 2 * 320)
        self.assertGreaterEqual(height, 2 * 240)
        for words in [["--view", "sideways"], ["--colour", "heat"], ["--at", "-1"], ["--at", "99", "--duration", "0.5"]]:
            self.render(*plain, *words, "-o", "other.png", expect=2)


if __name__ == "__main__":
    main()
