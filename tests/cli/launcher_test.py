#!/usr/bin/env python3
"""Promises of ./taut, tested on a small project in a folder whose name has spaces and umlauts: it is silent and quick when
there is nothing to build, uses its own sources after a copy or a move, keeps the caller's paths, needs no root, and
may be called twice at once."""

import os
import pathlib
import re
import resource
import shutil
import subprocess
import tempfile
import unittest

REPOSITORY = pathlib.Path(__file__).resolve().parent.parent.parent
NOBODY = 65534

CMAKE = """
cmake_minimum_required(VERSION 3.25)
project(toy LANGUAGES CXX)
include(cmake/batches.cmake)
option(TAUT_TESTS "" ON)
# Fails if it runs twice at once.
add_custom_command(OUTPUT made.hpp DEPENDS core/main.cpp COMMAND mkdir alone COMMAND sleep 0.3
                   COMMAND rmdir alone COMMAND ${CMAKE_COMMAND} -E touch made.hpp)
add_executable(taut core/main.cpp made.hpp)
target_include_directories(taut PRIVATE ${PROJECT_BINARY_DIR})
target_compile_definitions(taut PRIVATE SOURCE="${PROJECT_SOURCE_DIR}")
add_custom_target(taut-f32 COMMAND ${CMAKE_COMMAND} -E copy taut taut-f32 DEPENDS taut)
option(TAUT_PYTHON "" OFF)
if(TAUT_PYTHON)
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
  add_custom_target(taut_python COMMAND mkdir -p python/taut COMMAND cp ${PROJECT_SOURCE_DIR}/experiments/taut_module python/taut/__init__.py
                    COMMAND touch python/taut/_taut.toy.so)
endif()
if(TAUT_TESTS)
  enable_testing()
  foreach(target taut_tests taut_fuzz taut-case)
    add_custom_target(${target})
  endforeach()
  add_test(NAME one COMMAND true)
  add_test(NAME layers COMMAND true)
  add_test(NAME planted COMMAND true)
  add_test(NAME random COMMAND true)
  add_test(NAME absent COMMAND false)
  add_test(NAME partly COMMAND sh -c "echo \\"test_disk (__main__.Store.test_disk) ... skipped 'needs a disk'\\"")
  set_tests_properties(one PROPERTIES LABELS unit)
  set_tests_properties(planted PROPERTIES LABELS mutation)
  set_tests_properties(random PROPERTIES LABELS fuzz)
  set_tests_properties(absent PROPERTIES LABELS browser SKIP_RETURN_CODE 1)
endif()
"""

MAIN = r"""
#include <cstdio>
#include <cstdlib>
#include <made.hpp>
int main(int count, char** words) {
  std::printf("version 1\nbuilt from %s\n", SOURCE);
  std::printf("results %s\n", std::getenv("TAUT_RESULTS") ? std::getenv("TAUT_RESULTS") : "-");
  for (int k = 1; k < count; ++k) std::printf("word %s\n", words[k]);
}
"""

# Each tool that may be started logs its name, then becomes the real tool. All packages are present except for $MISSING.
TOOL = """#!/bin/sh
echo {name} >>"$TOOL_LOG"
exec {real} "$@"
"""
DPKG_QUERY = """#!/bin/sh
echo dpkg-query >>"$TOOL_LOG"
for word; do [ "$word" = "$MISSING" ] || echo "$word install ok installed"; done
"""
FORBIDDEN = """#!/bin/sh
echo {name} >>"$TOOL_LOG"
exit 1
"""


