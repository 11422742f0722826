#!/usr/bin/env python3
"""Every micro-benchmark runs, and its measurements are plausible: bench_test.py PROGRAM"""
import json
import math
import subprocess
import sys

done = subprocess.run([sys.argv[1], "--benchmark_min_time=0.0001", "--benchmark_format=json", "--benchmark_filter=/(0|32|64)/|body/cuts:3"],
                      stdout=subprocess.PIPE, check=True)
rows = {row["name"]: row for row in json.loads(done.stdout)["benchmarks"]}
bound = rows["projection/0/in registers float"]["projection"]
for name, row in rows.items():
    assert not row.get("error_occurred"), (name, row)
    kind = name.split("/")[0]
    counters = {"projection": ["projection"], "iteration": ["iteration", "sweeps"], "contact": ["sweep", "in_sweep", "in_step", "touching"], "threads": ["two_threads"],
                "body": ["read_s", "make_s", "refit_s", "nearest_at_1cm_s", "nearest_anywhere_s", "first_hit_s", "first_hit_deforming_s"]}[kind]
    for counter in counters:
        assert math.isfinite(row[counter]), (name, counter)
    if kind == "projection" and "threads" not in name:
        assert bound / 2 < row["projection"] < 1e-5, (name, row["projection"], "s; faster than the arithmetic alone, or slower than any machine")
    if kind == "iteration" and not any(cheap in name for cheap in ("jakobsen", "xpbd")):
        assert 1 < row["sweeps"] < 1e5, (name, row["sweeps"], "sweeps of Jakobsen's in float")
    if name.startswith("contact/64/plane"):
        assert row["touching"] > 0.9, (name, row["touching"])
    elif kind == "contact" and "crumple" not in name:
        assert 0.02 < row["touching"] < 0.9, (name, row["touching"])
    if kind == "body":
        assert 0 < row["nearest_at_1cm_s"] < 1e-3 and row["triangles"] == 512, (name, row)
expected = {"projection": 14, "iteration": 16, "contact": 26, "body": 1}
for kind, least in expected.items():
    found = sum(name.startswith(kind) for name in rows)
    assert found >= least, f"{found} benchmarks of {kind}; there were {least}"
print(len(rows), "benchmarks ran")
