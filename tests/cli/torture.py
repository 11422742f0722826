#!/usr/bin/env python3
"""The torture suite, in under five minutes: jakobsen survives or says why it will not start; every other solver ends with a verdict."""

import pathlib
import subprocess
import sys
import tempfile
import time

import command_line
import stored

LIMIT = 300  # s


def main():
    with tempfile.TemporaryDirectory() as folder:
        began = time.monotonic()
        subprocess.run([command_line.BINARIES / "taut", "run", "torture", "--no-report", "--timeout", "10", "--out", folder], check=True,
                       stdout=subprocess.DEVNULL)
        took = time.monotonic() - began
        records = stored.records(pathlib.Path(folder))
    wrong, counts = [], {}
    for record in records:
        status = record["status"]
        counts.setdefault(record["solver"], {}).setdefault(status["kind"], []).append(record["id"])
        mine = record["solver"] == "jakobsen"
        if status["kind"] in ("crash", "error", "oom") and mine or status.get("reason") == "nonfinite" and mine:
            wrong.append(record["id"])
    for solver, kinds in sorted(counts.items()):
        print(solver, {kind: len(ids) for kind, ids in sorted(kinds.items())})
    print(f"{len(records)} cases in {took:.0f} s")
    if wrong or took > LIMIT or len(records) < 400:
        sys.exit(f"failed: {wrong}")


if __name__ == "__main__":
    main()
