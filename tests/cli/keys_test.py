#!/usr/bin/env python3
"""Checks that the documents name the keys, the fields of a record, the statuses and the newest protocol that taut has.

The tables of keys and of a record equal `taut list keys` and `taut list record`.

Usage: keys_test.py BUILD [--write]     --write: writes the tables anew"""

import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENES, STUDIES = ROOT / "experiments/scenes/README.md", ROOT / "experiments/studies/README.md"
RECORDS = sorted((ROOT / "tests/fuzz/corpus/record").glob("*.json"))  # of another schema they would test no more than its refusal
VERBS, RESULTS = ROOT / "experiments/cli/README.md", ROOT / "experiments/results/README.md"


def rows_of(answer, name):
    table = answer["tables"][name]
    columns = [column["name"] for column in table["columns"]]
    return [dict(zip(columns, row)) for row in table["rows"]]


def code(text):
    """The value in backquotes if it is typed like this; a default in words stays unchanged."""
    return f"`{text}`" if re.match(r"""[\[{"\d-]|(true|false)$""", text) else text


def markdown(columns, rows):
    """A Markdown table; an empty cell is one blank."""
    def line(cells):
        return "|" + "|".join(f" {cell} " if cell else " " for cell in cells) + "|\n"
    return line(columns) + "|---" * len(columns) + "|\n" + "".join(map(line, rows))


def scene_tables(rows):
    """heading -> the table below it"""
    tables = {}
    for row in rows:
        section = row["key"].rpartition(".")[0]
        heading = {"": "At the top", "collider": "[[collider]]", "pin_motion": "[[pin_motion]]", "seam": "[[seam]]"}.get(section, f"[{section}]")
        tables.setdefault(heading, []).append(
            [f"`{row['key']}`", row["type"], row["unit"], row["range"], code(row["default"]), f"`{row['example']}`", row["help"]])
    columns = ["key", "type", "unit", "range", "default", "example", "meaning"]
    return {heading: markdown(columns, cells) for heading, cells in tables.items()}


def replaced(text, heading, table):
    """The document with the first table after the heading replaced."""
    before, mark, after = text.partition(heading)
    assert mark, f"no heading {heading!r}"
    found = re.search(r"(?:^\|.*\n)+", after, re.MULTILINE)
    return before + mark + after[:found.start()] + table + after[found.end():]


def wrong_statuses(statuses):
    """The files whose list of statuses is another one."""
    def found(file, pattern):
        match = re.search(pattern, (ROOT / file).read_text())
        return match.group(1) if match else ""
    glossary = re.sub(r" \([^)]*\)", "", found("GLOSSARY.md", r"\n\| status \| how a case ended: (.*) \|\n")).split(", ")
    model = re.findall(r'"(\w+)"', found("experiments/report/model/MODEL.md", r"\n\| `statuses` \|.*?: `id` \((.*?)\)"))
    results = re.findall(r"'(\w+)'", found("experiments/python/runs.cpp", r'("\'ok\', .*)'))  # of these, the first
    return [file for file, right in (("GLOSSARY.md", glossary == statuses),
                                     ("experiments/report/model/MODEL.md", sorted(model) == sorted(statuses)),
                                     ("experiments/python/runs.cpp", results and results == statuses[:len(results)])) if not right]


def wrong_versions():
    """The files that name another newest version of the protocol than the table of scene keys has."""
    def largest(file, pattern):
        return max(map(int, re.findall(pattern, (ROOT / file).read_text())), default=0)
    newest = largest("core/model/scene_keys.cpp", r"came_later\((\d+)\)")
    assert newest > 1, "keys that came later"
    external = "experiments/external/"
    return [file for file, pattern, version in (
        (external + "README.md", r"taut-solver/(\d+)", newest), (external + "README.md", r"taut-scene/(\d+)", newest),
        (external + "sdk/taut_solver.py", r"taut-solver/(\d+)", newest), (external + "sdk/taut_solver.hpp", r" /(\d+):", newest),
        ("CONTRIBUTING.md", r"came_later\((\d+)\)", newest + 1)) if largest(file, pattern) != version]


def main():
    program = pathlib.Path(sys.argv[1]) / "taut"
    answer, record = (json.loads(subprocess.run([program, "list", what, "--json"], check=True, capture_output=True).stdout)
                      for what in ("keys", "record"))
    scenes, studies, verbs, results = (file.read_text() for file in (SCENES, STUDIES, VERBS, RESULTS))
    keys, fields = rows_of(answer, "keys"), rows_of(record, "record")
    assert len(keys) > 50, "the keys of scenes"
    for heading, table in scene_tables(keys).items():
        scenes = replaced(scenes, f"\n### {heading}\n", table)
    studies = replaced(studies, "# Studies\n", markdown(
        ["key", "meaning"], [[f"`{row['key']}`", row["help"]] for row in rows_of(answer, "study_keys")]))
    verbs = replaced(verbs, "\n### A record\n", markdown(["key", "column", "type", "meaning"], [
        [f"`{row['key']}`", f"`{row['column']}`" if row["column"] else "", row["type"], row["help"]] for row in fields]))
    schema = re.search(r"\bkRecordSchema = (\d+);", (ROOT / "experiments/case/record_io.hpp").read_text())[1]
    verbs = re.sub(r"(?<=`schema` is )\d+(?=;)", schema, verbs)
    inputs = {file: re.sub(r'(?<="schema": )\d+', schema, file.read_text(), count=1) for file in RECORDS}
    columns = ", ".join(["case_id", *(row["column"] for row in fields if row["column"]), "is_result", "result_digest", "errors"])
    results = re.sub(r"(?<=\n\| cases \| a record each \| ).*(?= \|\n)", columns, results)
    statuses = next(row["help"] for row in fields if row["key"] == "status.kind")
    results = re.sub(r"(?<=\n\| status \| \| ).*(?= \(\[words\])", statuses, results)
    wrong = 0
    for file in wrong_statuses(statuses.split(", ")):
        print(f"{file} has other statuses than `taut list record`")
        wrong = 1
    for file in wrong_versions():
        print(f"{file} names another newest version of the protocol than came_later() in core/model/scene_keys.cpp")
        wrong = 1
    for file, text in [(SCENES, scenes), (STUDIES, studies), (VERBS, verbs), (RESULTS, results), *inputs.items()]:
        if file.read_text() == text:
            continue
        if "--write" in sys.argv:
            file.write_text(text)
        else:
            print(f"{file.relative_to(ROOT)} differs from `taut list`: tests/cli/keys_test.py BUILD --write")
            wrong = 1
    return wrong


if __name__ == "__main__":
    sys.exit(main())
