#!/usr/bin/env python3
"""The sample of the browser tests has no field that the model's document lacks; that the document's fields are those that
taut writes, and no others, is what tests/report/model_keys_test.cpp holds."""

import pathlib
import re
import sys

import sample

DOCUMENT = pathlib.Path(__file__).resolve().parents[2] / "experiments/report/model/MODEL.md"
BY_NAME = {"policy", "statuses", "counts", "verdicts", "parameters", "values", "cost"}


def documented():
    """The names in backquotes, by row of the table at its top and by section below it."""
    keys = {}
    for section in DOCUMENT.read_text().split("\n## ")[1:]:
        title, body = section.split("\n", 1)
        parts = re.findall(r"^\| `([a-z_]+)\??` \|(.*)$", body, re.M) if title == "Top" else [(title.lower(), body)]
        for part, text in parts:
            keys.setdefault(part, set()).update(re.findall(r"`([a-z_]+)\??`", text))
    return keys


def fields(node):
    if isinstance(node, list):
        for one in node:
            yield from fields(one)
    elif isinstance(node, dict) and not {"mid", "n"} <= node.keys():
        for key, value in node.items():
            yield key
            if not (isinstance(value, dict) and key in BY_NAME):
                yield from fields(value)


def main():
    known, unknown = documented(), []
    for model in (sample.make(), sample.bare()):
        for part, value in model.items():
            if part != "schema":
                unknown += [f"{part}: {key}" for key in fields(list(value.values()) if part == "metrics" else value)
                            if key not in known[part]]
    for field in sorted(set(unknown)):
        print(f"the sample has a field that the model has not: {field}")
    return 1 if unknown else 0


if __name__ == "__main__":
    sys.exit(main())
