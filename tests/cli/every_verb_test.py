#!/usr/bin/env python3
"""Requirements on every verb in the program's own list: --json, --quiet, colour, progress, manual, completion."""

import csv
import io
import json
import os
import pathlib
import re
import shlex
import subprocess

from command_line import BINARIES, CommandLine, main, rows_of

TOY = f'python3 "{pathlib.Path(__file__).resolve().parents[2]}/experiments/external/sdk/toy.py"'
FEW = ["--rounds", "2", "--seconds", "0.0001"]
ADVICE = ["advise", "./small.toml", "--error", "1%", "--solver", "jakobsen", *FEW]
SWEPT = "set = ['time.duration=0.1']\naxes.'cloth.grid' = [[4, 4], [6, 6]]\n"

# Arguments of each verb in these tests. N is replaced by a number that no other call has.
ASKED = {
    "run": ["./study.toml"], "plot": ["./study.toml", "--kind", "convergence"], "report": ["./study.toml", "--no-media"],
    "export": ["./study.toml"], "new": ["study", "aN"], "case": ["./small.toml", "jakobsen"], "list": ["solvers"],
    "plan": ["./small.toml", "bullet"], "reference": ["./small.toml", "--replace", "-o", "references"],
    "render": ["./small.toml", "--solver", "jakobsen", "--quality", "draft", "--size", "320x240"],
    "require": ["./small.toml", "jakobsen", "--patience", "20"], "frontier": ["./small.toml", "jakobsen", "--tolerance", "0.5"],
    "converge": ["./small.toml", "--solver", "jakobsen", "--most", "8"], "advise": ADVICE[1:], "predict": ["hang", "jakobsen", "vbd"], "bench": ["./study.toml", *FEW],
    "bench effects": ["chain", *FEW], "bench scaling": ["./sizes.toml", "--samples", "2"], "doctor": [], "verify": ["free-fall"], "verify steps": ["rigid", "--scene", "chain"],
    "baseline update": ["./study.toml", "--why", "a test"], "baseline diff": ["./study.toml"], "check": ["./study.toml"], "history": ["./study.toml"],
    "cluster submit": ["./study.toml", "--on", "parallel", "--dry-run", "--shards", "1", "--folder", "cN"],
    "cluster status": ["c0"], "cluster merge": ["c0"], "external probe": [TOY], "external score": ["./small.toml", "end.pc2", "--fps", "64"],
    "external scene": ["./small.toml", "-o", "scene.json"],
}
ALSO_ASKED = [("new", ["scene", "bN"])]
HOSTILE = ("-1", "1e300", "", "no/such\x1b[31m/x")
EXIT_CODES = range(7)  # experiments/command_line/verb.hpp
WITHOUT_RESULTS = {"external scene", "export"}  # one writes a file, the other prints CSV


def names_of(answer):
    """{table: names of its columns}, including "facts". Omits numbers at the end, and names with a dot, which are metric values."""
    plain = lambda names: {re.sub(r"_\d+$", "_N", name) for name in names if "." not in name}  # noqa: E731
    tables = {re.sub(r"_\d+$", "_N", name): plain(column["name"] for column in table["columns"])
              for name, table in answer["tables"].items() if "." not in name}
    return {"facts": plain(answer["facts"])} | tables


