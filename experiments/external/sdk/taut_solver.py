"""The protocol taut-solver for Python 3.8 and later, without dependencies: copy this file beside your solver.

    class Mine:
        name, version = "mine", "1.0"         # change the version with every change that alters results
        params = {"iterations": {"type": "integer", "min": 1, "max": 1000, "default": 8, "doc": "Sweeps"}}
        def __init__(self, scene, params): ...  # scene: the scene file as a dict; params["iterations"]
        def load(self, x, v): ...               # start here: array('d') of 3n [m] and 3n [m/s]
        def step(self, t, dt): ...              # advance from t to t + dt [s]
        def store(self): ...                    # returns x and v: 3n numbers each (array, list, numpy)

    taut_solver.serve(Mine)

Optional:
    protocol                 the newest version that the solver knows; scenes that need a newer one are not sent to it:
        "taut-solver/1"      rigid links; planes, balls and boxes (the default)
        "taut-solver/2"      also elastic links (stiffness), bending stiffness (bending), capsules, seams, pins that let go
        "taut-solver/3"      also bodies of triangles
        "taut-solver/4"      also bodies that deform
        "taut-solver/5"      also a membrane (membrane)
        "taut-solver/6"      also damping of links (link_damping) and of a membrane
    summary, source          texts
    unmeasurable             why its CPU time means nothing, "it computes on a GPU"; then no cost is published
    cannot(scene, params)    static method: a list of reasons why the scene would be misread; empty if it is read correctly
    plan()                   list of {"pass", "items", "repeats", "bytes", "projections"}
    settings()               dict of texts
Standard output belongs to the protocol: print() goes to standard error here. MIT licence, as taut.
"""

import array
import json
import os
import sys
import time

PROTOCOL = "taut-solver/1"


def serve(solver):
    requests, answers = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # print() must not write into the protocol
    state = {"live": None, "vertices": 0}

    def hello(request):
        told = {key: getattr(solver, key) for key in ("summary", "source", "unmeasurable") if hasattr(solver, key)}
        return {"protocol": getattr(solver, "protocol", PROTOCOL), "name": solver.name, "version": solver.version, "params": getattr(solver, "params", {}), **told}

    def scene(request):
        with open(request["file"], encoding="utf-8") as file:
            content = json.load(file)
        reasons = solver.cannot(content, request["params"]) if hasattr(solver, "cannot") else []
        if reasons:
            return {"cannot": reasons}
        state.update(live=solver(content, request["params"]), vertices=content["vertices"])
        told = {key: getattr(state["live"], key)() for key in ("plan", "settings") if hasattr(solver, key)}
        return {"vertices": content["vertices"], **told}

    def load(request):
        values = array.array("d", requests.read(request["bytes"]))
        state["live"].load(values[:len(values) // 2], values[len(values) // 2:])
        return {}

    def step(request):
        before = time.process_time_ns()
        for k in range(request["count"]):
            state["live"].step(request["t"] + k * request["dt"], request["dt"])
        return {"cpu_ns": time.process_time_ns() - before}

    def store(request):
        x, v = state["live"].store()
        state["bytes"] = array.array("d", x).tobytes() + array.array("d", v).tobytes()
        return {"bytes": len(state["bytes"])}

    known = {f.__name__: f for f in (hello, scene, load, step, store)}
    for line in requests:
        state["bytes"] = b""
        try:
            request = json.loads(line)
            if request["op"] not in known:
                raise ValueError(f"unknown op {request['op']!r}")
            answer = known[request["op"]](request)
        except Exception as error:  # also MemoryError: the answer starts with its name
            answer = {"error": f"{type(error).__name__}: {error}"}
        answers.write(json.dumps(answer).encode() + b"\n" + state["bytes"])
        answers.flush()
