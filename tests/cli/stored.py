"""What a results file holds, as `taut case --json` prints it."""

import contextlib
import json
import sqlite3


def query(folder, sql, *values):
    """The rows of a query of folder/results.db, which is read as by any program; none if there is no such file."""
    file = folder / "results.db"
    if not file.exists():
        return []
    with contextlib.closing(sqlite3.connect(f"file:{file}?mode=rw", uri=True, timeout=60)) as connection:
        connection.row_factory = sqlite3.Row
        return connection.execute(sql, values).fetchall()


def change(folder, sql, *values):
    """What nobody but a test does to a results file."""
    with contextlib.closing(sqlite3.connect(folder / "results.db", timeout=60)) as connection:
        connection.execute("PRAGMA foreign_keys = ON")
        connection.execute(sql, values)
        connection.commit()


def keys(folder):
    if not query(folder, "SELECT 1 FROM sqlite_master WHERE name = 'cases'"):
        return []  # it is being made
    return [row["key"] for row in query(folder, "SELECT key FROM cases ORDER BY key")]


def records(folder):
    values = {}
    for row in query(folder, "SELECT case_id, name, value FROM numbers JOIN metrics USING (metric_id) ORDER BY name"):
        values.setdefault(row["case_id"], {})[row["name"]] = row["value"]
    return [{"status": {"kind": row["status"], "reason": row["reason"], "step": -1 if row["step"] is None else row["step"],
                        "vertex": -1 if row["vertex"] is None else row["vertex"]},
             "values": values.get(row["case_id"], {}), "projections": row["projections"], "step_cost": json.loads(row["passes"]),
             "resolved_settings": json.loads(row["resolved_settings"]), "digest": row["state_digest"], "schema": 1, "key": row["key"],
             "id": row["id"], "spec": {"scene": row["scene_file"], "overrides": json.loads(row["settings"]), "solver": row["solver_text"]},
             "scene": row["scene"], "solver": row["solver"], "params": json.loads(row["parameters"]), "dt": row["dt"], "steps": row["steps"],
             "vertices": row["vertices"], "links": row["links"], **({"log": row["log"]} if row["log"] else {})}
            for row in query(folder, "SELECT * FROM cases ORDER BY key")]