class EveryVerb(CommandLine):
    def verbs(self, *words):
        """{"bench effects": its help}. A verb that does nothing without a subverb is represented by its subverbs."""
        text = self.taut(*words, "--help").out
        names = re.findall(r"^  ([a-z]+) ", text.split("Example:")[0], re.MULTILINE)
        found = {} if names and "[SUBCOMMAND]" not in text else {" ".join(words): text}
        for name in names:
            found |= self.verbs(*words, name)
        return found

    def prepare(self):
        self.study(solvers=["jakobsen", "bullet"], rest="axes.iterations = [1, 4]\n")
        self.study("sizes.toml", rest=SWEPT)
        self.taut("run", "./study.toml", env=os.environ | {"TAUT_COMMIT": "before"})  # history compares two builds
        self.taut("run", "./study.toml")
        self.taut("baseline", "update", "./study.toml", "--why", "to have one")
        self.taut("cluster", "submit", *(word.replace("N", "0") for word in ASKED["cluster submit"]))
        self.taut("run", "./study.toml", "--shard", "1/1", "--out", "c0/shards/0001")
        self.taut("case", "./small.toml", "jakobsen", "--trajectory", "end.pc2")

    def assert_other_forms_agree(self, words, printed):
        """Checks that CSV has the first table's columns and rows (if timings do not change the rows), and that Markdown starts with the command."""
        self.assertEqual(printed["schema"], "taut-answer-1")
        table = next(iter(printed["tables"].values()), None)
        lines = list(csv.reader(io.StringIO(self.taut(*words, "--csv", expect=None).out)))
        wanted = [column["name"] for column in table["columns"]] if table else ["name", "value", "unit"]
        self.assertEqual([name for name in lines[0] if name in wanted], wanted)
        if table and table["rows"] and words[0] not in ("advise", "require"):
            self.assertEqual(len(lines), len(table["rows"]) + 1)
        self.assertTrue(all(len(line) == len(lines[0]) for line in lines))
        self.assertIn("facts", self.taut(*words, "--csv=nosuch", expect=2).err)
        heading = self.taut(*words, "--markdown", expect=None).out.splitlines()[0]
        self.assertEqual(heading, "`" + shlex.join(["taut", *words, "--markdown"]) + "`")

    def test_every_verb_that_prints_results_takes_json_and_quiet(self):
        self.prepare()
        verbs, documented = self.verbs(), {}
        for row in rows_of(self.answer("list", "answers"), "answers"):
            documented.setdefault(row["verb"], {})[row["table"]] = set(row["columns"].split())
        self.assertEqual(sorted(verbs), sorted(ASKED), "every verb is asked here")
        undocumented = set(ASKED) - set(documented) - WITHOUT_RESULTS
        self.assertEqual(undocumented, {"report", "case", "plot", "render", "new"}, "they have documents of their own, or print names of files")
        for number, (verb, words) in enumerate([*ASKED.items(), *ALSO_ASKED], 1):
            with self.subTest(verb, words=words):
                self.assertIn("--quiet", verbs[verb])
                self.assertEqual("--json" in verbs[verb], verb not in WITHOUT_RESULTS)
                if words is None:
                    continue
                words = [re.sub("N$", str(number), word) for word in [*verb.split(), *words]]
                if verb not in WITHOUT_RESULTS:
                    printed = json.loads(self.taut(*words, "--json").out)
                    for table, names in names_of(printed).items() if verb in documented else ():
                        listed = documented[verb].get(table, set())
                        self.assertTrue("*" in listed or names <= listed, f"{table}: not in `taut list answers`: {names - listed}")
                    if "--csv" in verbs[verb]:
                        self.assert_other_forms_agree(words, printed)
                words = [re.sub(f"(?<=[abc]){number}$", f"{number}q", word) for word in words]
                quiet = self.taut(*words, "--quiet")
                self.assertEqual((quiet.out, quiet.err), ("", ""))

    def options(self, text):
        """(option, whether it takes a value) for the options in a verb's help, except those that only print help."""
        found = re.findall(r"^  (?:-\w,)?(--[\w-]+)(?: ([A-Z]+)(?![a-z]))?", text.split("Options:")[1], re.MULTILINE)
        return [(name, bool(kind)) for name, kind in found if not name.startswith("--help")]

    def test_every_option_of_every_verb_under_values_that_make_no_sense(self):
        """Every call ends in time, either with a documented exit code and JSON on stdout, or with 2, an error and nothing on stdout.
        The options take turns with the values; with $TAUT_ALL_VALUES each option gets all of them."""
        self.prepare()
        for verb, text in self.verbs().items():
            asked = [*verb.split(), *ASKED[verb]]
            for count, (option, takes) in enumerate(self.options(text)):
                if (verb, option) == ("reference", "--all"):  # takes minutes
                    continue
                values = HOSTILE if "TAUT_ALL_VALUES" in os.environ else [HOSTILE[count % len(HOSTILE)]]
                for which, hostile in enumerate(values if takes else [None]):
                    words = [re.sub("(?<=[abc])N$", f"{count}{which}", word) for word in asked]
                    words.append(option if hostile is None else f"{option}={hostile}")
                    with self.subTest(words=words):
                        form = ["--json"] if "--json" in text and option not in ("--json", "--csv", "--markdown", "--quiet") else []
                        said = self.taut(*words, *form, expect=None)
                        self.assertIn(said.returncode, EXIT_CODES, said.err)
                        self.assertNotIn("\x1b", said.err)
                        if said.returncode == 2:
                            self.assertNotEqual(said.err, "")
                        if form:
                            self.assertEqual(said.returncode == 2, not said.out)
                            self.assertTrue(not said.out or json.loads(said.out))

    def test_an_answer_that_cannot_be_written_is_an_error(self):
        self.prepare()
        for number, (verb, words) in enumerate(ASKED.items(), 1):
            if verb == "external scene":  # prints nothing
                continue
            words = [re.sub("(?<=[abc])N$", f"{number}f", word) for word in [*verb.split(), *words]]
            with self.subTest(words=words), open("/dev/full", "w") as full:
                asked = subprocess.run([BINARIES / "taut", *words], cwd=self.folder, stdout=full, stderr=subprocess.PIPE, text=True, timeout=120)
                self.assertEqual((asked.returncode, asked.stderr.splitlines()[-1:]), (2, ["standard output cannot be written"]))

    def test_colour_on_a_terminal_and_none_in_a_pipe(self):
        self.prepare()
        for words in (["verify", "free-fall"], ["check", "./study.toml"], ["external", "probe", TOY]):
            self.assertIn("\x1b[32m", self.on_a_terminal(*words), words)
            self.assertNotIn("\x1b", self.on_a_terminal(*words, NO_COLOR="1"), words)
            self.assertNotIn("\x1b", self.taut(*words).out, words)
            self.assertNotIn("\x1b", self.on_a_terminal(*words, "--json"), words)

    def test_what_may_take_over_ten_seconds_says_how_long_it_will_last(self):
        self.prepare()
        for words, says in (
                (["bench", "./study.toml", *FEW], r"timing round 1/2  left \d+:\d\d"),
                (["bench", "effects", "chain", *FEW], r"timing round 1/2  left \d+:\d\d"),
                (ADVICE, r"  [\d.]+ of 120 s  jakobsen"),
                (["verify", "free-fall", "damping-factor"], r"truth 1/2  left \d+:\d\d"),
                (["render", "./small.toml", "--solver", "jakobsen", "--video", "--quality", "draft", "--size", "320x240"], r"frame \d+/\d+  left \d+:\d\d")):
            self.assertRegex(self.taut(*words).err, says, words)

    def test_the_manual_and_the_completion_have_every_verb_and_option(self):
        manual, completion = self.taut("--man").out, self.taut("--bash-completion").out
        self.assertNotIn("worker", manual)
        (self.folder / "taut.bash").write_text(completion)
        verbs = self.verbs()
        questions = [[*verb.split(), "--"] for verb in verbs]
        questions += [["re"], ["bench", "ef"], ["advise", "mov"], ["case", "hang", "jak"], ["baseline", ""], ["new", "st"]]
        script = "source ./taut.bash\n" + "".join(
            "COMP_WORDS=(taut %s); COMP_CWORD=%d; _taut; echo ${COMPREPLY[@]}\n" % (" ".join(f"'{w}'" for w in words), len(words))
            for words in questions)
        answers = subprocess.run(["bash", "-c", script], cwd=self.folder, text=True, check=True, capture_output=True).stdout.splitlines()
        offered = {" ".join(words): answer.split() for words, answer in zip(questions, answers)}
        for verb, text in verbs.items():
            entry = manual.split(f".B {verb}\n")
            self.assertEqual(len(entry), 2, f"{verb} is in the manual once")
            options = set(re.findall(r"^  (?:-\w,)?(--[\w-]+)", text, re.MULTILINE))
            lacking = [o for o in options if o.replace("-", "\\-") not in entry[1].split(".B ")[0]]
            self.assertEqual(lacking, [], f"{verb}: in the manual")
            self.assertEqual(sorted(options - set(offered[verb + " --"])), [], f"{verb}: offered")
        self.assertEqual([sorted(offered[words]) for words in ("re", "bench ef", "advise mov", "case hang jak", "baseline ", "new st")],
                         [["reference", "render", "report", "require"], ["effects"], ["moving-ball"], ["jakobsen"],
                          sorted({"update", "diff", *offered["baseline "]}), ["study"]])


if __name__ == "__main__":
    main()
