"""A model with every part that taut-report/2 has, made up, and one that is hostile: material of the browser tests."""

import base64
import copy
import os
import shutil
import subprocess
import tempfile

STATUS = {"ok": ("✓", False, "#2F9E77"), "unsettled": ("~", False, "#F2BF4B"), "exploded": ("×", True, "#C9423B"),
          "timeout": ("T", True, "#7A5BB5")}
SWEEPS = [1, 2, 4, 8, 16, 32]
STEPS = [1 / 240, 1 / 120, 1 / 60, 1 / 30]
AXIS = {"iterations": {"metric": "iterations", "title": "sweeps per step", "unit": "", "scale": 1, "axis": "log"},
        "stretch.rms": {"metric": "stretch.rms", "title": "RMS stretch", "unit": "%", "scale": 100, "axis": "log"},
        "penetration.peak": {"metric": "penetration.peak", "title": "penetration", "unit": "mm", "scale": 1000, "axis": "log"},
        "dt": {"metric": "dt", "title": "time step", "unit": "ms", "scale": 1000, "axis": "log"},
        "cpu.per_second": {"metric": "cpu.per_second", "title": "CPU time per simulated second", "unit": "ms", "scale": 1000,
                           "axis": "log"}}
PIXEL = ("data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAA"
         "AABJRU5ErkJggg==")


def video():
    """Two seconds of a test picture as a data URI; None without ffmpeg."""
    if not shutil.which("ffmpeg"):
        return None
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "test.mp4")
        subprocess.run(["ffmpeg", "-v", "error", "-f", "lavfi", "-i", "testsrc=s=320x180:r=30:d=2", "-pix_fmt", "yuv420p",
                        "-g", "10", "-movflags", "+faststart", file], check=True)
        with open(file, "rb") as read:
            return "data:video/mp4;base64," + base64.b64encode(read.read()).decode()


def case(scene, solver, sweeps, dt, status="ok", stretch=None, depth=None):
    brief = f"1 × {sweeps}"
    settings = f"{solver}:iterations={sweeps},substeps=1"
    values = {name: v for name, v in (("stretch.rms", stretch), ("penetration.peak", depth)) if v is not None}
    key = f"{scene[:2]}{solver[:2]}{sweeps:03d}{round(dt * 1e6):06d}"
    return {"key": key, "id": f"{scene} dt={dt:.6g} {settings}", "scene": scene, "solver": solver, "settings": settings,
            "parameters": {"iterations": str(sweeps), "substeps": "1", "cmd": "python3 a.py, b=1"}, "brief": brief, "studies": ["sample"], "dt": dt, "steps": round(2 / dt), "vertices": 81, "links": 272,
            "projections": 272 * sweeps, "status": status, "values": values,
            "command": f"taut case {scene} {settings} --set 'time.dt={dt!r}'",
            **({"reason": "gained energy", "step": 7, "vertex": 3} if STATUS[status][1] else {})}


def evidence(values, metric="stretch.rms", window="last second"):
    return {"metric": metric, "window": window, "rule": "values side by side", "scenes": sorted({v["scene"] for v in values}),
            "settings": [{"solver": s, "text": "1 × 8, time step 1/60 s"} for s in ("jakobsen", "bullet")], "values": values,
            "statuses": {"jakobsen": {"ok": 6}, "bullet": {"ok": 5, "exploded": 1}}, "cases": [v["case"] for v in values],
            "left_out": "The case at 32 sweeps failed."}


def claim(name, kind, about, sentence, values, **more):
    return {"id": name, "kind": kind, "about": about, "sentence": sentence, "sure": "single run", "basis": [evidence(values)], **more}


