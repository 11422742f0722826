#!/usr/bin/env python3
"""Checks that everything that documents, comments and sources refer to exists: links, headings, files; if a program is given also
verbs, and values of metrics.

Usage: documents_test.py [PROGRAM]     PROGRAM: a built taut, whose verbs the documents may name"""

import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ("core", "bullet_ref", "experiments", "tests", "results", "cmake")
FILE = re.compile(rf"(?<![\w./-])((?:{'|'.join(FOLDERS)})/[\w./-]+\.(?:hpp|cpp|py|sh|md|toml|json|txt|cmake))\b")
MADE = re.compile(r"planted|STUDY|results/(runs|bench|verify)|core/solver/toy(_pass)?\.cpp|metrics/lowest\.cpp|truths/weightless\.cpp|"
                  r"core/(main|new)\.cpp|tests/new_test\.cpp")


def heading(text):
    """The anchor that GitHub makes for a heading."""
    return re.sub(r"[^\w -]", "", text.strip().lower()).replace(" ", "-")


def wrong_links(document):
    text = document.read_text()
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        path, _, anchor = target.partition("#")
        if re.match(r"\w+:", target):
            continue
        file = (document.parent / path).resolve() if path else document
        if not file.exists():
            yield f"links to {target}, which is not there"
        elif anchor and anchor not in map(heading, re.findall(r"^#+ (.*)$", file.read_text(), re.MULTILINE)):
            yield f"links to {target}: no such heading"


def wrong_files(file):
    for path in FILE.findall(file.read_text()):
        if not MADE.search(path) and not (ROOT / path).exists() and not (file.parent / path).exists():
            yield f"names {path}, which is not there"


def verbs(program):
    return set(re.findall(r"^  ([a-z]+)\b", subprocess.run([program, "--help"], capture_output=True, text=True).stdout,
                          re.MULTILINE))


def values(program):
    """Names of the values that metrics have."""
    listed = subprocess.run([program, "list", "metrics", "--json"], check=True, capture_output=True, text=True).stdout
    table = json.loads(listed)["tables"]["values"]
    at = [column["name"] for column in table["columns"]].index("name")
    return {row[at] for row in table["rows"]}


def wrong_values(file, known):
    """A name that no metric has would always give NaN, and every comparison with it would be false."""
    for name in re.findall(r'\b(?:value|now|add)\("([a-z_]+(?:\.[a-z0-9_]+)+)"', file.read_text()):
        if name not in known and not name.startswith(("cpu.", "wall.")):  # costs are not values of a metric
            yield f"asks for the value {name}, which no metric has"


def main():
    files = [file for folder in (*FOLDERS, ".") for file in ROOT.glob("*" if folder == "." else f"{folder}/**/*")
             if file.suffix in (".md", ".hpp", ".cpp", ".py", ".sh", ".cmake", ".txt") and "runs" not in file.parts]
    documents = [file for file in files if file.suffix == ".md"]
    assert len(documents) > 10 and len(files) > 300, "the tree is not where it is looked for"
    known = verbs(sys.argv[1]) if len(sys.argv) > 1 else None
    of_metrics = values(sys.argv[1]) if len(sys.argv) > 1 else None
    wrong = []
    for file in files:
        found = list(wrong_files(file)) if file.name != "CHANGELOG.md" else []
        if of_metrics and file.suffix == ".cpp" and file.is_relative_to(ROOT / "experiments"):
            found += wrong_values(file, of_metrics)
        if file in documents:
            found += wrong_links(file)
        if file in documents and known and file.name != "CHANGELOG.md":
            named = set(re.findall(r"(?:\./|`|    |/)taut (?!VERB)([a-z]+)", file.read_text()))
            found += [f"names the verb {verb}, which taut has not" for verb in sorted(named - known - {"test", "python"})]
        wrong += [f"{file.relative_to(ROOT)}: {what}" for what in found]
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
