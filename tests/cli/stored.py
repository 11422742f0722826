"""What a results file holds, as `taut case --json` prints it."""

import contextlib
import json
import pathlib
import re
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


# key of the JSON, column of the file, type: the document's, which keys_test.py holds to the program's
DOCUMENT = pathlib.Path(__file__).resolve().parents[2] / "experiments/cli/README.md"
FIELDS = re.findall(r"^\| `([\w.]+)` \| `?(\w*)`? ?\| (text|number|whole number|JSON) \|", DOCUMENT.read_text(), re.MULTILINE)


def records(folder):
    values = {}
    for row in query(folder, "SELECT case_id, name, value FROM numbers JOIN metrics USING (metric_id) ORDER BY name"):
        values.setdefault(row["case_id"], {})[row["name"]] = row["value"]
    return [record_of(row, values.get(row["case_id"], {})) for row in query(folder, "SELECT * FROM cases ORDER BY key")]


def record_of(row, values):
    record = {"schema": 2}
    for key, column, kind in FIELDS:
        value = values if not column else -1 if row[column] is None else json.loads(row[column]) if kind == "JSON" else row[column]
        if key == "log" and not value:
            continue
        within, _, name = key.rpartition(".")
        (record.setdefault(within, {}) if within else record)[name] = value
    return record