def scene_parts(model, scene):
    """Cases, a convergence chart with a failure, a penetration chart with zeros, a cost chart, two maps and claims."""
    series, depths, costs = [], [], []
    for solver, scale in (("jakobsen", 0.05), ("bullet", 0.15)):
        lines = [[], [], []]
        for sweeps in SWEEPS:
            for dt in STEPS:
                failed = solver == "bullet" and (sweeps, dt) in ((32, STEPS[2]), (1, STEPS[3]), (2, STEPS[3]))
                odd = solver == "jakobsen" and (sweeps, dt) == (1, STEPS[3])
                one = case(scene, solver, sweeps, dt, "exploded" if failed else "unsettled" if odd else "ok",
                           None if failed else scale / sweeps * dt / STEPS[2],
                           None if failed else 0.0 if sweeps > 4 else 0.004 / sweeps)
                model["cases"].append(one)
                if dt != STEPS[2]:
                    continue
                point = {"x": sweeps, "y": one["values"].get("stretch.rms"), "status": one["status"], "case": one["key"],
                         "failed": failed, "zero": False, "name": one["brief"]}
                depth = one["values"].get("penetration.peak")
                cost = sweeps * 0.001 * (1 if solver == "jakobsen" else 3)
                one["cost"] = {"cpu.per_second": {"low": cost * 0.9, "mid": cost, "high": cost * 1.2, "n": 9}}
                lines[0].append(point)
                lines[1].append({**point, "y": depth, "zero": depth == 0})
                lines[2].append({**point, "x": cost, "x_low": cost * 0.9, "x_high": cost * 1.2})
        head = {"solver": solver, "label": solver.title(), "variant": 0}
        series.append({**head, "join": True, "points": lines[0]})
        depths.append({**head, "join": True, "points": lines[1]})
        costs.append({**head, "join": False, "points": lines[2]})
        cells = [{"column": STEPS.index(c["dt"]), "row": SWEEPS.index(int(c["brief"].split()[-1])), "status": c["status"],
                  "case": c["key"]} for c in model["cases"] if (c["scene"], c["solver"]) == (scene, solver)]
        del cells[9]
        model["maps"].append({"id": f"{scene}-map-{solver}", "scene": scene, "solver": solver, "label": solver.title(),
                              "title": "How cases end", "study": "sample", "x": {**AXIS["dt"], "values": STEPS},
                              "y": {**AXIS["iterations"], "values": SWEEPS}, "cells": cells,
                              "counts": {"ok": 22}})
    front = [{k: p[k] for k in ("x", "y", "case")} for p in costs[0]["points"]]
    sweeps = {**AXIS["iterations"], "values": SWEEPS}
    model["charts"] += [
        {"id": f"{scene}-convergence", "scene": scene, "title": "Stretch over sweeps", "caption": "Last second.", "kind": "convergence",
         "x": sweeps, "y": AXIS["stretch.rms"], "held": "time step 1/60 s", "series": series,
         "theory": {"slope": -1, "factor": 0.04, "text": "theory: 1 / sweeps"}, "floor": {"y": 0.001, "text": "reference"}},
        {"id": f"{scene}-penetration", "scene": scene, "title": "Penetration over sweeps", "caption": "", "kind": "contact",
         "x": sweeps, "y": AXIS["penetration.peak"], "series": depths},
        {"id": f"{scene}-cost", "scene": scene, "title": "Stretch over cost", "caption": "", "kind": "cost",
         "x": AXIS["cpu.per_second"], "y": AXIS["stretch.rms"], "series": costs, "front": front},
        {"id": f"{scene}-zeros", "scene": scene, "title": "Tunnelled", "caption": "", "kind": "contact", "x": sweeps,
         "y": AXIS["penetration.peak"], "zeros": True,
         "series": [{**depths[0], "points": [{**p, "y": 0, "zero": True} for p in depths[0]["points"]]}]},
        {"id": f"{scene}-series", "scene": scene, "title": "Stretch over time", "caption": "", "kind": "series",
         "x": {**AXIS["dt"], "metric": "t"}, "y": AXIS["stretch.rms"],
         "series": [{"solver": "jakobsen", "label": "Jakobsen", "variant": 0, "t": [0, 1, 2], "y": [0, 0.01, 0.02]}]}]
    values = [{"scene": scene, "solver": c["solver"], "value": c["values"].get("stretch.rms"), "n": 1, "status": c["status"],
               "case": c["key"], "text": f"{100 * c['values'].get('stretch.rms', 0):.2g} %"}
              for c in model["cases"] if c["scene"] == scene and c["brief"] in ("1 × 8", "1 × 32") and c["dt"] == STEPS[2]]
    model["claims"] += [claim(f"note-{scene}", "note", scene, f"On {scene}, Jakobsen leaves a third of Bullet's stretch.", values),
                        claim(f"chart-{scene}", "note", scene, f"Both follow theory on {scene}.", values)]
    return values


