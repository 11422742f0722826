"""Makes a page of a model without C++: what `taut report` does when it writes one."""

import html
import json
import pathlib
import re

PAGE = pathlib.Path(__file__).resolve().parents[2] / "experiments" / "report" / "page"
D3 = "/usr/share/nodejs/d3/dist/d3.min.js"


def assemble(model, change=lambda name, text: text):
    """The page as one text. `change` may damage a file on the way, to see whether a test notices."""
    def part(match):
        name = match.group(1)
        if name == "model":
            return json.dumps(model).replace("<", "\\u003c")
        if name == "headlines":
            return html.escape("".join(f"{c['sentence']} ({c['sure']})\n" for c in model["claims"] if c["kind"] == "headline"))
        if name == "title":
            return html.escape(model["meta"].get("question") or model["meta"]["title"])
        return change(name, pathlib.Path(D3 if name == "d3.min.js" else PAGE / name).read_text(encoding="utf-8"))
    return re.sub(r"\{\{([\w.]+)\}\}", part, change("index.html", (PAGE / "index.html").read_text(encoding="utf-8")))
