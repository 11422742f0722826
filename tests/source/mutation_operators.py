"""The small errors that mutate.py plants: patterns on a line of code, and their replacements."""
import functools
import re

NUMBER = r"(?<![\w.'])(\d+\.?\d*(?:e-?\d+)?)(?![\w.'])"


def scaled(factor, step):
    """Multiplies a literal by `factor`. If that leaves a whole number unchanged, adds `step` instead."""
    def change(match):
        text = match[1]
        if text.isdigit():
            value = int(int(text) * factor)
            return str(value if value != int(text) else int(text) + step)
        return repr(float(text) * factor if float(text) else 0.1)
    return change


def exchanged(*couples):
    table = {a: b for x, y in couples for a, b in ((x, y), (y, x))}
    return lambda match: match[0].replace(match[1], table[match[1]])


# operator -> (pattern on code without strings and comments, replacement)
OPERATORS = {
    "arithmetic": (r" ([-+*/]) (?=[\w(])", exchanged("+-", "*/")),
    "assignment": (r" ([-+*/])= ", exchanged("+-", "*/")),
    "border": (r" (<|>)(=?) ", lambda m: f" {m[1]}{'' if m[2] else '='} "),
    "direction": (r" ([<>])=? ", exchanged("<>")),
    "equality": (r" ([=!]=) ", exchanged(("==", "!="))),
    "logic": (r" (&&|\|\|) ", lambda m: " || " if m[1] == "&&" else " && "),
    "negation": (r"(?<=\()!(?=\w)", lambda m: ""),
    "little": (NUMBER, scaled(1.02, 1)),
    "much": (NUMBER, scaled(10, 1)),
    "sign": (r"(?<=[(,=] )-(?=[a-z(])|(?<=\()-(?=[a-z(])|(?<=return )-(?=[a-z(])", lambda m: ""),
    "axis": (r"(?<=[\w\])])\.([xyz])(?=\W)", lambda m: "." + "yzx"["xyz".index(m[1])]),
    "extreme": (r"\b(min|max)(?=[({])", lambda m: {"min": "max", "max": "min"}[m[1]]),
    "function": (r"\b(sin|cos|floor|ceil|front|back|begin|end)(?=\()",
                 exchanged(("sin", "cos"), ("floor", "ceil"), ("front", "back"), ("begin", "end"))),
    "constant": (r"\b(true|false)\b", lambda m: "false" if m[1] == "true" else "true"),
    "removed": (r"^ +((?!return|break|continue|const|auto|using|throw|delete|else|case|default)"
                r"[a-z_][\w.\[\]]*(->|\.|\(| [-+*/]?= |\+\+)[^{}]*;)$", lambda m: ";"),
    "swapped": (r"(?<=\w\()(?<!\bmin\()(?<!\bmax\()(\w+), (\w+)(?=\))", lambda m: f"{m[2]}, {m[1]}"),
}
# Changes that no test could call an error are not planted: 2 % more of an order of magnitude (a tolerance of 1e-9, an infinity of
# 1e300), which of two measured numbers counts as larger if they are equal to the last bit, and how much memory is reserved in advance.
# Nor are the arguments of a minimum swapped.
NO_ERROR = {"little": re.compile(r"^1e-?\d+$"), "border": re.compile(r"^ [<>]=? \(?-?(\d+\.\d|\d+e-?\d)")}
NOT_CODE = re.compile(r"^\s*(#|//|assert\(|static_assert|if constexpr|template|using |.*\.reserve\(|EXPECT_|ASSERT_|TAUT_)")


def code_of(line):
    """The line with strings and comments blanked out, or "" if no error can be planted in it."""
    if NOT_CODE.match(line):
        return ""
    line = re.sub(r'"(\\.|[^"\\])*"', lambda m: '"' + "_" * (len(m[0]) - 2) + '"', line)
    line = re.sub(r"<[\w:, <>*&]*>", lambda m: "_" * len(m[0]), line)  # template arguments
    return re.sub(r"//.*", "", line).rstrip()


def sites(file):
    """operator -> all (line number, line with the error) in a file"""
    found = {}
    for number, line in enumerate(file.read_text().splitlines()):
        code = code_of(line)
        for name, (pattern, change) in OPERATORS.items():
            for match in re.finditer(pattern, code):
                if name in NO_ERROR and NO_ERROR[name].match(code[match.start():] if name == "border" else match[0]):
                    continue
                planted = line[:match.start()] + change(match) + line[match.end():]
                if name == "removed":
                    planted = re.match(" *", line)[0] + ";"
                if planted != line:
                    found.setdefault(name, []).append((number, planted))
    return found


# Tokens of formatted code: braces and ends of statements. Strings and comments are matched as a whole, so that their contents are skipped.
TOKEN = re.compile(r'R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<!\w)\'(?:\\.|[^\'\\\n])+\'|//[^\n]*|/\*.*?\*/|^ *#[^\n]*|[{};]',
                   re.DOTALL | re.MULTILINE)


@functools.cache
def bodies(text):
    """(start, end) of the text between the braces of every function that is neither constexpr nor inside another function"""
    found, opened, last = [], [], 0
    for token in TOKEN.finditer(text):
        if token[0] == "{":
            head = text[last:token.start()]
            if re.search(r"\)[\s\w:<>*&]*(->[\s\w:<>*&]+)?$", head) and not re.search(r"\bconste(xpr|val)\b", head):
                kind = "function"
            else:
                kind = "scope" if re.search(r"\b(namespace|class|struct|union)\b", head) else "value"
            opened.append((kind, token.end()))
        elif token[0] == "}":
            kind, start = opened.pop()
            if kind == "function" and all(outer == "scope" for outer, _ in opened):
                found.append((start, token.start()))
        if token[0] in "{};":
            last = token.end()
    return found