def make():
    model = {"schema": "taut-report/2",
             "meta": {"title": "Jakobsen and Bullet", "question": "Which solver stretches less?", "build": {"program": "abc", "toolchain": "g++"},
                      "made": "2026-11-22 13:26 UTC", "machine": "a machine", "command": "taut run sample", "cases": 96, "planned": 97,
                      "policy": {"single run": "the same bits on the same build"}},
             "solvers": [{"id": "jakobsen", "title": "Jakobsen", "summary": "Verlet", "source": "GDC 2001", "settings": "substeps=1",
                          "colour": {"light": "#0B6BCB", "dark": "#5AA9F5"}, "marker": "circle", "dash": ""},
                         {"id": "bullet", "title": "Bullet", "summary": "btSoftBody", "source": "libbullet", "settings": "substeps=1",
                          "colour": {"light": "#C8470C", "dark": "#FF8A54"}, "marker": "square", "dash": "9 4",
                          "unsupported": [{"reason": "moving pins", "scenes": ["twist"]}]}],
             "statuses": [{"id": s, "title": s, "glyph": g, "help": "help of " + s, "failed": f, "colour": {"light": c, "dark": c},
                           "ink": {"light": "#1A1A19" if s == "unsettled" else "#FFFFFE", "dark": "#1A1A19" if s == "unsettled" else "#FFFFFE"}}
                          for s, (g, f, c) in STATUS.items() if s != "timeout"],
             "metrics": {name: {"title": a["title"], "help": "what " + a["title"] + " is", "unit": a["unit"], "scale": a["scale"],
                                "axis": a["axis"], "window": "last second" if name == "stretch.rms" else "", "better": "less"}
                         for name, a in AXIS.items()},
             "claims": [], "scenes": [], "charts": [], "maps": [], "films": [], "tables": [], "cases": []}
    for scene in ("hang", "ball"):
        values = scene_parts(model, scene)
        model["scenes"].append({
            "id": scene, "title": scene.title(), "summary": f"The scene {scene}", "studied": True, "claims": [f"note-{scene}"],
            "charts": [f"{scene}-{kind}" for kind in ("convergence", "penetration", "zeros", "series")],
            "maps": [f"{scene}-map-jakobsen", f"{scene}-map-bullet"], "statuses": {"jakobsen": {"ok": 23, "unsettled": 1}, "bullet": {"ok": 21, "exploded": 3}},
            "facts": [{"name": "vertices", "value": "81"}],
            "resolved_settings": {"caption": "Settings each solver used for this scene",
                         "columns": [{"solver": s, "case": values[i]["case"], "text": "1 × 8"} for i, s in ((0, "jakobsen"), (-1, "bullet"))],
                         "rows": [{"name": "projection", "values": ["exact", "sqrt-free"], "differs": True}]}})
        model["tables"].append({"id": f"levels-{scene}", "title": "Cost of an error", "caption": "per simulated second",
                                "columns": [{"title": "to reach"}, {"title": "Jakobsen"}],
                                "rows": [["1 %", {"text": "8 ms", "value": 0.008, "low": 0.0076, "high": 0.0085, "case": values[0]["case"], "sure": "clear"}]]})
    hang = next(s for s in model["scenes"] if s["id"] == "hang")
    hang["material"] = {"aspect": 1, "rows": [{"solver": "jakobsen", "moments": [{"t": 1, "rms": 0.01, "text": "1 %", "image": PIXEL}]}]}
    if film := video():
        keys = [c["key"] for c in model["cases"] if c["scene"] == "hang" and c["brief"] == "1 × 8" and c["dt"] == STEPS[2]]
        t = [k / 30 for k in range(61)]
        model["films"].append({
            "id": "film-hang", "scene": "hang", "type": "video/mp4", "src": film, "poster": PIXEL, "poster_t": 1, "duration": 2, "frame": 1 / 30,
            "speed": 1, "alt": "hang, two solvers", "caption": "1 × 8 each", "panels": [
                {"solver": s, "settings": "1 × 8", "case": k} for s, k in zip(("jakobsen", "bullet"), keys)],
            "bar": {"title": "strain", "stops": ["#0050A0", "#FFFFFF", "#B00018"], "ticks": [{"at": 0, "text": "−5 %"}, {"at": 1, "text": "5 %"}]},
            "tracks": [{"metric": "stretch.rms", "title": "RMS stretch", "series": [
                {"solver": s, "label": s.title(), "t": t, "y": [x * scale for x in t]} for s, scale in (("jakobsen", 0.01), ("bullet", 0.02))]}]})
        hang["films"] = ["film-hang"]
        for one in model["cases"]:
            if one["key"] in keys:
                one["film"] = "film-hang"
    model["scenes"].append({"id": "twist", "title": "Twist", "summary": "A strip, wound up", "studied": False,
                            "refusals": [{"solver": "bullet", "reason": "moving pins"}]})
    tile = {"metric": "stretch.rms", "heading": "Stretch", "bars": [{"solver": "jakobsen", "value": 0.006, "text": "0.6 %"},
                                                                    {"solver": "bullet", "value": None, "text": "no value"}]}
    model["claims"] += [claim("head", "headline", "all", "At 1 × 8 Jakobsen leaves 1/3 of the stretch of Bullet.", values, strong=["1/3 of the stretch"],
                              film="film-hang" if model["films"] else None),
                        claim("tile", "tile", "all", "At 1 × 8, last second.", values, **tile),
                        claim("fails", "note", "failures", "Bullet failed 3 of 24 cases.", values),
                        claim("only", "note", "only", "With tethers, which Bullet lacks, 0.1 %.", values),
                        claim("costs", "note", "cost", "Never reached by Bullet.", values),
                        claim("differ", "note", "differences", "B leaves less than A.", values)]
    control = {"low": 0.97, "mid": 1, "high": 1.04, "n": 9}
    model["cost"] = {"machine": "a machine", "claims": ["costs"], "tables": ["levels-hang"], "scenes": [
        {"scene": s, "control": control, "noisy": s == "ball", "noise": "Two runs of identical code differed by up to 4 %.", "charts": [f"{s}-cost"],
         "tables": [f"levels-{s}"] if s == "ball" else []} for s in ("hang", "ball")]}
    rows = [{"section": "One", "statement": "a link returns", "source": "Jakobsen", "subject": f"{s}:iterations=64,projection=exact,precision=double",
             "expected": "0.1 m (at t=0.123456789012345)", "measured": "error-at-the-end=0.100000000000001",
             "verdict": v, **({"why": "no square root"} if v == "deviates" else {})} for s, v in (("jakobsen", "passed"), ("bullet", "deviates"))]
    model["truths"] = {"truths": 1, "findings": 2, "verdicts": {"passed": 1, "deviates": 1}, "rows": rows}
    model["regressions"] = {"cases": 3, "values": 30, "rows": [{"study": "regression", "case": "hang", "change": "0.012 -> 0.013"}]}
    model["differences"] = {"a": "results", "b": "other", "claims": ["differ"], "tables": ["levels-ball"]}
    model["method"] = {"studies": [{"name": "sample", "question": "Which?", "cases": 96, "planned": 97, "unequal": "Substeps differ."}],
                       "facts": [{"name": "processor", "value": "x"}], "limits": ["Real cloth."]}
    model["missing"] = [{"section": "films", "text": "No film of ball.", "command": "taut render ball"}]
    model["left_out"] = [{"file": "results/x.jsonl", "why": "cut off"}]
    return model


