"""Access to the contents of a results file, in the form that `taut case --json` prints."""

import contextlib
import hashlib
import json
import pathlib
import re
import sqlite3
import struct


def query(folder, sql, *values):
    """The rows of a query on folder/results.db, read as any program would read it; none if there is no such file."""
    file = folder / "results.db"
    if not file.exists():
        return []
    with contextlib.closing(sqlite3.connect(f"file:{file}?mode=rw", uri=True, timeout=60)) as connection:
        connection.row_factory = sqlite3.Row
        return connection.execute(sql, values).fetchall()


def change(folder, sql, *values):
    """Changes a results file in a way that only tests do."""
    with contextlib.closing(sqlite3.connect(folder / "results.db", timeout=60)) as connection:
        connection.execute("PRAGMA foreign_keys = ON")
        connection.execute(sql, values)
        connection.commit()


def seal_benches(folder):
    """Gives every scene's bench the digest of its current contents."""
    for bench in query(folder, "SELECT * FROM benches"):
        texts = [bench["study"], bench["host"], bench["build"], bench["scene"], "in turns" if bench["in_turns"] else ""]
        parts = [text.encode() for text in texts] + [number(bench[ratio]) for ratio in ("control_low", "control", "control_high")]
        for timing in query(folder, "SELECT * FROM timings WHERE bench_id = ? ORDER BY timing_id", bench["bench_id"]):
            parts += [str(timing[column]).encode() for column in ("key", "failure", "remark", "peak_bytes")]
            samples = query(folder, "SELECT * FROM samples WHERE timing_id = ? ORDER BY sample", timing["timing_id"])
            parts += [number(sample[clock]) for clock in ("cpu", "wall") for sample in samples]
        digest = hashlib.sha256(b"".join(part + b"\0" for part in parts)).hexdigest()
        change(folder, "UPDATE benches SET digest = ? WHERE bench_id = ?", digest, bench["bench_id"])


def number(value):
    return b"" if value is None else struct.pack("<d", value)


def keys(folder):
    if not query(folder, "SELECT 1 FROM sqlite_master WHERE name = 'cases'"):
        return []  # it is being created
    return [row["key"] for row in query(folder, "SELECT key FROM cases ORDER BY key")]


# (key in the JSON, column in the file, type) from the document, which keys_test.py compares with the program
DOCUMENT = pathlib.Path(__file__).resolve().parents[2] / "experiments/cli/README.md"
FIELDS = re.findall(r"^\| `([\w.]+)` \| `?(\w*)`? ?\| (text|number|whole number|JSON) \|", DOCUMENT.read_text(), re.MULTILINE)
SCHEMA = int(re.search(r"`schema` is (\d+);", DOCUMENT.read_text())[1])


def records(folder):
    values = {}
    for row in query(folder, "SELECT case_id, name, value FROM numbers JOIN metrics USING (metric_id) ORDER BY name"):
        values.setdefault(row["case_id"], {})[row["name"]] = row["value"]
    return [record_of(row, values.get(row["case_id"], {})) for row in query(folder, "SELECT * FROM cases ORDER BY key")]


def record_of(row, values):
    record = {"schema": SCHEMA}
    for key, column, kind in FIELDS:
        value = values if not column else -1 if row[column] is None else json.loads(row[column]) if kind == "JSON" else row[column]
        if key == "log" and not value:
            continue
        within, _, name = key.rpartition(".")
        (record.setdefault(within, {}) if within else record)[name] = value
    return record
