#!/usr/bin/env python3
"""`pip install .` installs the module and its data into an environment without a network.

Usage: environments_test.py BUILD [TEST...]"""

import os
import pathlib
import subprocess
import sys
import venv

import module


class Environments(module.Case):
    def call(self, *words, expect=0):
        # Cuts off the network where the system permits it; pip gets an unusable index in any case.
        cut_off = ["unshare", "--net"] if os.getuid() == 0 and subprocess.run(["unshare", "--net", "true"], capture_output=True).returncode == 0 else []
        environment = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "PIP_", "TAUT_"))}
        done = subprocess.run([*cut_off, *map(str, words)], cwd=self.folder, env={**environment, "PIP_INDEX_URL": "http://localhost:9", "PIP_RETRIES": "0"},
                              text=True, capture_output=True, timeout=280)
        self.assertEqual(done.returncode, expect, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def test_pip_installs_it_without_a_network(self):
        if module.BUILD != module.TREE / "build/default":
            self.skipTest("pip builds in build/default, and this is another build")
        place = self.folder / "an environment"
        try:
            venv.create(place, system_site_packages=True, with_pip=True)
        except subprocess.CalledProcessError:
            self.skipTest("python3-venv is not installed")
        self.call(place / "bin/python", "-m", "pip", "install", module.TREE)
        self.assertEqual(sorted(path.name for path in module.TREE.glob("*.egg-info")), [], "the tree is as it was")
        said = self.call(place / "bin/python", "-c", "import taut; print(taut.__file__); run = taut.simulate('hang', 'bullet', duration=0.1)\n"
                         "print(run.status, run.record['digest'], len(taut.scenes()), run.record['values']['reference.rms'])")
        file, run = said.splitlines()
        status, digest, scenes, reference = run.split()
        package = pathlib.Path(file).parent
        self.assertTrue(package.is_relative_to(place), file)
        shipped = [path.stem for path in (module.TREE / "experiments/scenes").glob("*.toml")]
        self.assertEqual((status, int(scenes)), ("ok", len(shipped)))
        own = self.python("import taut\nrun = taut.simulate('hang', 'bullet', duration=0.1)\nprint(run.record['digest'], run.record['values']['reference.rms'])")
        self.assertEqual([digest, reference], own.stdout.split(), "references came along, too")
        self.assertTrue((package / "data/scenes/disc.obj").exists())
        self.assertLess(next(package.glob("_taut*.so")).stat().st_size, 20e6, "without what debuggers read")
        self.assertIn("Version: ", self.call(place / "bin/python", "-m", "pip", "show", "taut"))
        self.call(place / "bin/python", "-m", "pip", "uninstall", "-y", "taut")
        self.assertFalse(package.exists())

    def test_what_is_missing_is_said(self):
        done = self.python("sys.modules['numpy'] = None\nimport taut", expect=1)
        self.assertIn("ImportError: taut needs numpy: apt install python3-numpy", done.stderr)
        done = self.python("sys.modules['pandas'] = None\nimport pathlib, taut\npathlib.Path('results.db').touch()\ntaut.results('.')", expect=1)
        self.assertIn("ImportError: taut.results needs pandas: apt install python3-pandas", done.stderr)


if __name__ == "__main__":
    module.main()