def bare():
    """The least that a page may be of: one solver, one scene, cases without values, nothing else."""
    full = make()
    return {key: full[key] for key in ("schema", "statuses", "metrics")} | {
        "meta": {k: full["meta"][k] for k in ("title", "build", "made", "command", "cases", "planned")},
        "solvers": full["solvers"][:1], "cases": [{**case("hang", "jakobsen", 1, 5e-5, "exploded")}], "claims": [],
        "scenes": [{"id": "hang", "title": "Hang", "summary": "A sheet", "studied": True}], "method": {"limits": ["Real cloth."]}}


HOSTILE = ["<img src=x onerror=\"window.harmed=1\">", "</script><script>window.harmed=1</script>", "\"'`&amp;{{d3.min.js}}${1}",
           "abc\u202egnp.exe\u200f \u2067rtl", "=1+1", "letters" * 1500, "__proto__", "constructor"]


def hostile():
    """The sample with hostile texts in every place that a user can name: scenes, solvers, questions, settings, statuses."""
    model = copy.deepcopy(make())
    texts = iter(HOSTILE * 1000)

    def spoil(node):
        for key, value in list(node.items()) if isinstance(node, dict) else list(enumerate(node)):
            if isinstance(value, (dict, list)):
                if key not in ("colour", "ink", "values", "bars", "stops", "metrics"):
                    spoil(value)
            elif isinstance(value, str) and key in TEXTS:
                node[key] = next(texts)
    TEXTS = {"title", "question", "summary", "source", "settings", "reason", "text", "caption", "held", "label", "name", "brief", "help",
             "machine", "heading", "rule", "noise", "statement", "subject", "expected", "measured", "why", "change", "command", "value", "left_out"}
    spoil(model)
    return model
