"""taut: a testbed for cloth solvers, from Python.

    scene = taut.scene("hang", {"cloth.grid": [16, 16]})     a shipped name, a path, or TOML text
    run = taut.simulate(scene, "jakobsen:iterations=8")      a Run: status, values, x, series
    taut.score(scene, positions, fps=24)                     the same for arrays of another program
    taut.predict(scene, "jakobsen", error=0.01)              strain at rest without a run: settings
    taut.verify("jakobsen")                                  the conformance suite: numbers, closed forms
    taut.results("results/runs")                             a results file as a pandas.DataFrame
    taut.scenes(), taut.solvers(), taut.metrics()            what there is

    @taut.solver("mine", parameters={"iterations": 8})       a solver in Python, for trying out
    class Mine: ...

help(taut.simulate) and so on give shapes, units and errors.
"""

import os
import pathlib
import sqlite3

from . import _taut

_taut.need_main_interpreter()
try:
    import numpy as _numpy  # for the arrays of the module  # noqa: F401
except ModuleNotFoundError as missing:
    raise ImportError("taut needs numpy: apt install python3-numpy, or an environment that has it", name="numpy") from missing
if (_data := pathlib.Path(__file__).parent / "data").is_dir():  # only an installed package has its own data
    _taut.set_data_folder(_data)

from ._taut import Diagnostic, InputError, Run, Scene, metrics, predict, scene, scenes, score, simulate, solvers, verify  # noqa: E402

__all__ = ["Diagnostic", "InputError", "Run", "Scene", "metrics", "predict", "results", "scene", "scenes", "score", "simulate",
           "solver", "solvers", "verify"]
for _class in (Diagnostic, Run, Scene):
    _class.__module__ = "taut"


def solver(name, *, parameters=None):
    """Makes a class a solver, in this process: for trying out, not for timing.

    name        letters, digits, '-' and '_'; the same name again replaces it, so a cell may run twice.
    parameters  name -> default: a number, a text, or a tuple of texts of which the first is the
                default. Each becomes an attribute of the object, from "mine:iterations=4" or its default.

    The class has no arguments to construct it, and
        load(scene, x, v)   start here: a taut.Scene, (n, 3) m, (n, 3) m/s; the arrays are its own
        step(t, dt)         advance from t to t + dt [s]; vertices scene.pins have to be at
                            scene.pin_positions(t + dt)
        store()             returns x and v, (n, 3) each; they are copied
        unsupported(scene)  optional, a static method: why it would misread a scene, a list of texts

    Raises InputError if the name is taken, a method is missing or a default has another type.
    taut.simulate() raises whatever the methods raise.
    """

    def register(cls):
        _taut.register_solver(name, cls, dict(parameters or {}))
        return cls

    return register


def results(folder=None):
    """The view `results` of a results file as a pandas.DataFrame: a row for each value of each case.

    folder  the folder of `taut run --out`, or a results.db itself; None: results/runs, in $TAUT_RESULTS
            if that is set. It is only read.

    Columns: experiments/results/README.md. Raises InputError if there is no results file.
    """
    try:
        import pandas  # here, as it takes longer than all else
    except ModuleNotFoundError as missing:
        raise ImportError("taut.results needs pandas: apt install python3-pandas", name="pandas") from missing
    path = pathlib.Path(folder or pathlib.Path(os.environ.get("TAUT_RESULTS") or "results", "runs"))
    file = path / "results.db" if path.is_dir() else path
    if not file.is_file():
        _taut.fail_in(path, f"no results file, seen from {os.getcwd()}")
    try:
        connection = sqlite3.connect(f"{file.resolve().as_uri()}?mode=ro", uri=True)
        try:
            return pandas.read_sql("select * from results", connection)
        finally:
            connection.close()
    except (sqlite3.Error, pandas.errors.DatabaseError) as error:
        _taut.fail_in(path, f"no results file of taut: {error}")
