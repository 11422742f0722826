#!/usr/bin/env python3
"""Fails where a number is made from text, or text from a number, in a way that knows locales: under a locale with a decimal comma 0.7 would be
read as 0. core/model/text.hpp has the ways that do not (std::from_chars, std::to_chars).

Usage: numbers_test.py BUILD; `numbers_test.py BUILD --self-test` plants each of the ways and expects red.

The sources are searched for functions by name. What a stream or std::to_string() does depends on the type of the number, so what the compiler
made of the sources is searched too: every object in the build folder."""

import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ("core", "bullet_ref", "experiments", "tests/support", "tests/install/examples")
NAMES = re.compile(r"\b(strto(?:d|f|ld)|atof|sto(?:d|f|ld)|w?scanf|setlocale|localeconv)\s*\(")
PRINTERS = re.compile(r"\b(?:\w*printf|formatted)\s*\(")
SCANNERS = re.compile(r"\bs?f?scanf\s*\(")
REAL = re.compile(r'%[-+ #0]*(?:\*|\d+)?(?:\.(?:\*|\d+)?)?[lL]?[aAeEfFgG]')
# A stream into which text is written uses the locale that the program has set, also for the groups of digits of whole numbers.
STREAM = re.compile(r"\bo?stringstream\s+(\w+)")
SYMBOLS = {
    r"_ZNSo9_M_insertI[def]E": "a real is written to a stream",
    r"_ZNSi10_M_extractI[def]E": "a real is read from a stream",
    r"_ZN9__gnu_cxx12__to_xstring": "std::to_string() of a real",
    r"_ZN9__gnu_cxx6__stoaI[def]": "std::stod() or one of its kind",
}
# Objects with headers of others: CLI11, which only the program's own command line reaches (it never sets a locale), and Bullet's messages on
# std::cout.
THEIRS = re.compile(r"/parser\.cpp\.o$|/taut_bullet\d\d\.dir/")


def arguments(text, at):
    """From an opening parenthesis to where it closes."""
    depth = 0
    for end in range(at, len(text)):
        depth += {"(": 1, ")": -1}.get(text[end], 0)
        if depth == 0:
            return text[at:end]
    return text[at:]


def in_text(text):
    """(line, what is wrong) for each place of a source file."""
    code = re.sub(r"//[^\n]*", "", text)
    line = lambda at: code.count("\n", 0, at) + 1
    for found in NAMES.finditer(code):
        yield line(found.start()), found[1] + "() knows locales"
    for pattern in (PRINTERS, SCANNERS):
        for found in pattern.finditer(code):
            literals = "".join(re.findall(r'"((?:[^"\\]|\\.)*)"', arguments(code, found.end() - 1)))
            if REAL.search(literals.replace("%%", "")):
                yield line(found.start()), "a real with " + found[0][:-1].strip() + "()"
    for found in STREAM.finditer(code):
        if f"{found[1]}.imbue(std::locale::classic())" not in code:
            yield line(found.start()), f"the stream {found[1]} has no classic locale"


def in_sources(root):
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*.[ch]pp")):
            if "third_party" not in path.parts:
                for line, wrong in in_text(path.read_text()):
                    yield f"{path.relative_to(root)}:{line}: {wrong}"


def in_objects(objects):
    for path in objects:
        if THEIRS.search(str(path)):
            continue
        for symbol in subprocess.run(["nm", path], capture_output=True, text=True, check=True).stdout.split():
            for pattern, wrong in SYMBOLS.items():
                if re.match(pattern, symbol):
                    yield f"{path}: {wrong} ({symbol})"


def objects_of(build):
    """Those of the library and its programs, not of tests."""
    return sorted(path for path in (build / "CMakeFiles").rglob("*.cpp.o") if ".dir" in str(path)) + sorted((build / "CMakeFiles").rglob("*.cxx.o"))


PLANTED = {  # what is planted: whether the objects show it, and not the text
    "double f(const char* s) { return std::strtod(s, nullptr); }": False,
    "double f(const char* s) { return std::atof(s); }": False,
    "double f(const std::string& s) { return std::stod(s); }": False,
    'void f(double x) { std::printf("%s %d%%"\n"%.3g", "", 1, x); }': False,
    'void f(double x, char* s) { std::snprintf(s, 9, "%*.*e", 3, 4, x); }': False,
    'void f(double* x, const char* s) { std::sscanf(s, "%lf", x); }': False,
    "std::string f(int x) { std::ostringstream out; out << x; return out.str(); }": False,
    "std::string f(double x) { return std::to_string(x); }": True,
    "std::string f(float x) { return std::to_string(x); }": True,
    "void f(double x) { std::cout << x; }": True,
    "void f(float x) { std::cerr << 1 << x; }": True,
    "bool f(std::istream& in, double& x) { return bool(in >> x); }": True,
}
RIGHT = '''void f(int n, const std::string& s) { std::cout << n << s << std::to_string(n); std::printf("%d %s %5.1f%%" + 9, n, ""); }'''.replace("%5.1f%%", "100 %% of")


def self_test():
    head = "#include <cstdio>\n#include <cstdlib>\n#include <iostream>\n#include <sstream>\n#include <string>\n"
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        for number, (code, by_object) in enumerate([*PLANTED.items(), (RIGHT, None)]):
            source = pathlib.Path(folder) / f"{number}.cpp"
            source.write_text(head + code + "\n")
            found = bool(list(in_text(source.read_text())))
            if by_object is not False and not found:
                made = source.with_suffix(".cpp.o")
                subprocess.run(["c++", "-std=c++20", "-O2", "-w", "-c", source, "-o", made], check=True)
                found = bool(list(in_objects([made])))
            if found != (by_object is not None):
                wrong.append(code)
    return [f"{'not found' if code != RIGHT else 'found, but right'}: {code}" for code in wrong]


def main():
    build = pathlib.Path(sys.argv[1])
    if sys.argv[2:] == ["--self-test"]:
        wrong = self_test()
    else:
        objects = objects_of(build)
        if len(objects) < 20:
            sys.exit(f"{build}: only {len(objects)} objects: is it built?")
        wrong = [*in_sources(ROOT), *in_objects(objects)]
    print("\n".join(wrong))
    return len(wrong) > 0


if __name__ == "__main__":
    sys.exit(main())
