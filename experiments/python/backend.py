"""The build backend that pip calls to make a wheel from this tree (PEP 517). CMake builds the module in build/default,
as ./taut does; for a Python other than that of build/default, it builds in build/<tag of the Python>."""

import base64
import fcntl
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import tomllib
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SUFFIX = sysconfig.get_config_var("EXT_SUFFIX")  # ".cpython-311-x86_64-linux-gnu.so"
DATA = {"scenes": ROOT / "experiments/scenes", "references": ROOT / "results/references"}


def call(*words):
    try:
        done = subprocess.run([*map(str, words)], cwd=ROOT, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    except FileNotFoundError:
        raise SystemExit(f"taut: {words[0]} is not installed; `./taut python` installs what the build needs") from None
    if done.returncode:
        raise SystemExit(f"taut: {' '.join(map(str, words))} failed; `./taut python` installs what the build needs\n{done.stdout[-4000:]}")
    return done.stdout


def built():
    """Builds the module and returns the build folder."""
    debian = pathlib.Path("/usr/bin/python3")
    say_suffix = "import sysconfig; print(sysconfig.get_config_var('EXT_SUFFIX'))"
    own = not debian.exists() or call(debian, "-c", say_suffix).strip() == SUFFIX
    folder = ROOT / "build" / ("default" if own else sys.implementation.cache_tag)
    options = [] if own else [f"-DPython3_EXECUTABLE={sys._base_executable}"]
    if not (folder / "build.ninja").exists():
        options.append("-DTAUT_TESTS=OFF")
    folder.parent.mkdir(exist_ok=True)
    with open(f"{folder}.lock", "w") as lock:  # ./taut waits for this lock
        fcntl.flock(lock, fcntl.LOCK_EX)
        call("cmake", "--preset", "default", "-B", folder, "-DTAUT_PYTHON=ON", *options)
        call("cmake", "--build", folder, "--parallel", os.cpu_count(), "--target", "taut_python")
    return folder


def metadata():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    version = re.search(r"project\(taut VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {version}", f"Summary: {project['description']}",
             f"License: {project['license']['text']}", f"Requires-Python: {project['requires-python']}"]
    lines += [f"Requires-Dist: {one}" for one in project["dependencies"]]
    for extra, packages in project["optional-dependencies"].items():
        lines += [f"Provides-Extra: {extra}", *(f"Requires-Dist: {one}; extra == '{extra}'" for one in packages)]
    return f"{project['name']}-{version}", "\n".join(lines) + "\n"


class Wheel:
    def __init__(self, path):
        self.file, self.record = zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED), []

    def add(self, name, data):
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        self.record.append(f"{name},sha256={digest},{len(data)}\n")
        self.file.writestr(name, data)

    def close(self, info):
        self.file.writestr(f"{info}/RECORD", "".join(self.record) + f"{info}/RECORD,,\n")
        self.file.close()


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    folder = built()
    name, about = metadata()
    tag = f"cp{sys.version_info.major}{sys.version_info.minor}"
    tag += f"-{tag}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"
    wheel = Wheel(pathlib.Path(wheel_directory) / f"{name}-{tag}.whl")
    for file in sorted((ROOT / "experiments/python/package").iterdir()):
        if file.is_file():
            wheel.add(f"taut/{file.name}", file.read_bytes())
    with tempfile.TemporaryDirectory() as scratch:
        module = shutil.copy(folder / f"python/taut/_taut{SUFFIX}", scratch)
        call("strip", "--strip-debug", module)
        wheel.add(f"taut/_taut{SUFFIX}", pathlib.Path(module).read_bytes())
    for kind, where in DATA.items():
        for file in sorted(where.rglob("*")):
            if file.suffix in (".toml", ".obj", ".npy", ".json"):
                wheel.add(f"taut/data/{kind}/{file.relative_to(where)}", file.read_bytes())
    info = f"{name}.dist-info"
    wheel.add(f"{info}/METADATA", about.encode())
    wheel.add(f"{info}/WHEEL", f"Wheel-Version: 1.0\nGenerator: taut\nRoot-Is-Purelib: false\nTag: {tag}\n".encode())
    wheel.add(f"{info}/LICENSE", (ROOT / "LICENSE").read_bytes())
    wheel.close(info)
    return f"{name}-{tag}.whl"


def build_sdist(sdist_directory, config_settings=None):
    raise SystemExit("taut: there is no source distribution; `pip install FOLDER` builds from a clone")
