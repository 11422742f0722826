#!/usr/bin/env python3
"""The installation works without the source tree: programs built against it, each header by itself, and the Debian packages."""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

BINARIES = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "build/default").resolve()
TREE = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = pathlib.Path(__file__).resolve().parent / "examples"
VERSION = re.search(r"project\(taut VERSION (\S+)", (TREE / "CMakeLists.txt").read_text())[1]
PYTHON = "TAUT_PYTHON:BOOL=ON" in (BINARIES / "CMakeCache.txt").read_text()


os.environ["CMAKE_GENERATOR"] = "Ninja"  # the generator of ./taut; CMake's own default is make


def call(*words, expect=0, **more):
    done = subprocess.run([*map(str, words)], text=True, capture_output=True, timeout=280, **more)
    assert done.returncode == expect, f"{words}: {done.returncode}\n{done.stdout}\n{done.stderr}"
    return done.stdout if expect == 0 else done.stderr


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory(prefix="taut with spaces ")
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = pathlib.Path(scratch.name)
        cls.prefix = cls.folder / "a prefix"
        (BINARIES / "taut.1").unlink(missing_ok=True)  # ./taut builds the programs only
        call("cmake", "--install", BINARIES, "--prefix", cls.prefix)
        cls.libraries = next(cls.prefix.glob("**/libtaut_model.a")).parent
        cls.scene = cls.prefix / "share/taut/scenes/hang.toml"
        cls.fall = cls.folder / "fall.toml"
        cls.fall.write_text('summary = "Nothing holds it"\n[cloth]\ngrid = [3, 3]\nsize = [1, 1]\nmass = 1\n'
                            '[time]\ndt = "1/64"\nduration = 1\n')

    def test_the_manual_and_the_completion_are_where_they_are_looked_for(self):
        taut = self.prefix / "bin/taut"
        for option, file in (("--man", "share/man/man1/taut.1"), ("--bash-completion", "share/bash-completion/completions/taut")):
            self.assertEqual((self.prefix / file).read_text(), call(taut, option))

    def build(self, name, *components, source="int main() {}", libraries="", expect=0):
        """Configures and builds a project of one file that uses these components."""
        folder = self.folder / name
        folder.mkdir()
        (folder / "main.cpp").write_text(source)
        (folder / "CMakeLists.txt").write_text(
            f"cmake_minimum_required(VERSION 3.25)\nproject({name} LANGUAGES CXX)\n"
            f"find_package(taut {components[0]} REQUIRED COMPONENTS {' '.join(components[1:])})\n"
            f"add_executable(main main.cpp)\ntarget_link_libraries(main PRIVATE {libraries})\n")
        said = call("cmake", "-S", folder, "-B", folder / "build", f"-DCMAKE_PREFIX_PATH={self.prefix}", expect=expect)
        if expect == 0:
            call("cmake", "--build", folder / "build")
        return said

    def test_the_examples_give_what_the_program_gives(self):
        build = self.folder / "a build"
        call("cmake", "-S", EXAMPLES, "-B", build, f"-DCMAKE_PREFIX_PATH={self.prefix}")
        call("cmake", "--build", build)
        lines = call(build / "stretch", self.scene, "jakobsen:iterations=4").splitlines()
        self.assertEqual(len(lines), 10)
        series = self.folder / "series.csv"
        taut = self.prefix / "bin/taut"
        call(taut, "case", "hang", "jakobsen:iterations=4", "--series", series)
        names, *_, last = [line.split(",") for line in series.read_text().splitlines()]
        self.assertAlmostEqual(float(lines[-1].split()[-1]), float(last[names.index("stretch.rms")]), delta=1e-15)

        record = json.loads(call(build / "own_solver", self.fall, "gravity=0"))
        self.assertEqual((record["solver"], record["status"]["kind"], record["values"]["stretch.rms"]), ("fall", "ok", 0))
        record = json.loads(call(build / "own_solver", self.scene))
        self.assertEqual(record["status"]["kind"], "exploded", "pinned cloth does not fall for ten seconds")
        self.assertIn("usage", call(build / "own_solver", expect=2))

    def test_pkg_config_is_enough(self):
        environment = {**os.environ, "PKG_CONFIG_PATH": str(self.libraries / "pkgconfig")}
        flags = call("pkg-config", "--cflags", "--libs", "taut", env=environment)
        self.assertEqual(call("pkg-config", "--modversion", "taut", env=environment).strip(), VERSION)
        program = self.folder / "by pkg-config"
        call("sh", "-c", f'g++ -std=c++20 "$0" -o "$1" {flags}', EXAMPLES / "own_solver.cpp", program)
        self.assertEqual(json.loads(call(program, self.fall))["status"]["kind"], "ok")

    def test_components(self):
        self.build("alone", "0.2", "model", "solver", "metrics", libraries="taut::model taut::metrics",
                   source='#include <taut/metrics/metric.hpp>\n#include <taut/model/solver.hpp>\n'
                          'int main() { return taut::parse_solver("jakobsen").entry && taut::metrics().size() ? 0 : 1; }')
        call(self.folder / "alone/build/main")
        self.assertIn("no component bullet", self.build("unknown", "0.2", "model", "bullet", expect=1))
        self.assertIn("compatible", self.build("older", "0.1", "model", expect=1))
        self.assertIn("compatible", self.build("newer", "0.3", "model", expect=1))

    def test_headers_stand_alone_and_bring_no_library_of_ours(self):
        include = self.prefix / "include"
        headers = sorted(include.glob("taut/**/*.hpp"))
        self.assertGreater(len(headers), 15)
        for header in headers:
            self.assertNotRegex(header.read_text(), r'#include "(core|experiments)/', header)
        source = self.folder / "all.cpp"
        source.write_text("".join(f"#include <{h.relative_to(include)}>\n" for h in headers))
        read = call("g++", "-std=c++20", "-M", "-I", include, "-I", "/usr/include/eigen3", source)
        self.assertIn("Eigen/Core", read)
        self.assertNotRegex(read, r"(?i)bullet|toml|nlohmann|openssl|CLI11")
        self.assertNotIn(str(TREE), read.replace(str(self.folder), ""))
        call("g++", "-std=c++20", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-I", include, "-isystem",
             "/usr/include/eigen3", source)

    def test_the_python_module_uses_public_headers_alone(self):
        included = {name for file in (TREE / "experiments/python").glob("*.?pp")
                    for name in re.findall(r'#include "(?:core|experiments)/(?!python/)(\S+)"', file.read_text())}
        self.assertGreater(len(included), 10)
        for name in included:
            self.assertTrue((self.prefix / "include/taut" / name).exists(), name)

    def test_the_python_package_is_one_with_the_program(self):
        if not PYTHON:
            self.skipTest("TAUT_PYTHON is off")
        package = self.prefix / "lib/python3/dist-packages/taut"
        said = call("/usr/bin/python3", "-c", "import taut; print(taut.__file__); print(taut.simulate('hang', duration=0.1).record['digest'])",
                    cwd=self.folder, env={**os.environ, "PYTHONPATH": str(package.parent)}).splitlines()
        record = json.loads(call(self.prefix / "bin/taut", "case", "hang", "jakobsen", "--duration", 0.1, "--json"))
        self.assertEqual(said, [str(package / "__init__.py"), record["digest"]])
        self.assertTrue((package / "data").samefile(self.prefix / "share/taut"))

    def test_debian_packages(self):
        for tool in ("dpkg-deb", "dpkg-shlibdeps"):
            if not shutil.which(tool):
                self.skipTest(f"{tool} is missing")
        out = self.folder / "packages"
        call("cpack", "-G", "DEB", "-B", out, cwd=BINARIES)
        packages = {call("dpkg-deb", "-f", deb, "Package").strip(): deb for deb in out.glob("*.deb")}
        self.assertEqual(set(packages), {"taut", "libtaut-dev"} | ({"python3-taut"} if PYTHON else set()))
        field = lambda package, name: call("dpkg-deb", "-f", packages[package], name).strip()
        self.assertEqual(field("taut", "Version"), VERSION)
        self.assertIn("libbullet3.24", field("taut", "Depends"))
        self.assertIn("libeigen3-dev", field("libtaut-dev", "Depends"))
        self.assertNotIn(".a\n", call("dpkg-deb", "-c", packages["taut"]))
        root = self.folder / "root"
        call("dpkg-deb", "-x", packages["taut"], root)
        taut = root / "usr/bin/taut"
        self.assertIn(f"taut {VERSION}", call(taut, "--version"))
        record = json.loads(call(taut, "case", "hang", "bullet", "--duration", 0.5, "--json", cwd=self.folder))
        self.assertEqual(record["status"]["kind"], "ok")
        record = json.loads(call(taut, "case", "hang", "bullet:precision=float", "--duration", 0.5, "--json", cwd=self.folder))
        self.assertEqual(record["status"]["kind"], "ok", "taut-f32 came along")
        if not PYTHON:
            return
        for part in (f"taut (= {VERSION})", "python3-numpy", "libbullet"):
            self.assertIn(part, field("python3-taut", "Depends"))
        call("dpkg-deb", "-x", packages["python3-taut"], root)
        said = call("/usr/bin/python3", "-c", "import taut; print(len(taut.scenes()), taut.simulate('hang', 'bullet', duration=0.5).status)",
                    cwd=self.folder, env={**os.environ, "PYTHONPATH": str(root / "usr/lib/python3/dist-packages")})
        self.assertRegex(said, r"^[2-4]\d ok$")
        self.assertLess(packages["python3-taut"].stat().st_size, 20e6, "without what debuggers read")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)