class Launcher(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        os.chmod(self.folder, 0o755)
        self.clone = self.folder / "Tücher und Wäsche" / "taut"
        (self.clone / "core").mkdir(parents=True)
        for name in ["cmake", "bullet_ref", "experiments", "tests"]:
            (self.clone / name).mkdir()
        for name in ["taut", "CMakePresets.json"]:
            shutil.copy2(REPOSITORY / name, self.clone)
        (self.clone / "CMakeLists.txt").write_text(CMAKE)
        shutil.copy2(REPOSITORY / "cmake/batches.cmake", self.clone / "cmake")
        (self.clone / "core/main.cpp").write_text(MAIN)
        (self.clone / "experiments/taut_module").write_text("version = 1\n")
        self.tools = self.folder / "tools"
        self.tools.mkdir()
        for name in ["cmake", "ninja", "ctest"]:
            self.tool(name, TOOL.format(name=name, real=shutil.which(name)))
        self.tool("dpkg-query", DPKG_QUERY)
        for name in ["apt-get", "sudo"]:
            self.tool(name, FORBIDDEN.format(name=name))
        self.log = self.folder / "log"
        self.log.touch()
        self.user = None

    def tool(self, name, text):
        (self.tools / name).write_text(text)
        (self.tools / name).chmod(0o755)

    def start(self, *words, clone=None, cwd=None, **environment):
        clone = clone or self.clone
        known = {key: value for key, value in os.environ.items() if key not in ("CI", "TAUT_RESULTS")}
        environment = {**known, "PATH": f"{self.tools}:{os.environ['PATH']}", "TOOL_LOG": str(self.log), **environment}
        return subprocess.Popen([clone / "taut", *words], cwd=cwd or clone, env=environment, text=True, user=self.user,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def call(self, *words, expect=0, **more):
        process = self.start(*words, **more)
        process.out, process.err = process.communicate(timeout=120)
        self.assertEqual(process.returncode, expect, process.out + process.err)
        return process

    def started(self):
        """The tools that were started since the last call."""
        names = self.log.read_text().split()
        self.log.write_text("")
        return names

    def git(self, *words):
        if not shutil.which("git"):
            self.skipTest("git is missing")
        subprocess.run(["git", "-c", "user.name=x", "-c", "user.email=x", *words], cwd=self.clone, check=True, capture_output=True)

    def edit(self, there, then):
        file = self.clone / "core/main.cpp"
        file.write_text(file.read_text().replace(there, then))

    def test_nothing_to_build_nothing_said_nothing_started(self):
        self.assertEqual(self.call("run").err, "taut: the first build of default: three to six minutes on two cores, once; then the command runs\n"
                                               "taut: building default\n")
        self.assertIn("cmake", self.started())
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.assertEqual(self.call("run").err, "")
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.assertEqual(self.started(), [])
        self.assertLess(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, 0.3)

    def test_a_long_build_says_how_far_it_is_and_how_long_it_will_take(self):
        progress = re.search(r"^show_progress\(\) \{.*?^\}", (REPOSITORY / "taut").read_text(), re.MULTILINE | re.DOTALL)[0]
        feed = ["[1/40] Building a", "[2/40] Building b", "[10/40] Linking c", "[11/40] Building d", "[39/40] Building e"]
        seconds = [0, 5, 60, 61, 200]  # the test sets the clock, which is SECONDS of bash
        progress = progress.replace("while IFS= read -r line; do", 'while IFS="|" read -r SECONDS line; do')
        script = 'say() { echo "$1"; }\nSECONDS=0\n' + progress + "\nshow_progress default 2>&1"
        lines = "".join(f"{s}|taut: building default {line}\n" for s, line in zip(seconds, feed))
        said = subprocess.run(["bash", "-c", script], input=lines, capture_output=True, text=True, check=True).stdout
        self.assertEqual(said.splitlines(), ["building default", "building default [10/40], about 4 min left", "building default [39/40], about 1 min left"])

    def test_an_edit_is_built_and_a_new_file_seen(self):
        self.call("run")
        self.edit("version 1", "version 2")
        self.assertIn("version 2", self.call("run").out)
        self.started()
        (self.clone / "core/new.cpp").touch()
        os.utime(self.clone / "core/new.cpp", (0, 0))
        self.call("run")
        self.assertIn("cmake", self.started())
        (self.clone / "tests/new_test.cpp").touch()
        self.call("run")
        self.assertEqual(self.started(), [], "a test is no part of the program")

    def test_an_edited_file_leaves_its_batch_until_it_is_committed(self):
        self.git("init")
        self.git("add", "core")
        self.git("commit", "-m", "first")
        self.call("run")
        for text, files, configured in (("2", "core/main.cpp", True), ("3", "core/main.cpp", False)):
            self.edit('"version', f'"{text} version')
            self.started()
            self.call("run")
            self.assertEqual((self.clone / "build/default/edited").read_text(), files)
            self.assertEqual(self.started().count("cmake"), 2 if configured else 1)
        self.git("commit", "-am", "second")
        self.edit("version 1", "version 1 ")
        self.git("commit", "-am", "third")
        self.call("run")
        self.assertEqual((self.clone / "build/default/edited").read_text(), "")

    def test_bullet_in_float_is_built_only_for_who_may_run_it(self):
        in_float = self.clone / "build/default/taut-f32"
        for words in (["case", "hang", "jakobsen"], ["list", "solvers"], ["--help"]):
            self.call(*words)
            self.assertFalse(in_float.exists(), words)
        for words in (["case", "hang", "bullet:precision=float"], ["run", "hang"]):
            self.call(*words)
            self.assertTrue(in_float.exists(), words)
            in_float.unlink()

    def test_every_folder_of_sources_is_watched_and_no_scene_or_study(self):
        self.call("run")
        folders = {file.parent for top in ("cmake", "core", "bullet_ref", "experiments") for ending in ("cpp", "hpp", "cmake", "js", "css", "html")
                   for file in (REPOSITORY / top).rglob(f"*.{ending}")}
        self.assertGreater(len(folders), 30)
        files = [self.clone / folder.relative_to(REPOSITORY) / "source" for folder in folders]
        data = [self.clone / "experiments" / name / "mine.toml" for name in ("scenes", "studies")]
        for file in files + data:
            file.parent.mkdir(parents=True, exist_ok=True)
            file.touch()
        functions = re.findall(r"^(?:is_current|made_from)\(\) \{.*?\}$", (REPOSITORY / "taut").read_text(), re.MULTILINE | re.DOTALL)
        script = "\n".join(["home=$1", *functions, 'is_current "$home/build/default" built-programs'])
        stamp = self.clone / "build/default/built-programs"
        os.utime(stamp, (stamp.stat().st_mtime + 100, ) * 2)

        def is_current():
            return subprocess.run(["bash", "-c", script, "bash", self.clone]).returncode == 0

        for file in files + data:
            os.utime(file, (stamp.stat().st_mtime + 100, ) * 2)
            self.assertEqual(is_current(), file in data, file)
            os.utime(file, (0, 0))
        self.assertTrue(is_current())

    def test_what_does_not_compile_is_said_and_tried_again(self):
        self.call("run")
        self.edit("int main", "int main(")
        for _ in range(2):
            broken = self.call("run", expect=2)
            self.assertIn("main.cpp", broken.err)
            self.assertNotIn("version", broken.out)
        self.edit("int main(", "int main")
        self.assertIn("version 1", self.call("run").out)

    def test_a_copied_or_moved_clone_builds_its_own_sources(self):
        self.call("run")
        copy, moved = self.folder / "copy", self.folder / "moved"
        shutil.copytree(self.clone, copy, symlinks=True)
        self.assertIn(f"built from {copy}\n", self.call("run", clone=copy).out)
        self.assertIn(f"built from {self.clone}\n", self.call("run").out)
        self.clone.rename(moved)
        self.assertIn(f"built from {moved}\n", self.call("run", clone=moved).out)

    def test_paths_are_the_callers(self):
        elsewhere = self.folder / "elsewhere"
        elsewhere.mkdir()
        self.assertIn("results -\nword run\nword my study.toml\n", self.call("run", "my study.toml").out)
        there = self.call("run", "my study.toml", cwd=elsewhere)
        self.assertIn(f"results {self.clone}/results\nword run\nword my study.toml\n", there.out)
        self.assertIn("results mine\n", self.call("run", cwd=elsewhere, TAUT_RESULTS="mine").out)
        (elsewhere / "link").symlink_to(self.clone / "taut")
        done = subprocess.run([elsewhere / "link", "run"], cwd=elsewhere, capture_output=True, text=True, check=True)
        self.assertIn(f"built from {self.clone}\n", done.stdout)

    def test_a_user_who_is_not_root_needs_nobody_when_nothing_is_missing(self):
        if os.getuid() == 0:
            self.user = NOBODY
            for path in [self.log, *self.clone.rglob("*"), self.clone]:
                os.chown(path, NOBODY, NOBODY)
        self.assertIn("version 1", self.call("run").out)
        self.assertFalse({"sudo", "apt-get"} & set(self.started()))

    def test_what_is_missing_is_named(self):
        done = self.call("--no-install", "run", expect=2, MISSING="gnuplot-nox")
        self.assertRegex(done.err, r"gnuplot-nox +draws the plots")
        self.assertNotIn("libeigen3-dev", done.err)
        self.assertEqual(self.started(), ["dpkg-query"])

    def test_python_has_the_module_and_installs_what_a_script_names(self):
        script = self.folder / "script.py"
        script.write_text("import os, sys, taut\nprint('version', taut.version, sys.argv[1:], os.environ.get('TAUT_RESULTS'))\n")
        self.assertEqual(self.call("python", str(script), "a b").out, "version 1 ['a b'] None\n")
        self.assertFalse((self.clone / "build/default/taut").exists(), "the program was not asked for")
        self.started()
        again = self.call("python", "-c", "import taut; print(taut.version)", cwd=self.folder)
        self.assertEqual((again.out, again.err, self.started()), ("1\n", "", []))
        # Change the size as well, since Python reuses a compiled file if time (in seconds) and size are the same.
        (self.clone / "experiments/taut_module").write_text("version = 2  # changed\n")
        self.assertIn(f"version 2 [] {self.clone}/results\n", self.call("python", str(script), cwd=self.folder).out)
        self.call("--no-install", "python", "-c", "pass", MISSING="python3-matplotlib")
        script.write_text("import matplotlib\n")
        done = self.call("--no-install", "python", str(script), expect=2, MISSING="python3-matplotlib")
        self.assertRegex(done.err, r"python3-matplotlib +charts")
        self.edit("version 1", "version 3")
        done = self.call("--no-install", "python", expect=2, MISSING="python3-numpy")
        self.assertRegex(done.err, r"python3-numpy +the arrays")
        self.assertIn("version 3", self.call("--no-install", "run", MISSING="python3-numpy").out, "which needs none of it")

    def test_two_calls_at_once_build_once(self):
        self.call("run")
        self.edit("version 1", "version 2")
        calls = [self.start("run") for _ in range(2)]
        for process in calls:
            out, err = process.communicate(timeout=120)
            self.assertEqual(process.returncode, 0, err)
            self.assertIn("version 2", out)

    def test_what_a_change_cannot_turn_red_is_left_out(self):
        (self.clone / "tests/source").mkdir()
        shutil.copy2(REPOSITORY / "tests/source/changed.py", self.clone / "tests/source")
        self.git("init")
        self.git("add", ".")
        self.git("commit", "-m", "first")
        for words in (["--changed"], ["--changed", "HEAD"], ["--changed", "-V"]):
            changed = self.call("test", *words)
            self.assertRegex(changed.out, r" layers \.+ +Passed")
            self.assertNotIn(" one .", changed.out)
            self.assertIn("  not run: what no change reaches", changed.err)
        self.assertIn("no commit 'nonsense'", self.call("test", "--changed", "nonsense", expect=2).err)

    def test_a_test_run_names_what_was_skipped(self):
        quick = self.call("test")
        self.assertIn("one", quick.out)
        self.assertNotIn("planted", quick.out)
        self.assertNotIn("random", quick.out)
        self.assertRegex(quick.err, r"(?s)skipped:\n  default: absent\n  default: test_disk: needs a disk\n  not run: clang\+\+ with sanitizers, planted errors, random")
        whole = self.call("test", "--all")
        self.assertEqual(len(re.findall(r"planted \.+ +Passed", whole.out)), 1)
        self.assertLess(whole.out.index("build/asan\n"), whole.out.index("planted ."), "which needs to know how long the tests take")
        self.assertEqual(len(re.findall(r"random \.+ +Passed", whole.out)), 2, "with the program and with libFuzzer")
        self.assertIn("build/asan\n", whole.out)
        self.assertIn("default: absent\n  default: test_disk: needs a disk\n", whole.err)
        slow = self.call("test", "--all", SECONDS="2700")
        self.assertNotIn("planted .", slow.out)
        self.assertIn("default: planted errors: what came before took 45 min (ctest --test-dir build/default -L mutation)\n", slow.err)
        cmake = self.clone / "CMakeLists.txt"
        good = cmake.read_text()
        cmake.write_text(good.replace("planted COMMAND true", "planted COMMAND sh -c \"seq 100; false\""))
        self.call("test")
        self.assertRegex(self.call("test", "--all", expect=1).err, r"FAILED:\n  default: .* planted \.+\*\*\*Failed .*\n"
                         r"(  default: \d+\n){14}  default: 56\n(  default: \d+\n){43}  default: 100\n$")
        cmake.write_text(good.replace("enable_testing()", 'enable_testing()\nif(TAUT_SANITIZE)\nmessage(FATAL_ERROR "not here")\nendif()'))
        broken = self.call("test", "--all", expect=1)
        self.assertTrue(broken.err.endswith("FAILED:\n  asan: the build\n"), broken.err)
        self.assertIn("not here", broken.err)
        self.assertRegex(broken.out, r"planted \.+ +Passed", "what follows runs all the same")


if __name__ == "__main__":
    unittest.main(verbosity=2)
