#!/usr/bin/env python3
"""Damages the page in one place at a time: the check that is named must turn red. A check that stays green is decoration.

    mutate.py OUT [WORD]        only damages whose text has WORD; exit 0: all were seen; 1: not; 77: there is no Chromium
"""

import contextlib
import io
import os
import sys

import chromium
import page
from checks import Checks

# File, what is replaced, by what, the check, and (the beginning of) what it must say.
DAMAGES = [
    ("page.js", "truthsSection(),\n", "\n", "sections", "every section is there"),
    ("page.js", "sections.map((part) => choice", "sections.slice(1).map((part) => choice", "sections", "the contents name them all"),
    ("claim.js", "meta.question || meta.title", "meta.title", "sections", "the question heads the page"),
    ("page.css", "position: sticky; top: 0; align-self", "align-self", "sections", "the contents stay in sight"),
    ("page.css", "section + section { margin-top: 40px; }", "section { min-height: 1500px; }", "sections", "the page is below"),
    ("sections.js", "return found && section", "return section", "sections", "what there is not has no section"),
    ("scene.js", "taut render ${scene.id} --video", "", "sections", "a scene without a film says so"),
    ("page.js", "\nstart();\n", "\nstart();\nfetch('https://example.org/x');\n", "sections", "a full model: no"),
    ("page.js", "\nstart();\n", "\nstart();\nconsole.error('x');\n", "sections", "a full model: nothing is logged"),
    ("claim.js", "return fresh.length ? el", "return true ? el", "sections", "nothing that is shown is empty"),
    ("claim.js", "!placed.has(id) && placed.add(id)", "true", "claims", "every claim is placed once"),
    ("claim.js", "value.value === null ? statusOf(value.status).title : ", "", "claims", "each claim holds"),
    ("claim.js", "['left out', [entry.left_out]],", "", "claims", "each claim holds"),
    ("claim.js", "['rule', [entry.rule]],", "", "claims", "each claim holds"),
    ("page.css", "visibility: hidden; opacity: 0; transition", "transition", "claims", "a basis is put away"),
    ("page.css", ".claim:focus-within > .basis", ".none", "claims", "the focus shows it"),
    ("page.css", ".claim.quiet > .basis", ".none", "claims", "Escape puts it away"),
    ("page.css", ".claim:hover > .basis, ", "", "claims", "the pointer shows it"),
    ("claim.js", "bar.text ?? ", "", "claims", "a tile shows"),
    ("chart.js", "measured.push(spec.floor.y);", ";", "charts", "the reference's own error"),
    ("chart.js", "const floorShown = ({floor, series}) =>", "const floorShown = ({floor, series}) => false &&", "charts", "the reference's own error"),
    ("chart.js", "if (!p.failed && !floored && !usable(p)) return;", "if (!floored && !usable(p)) return;", "charts", "each point is drawn"),
    ("chart.js", "...caseLines(point.status, undefined, point.case)]", "]", "charts", "each says value, status and case"),
    ("chart.js", "p.failed ? box.top + 4 + failing.indexOf(s) * box.row", "p.failed ? box.height - 60", "charts", "a failed case is an ×"),
    ("chart.js", "const floored = p.zero && view.kind === 'log';", "const floored = false;", "charts", "exact zeros are triangles"),
    ("chart.js", "'on the axis: exactly zero'", "''", "charts", "the key says"),
    ("chart.js", "if (typeof p.x_low !== 'number'", "if (typeof p.x_lo !== 'number'", "charts", "the cost has bars"),
    ("chart.js", "points.every((p) => p.zero)", "false", "charts", "a chart of zeros"),
    ("focus.js", "setAttribute('tabindex', other === item ? 0 : -1)", "setAttribute('tabindex', 0)", "charts", "a chart is one stop"),
    ("focus.js", "node.addEventListener('focus', show);", "", "charts", "the focus shows what it says"),
    ("focus.js", "row[place + 1]", "row[place]", "charts", "arrows move along"),
    ("focus.js", "ArrowDown: 1}[event.key]]", "ArrowDown: 0}[event.key]]", "charts", "and to the other solver"),
    ("cases.js", "Object.entries(entry.parameters)", "entry.settings.split(',').map((p) => p.split('='))", "charts", "Enter opens the case"),
    ("cases.js", "command(entry.command));", "'');", "charts", "Enter opens the case"),
    ("base.js", "next.append(key, one)", "next.append(key + 's', one)", "charts", "the case has a permalink"),
    ("chart.js", "view.kind = other();", "", "charts", "the vertical scale can be switched"),
    ("chart.js", "view.transform = d3.event.transform;", "", "charts", "a chart can be enlarged"),
    ("chart.js", "Math.ceil(decades / (2 * wanted))", "1", "charts", "ticks have room"),
    ("base.js", "if (size >= 1e-4 && size < 1e6)", "if (true)", "charts", "numbers read right"),
    ("map.js", "tabIndex: -1,\n    'data-group': row, style: `--c:var(--c${i});--i:var(--i${i})`}, statusOf(cell.status).glyph)", "tabIndex: -1,\n    'data-group': row})", "maps", "every cell has a glyph"),
    ("map.js", ".reverse()", "", "maps", "rows go up"),
    ("map.js", "[status.title, status.help]", "[status.title]", "maps", "the legend says"),
    ("map.js", "if (known) button.onclick", "if (!known) button.onclick", "maps", "Enter opens its case"),
    ("base.js", "document.body.classList.toggle('off-'", "document.body.classList.toggle('no-'", "switches", "bullet, switched off, has none"),
    ("cases.js", "!isOff(row.entry.solver) &&", "", "choices", "nor cases in the table"),
    ("focus.js", "state.watch(reset);", "", "choices", "the Tab key still finds"),
    ("scene.js", "box.hidden = i !== now;", "box.hidden = false;", "choices", "a click shows another"),
    ("base.js", "step ? 'pushState' : 'replaceState'", "'replaceState'", "choices", "and back brings"),
    ("cases.js", "if (!dialog.open) dialog.showModal();", "", "choices", "an address shows its scene and its case"),
    ("page.js", "placeOf(wanted)?.scrollIntoView()", "0", "choices", "the address of a section"),
    ("cases.js", "column.numeric ? u - v : ", "", "cases", "sorted by number"),
    ("cases.js", "(down ? -1 : 1)", "1", "cases", "a click sorts the other way"),
    ("cases.js", "['-' + name]: 'descending'", "['-' + name]: 'ascending'", "cases", "and says so"),
    ("cases.js", "Number.isFinite(Number(limit))", "/^[\\d.]+$/.test(limit)", "cases", "find: dt<=5e-2"),
    ("cases.js", "row.entry.status === state.get('ended')", "true", "cases", "statuses and scenes filter"),
    ("cases.js", "casesCsv(rows)", "casesCsv(model.cases)", "cases", "the CSV holds what is shown"),
    ("base.js", "/^[=+\\-@\\t\\r]/.test(value)", "false", "cases", "what begins like a formula"),
    ("base.js", "if (typeof value === 'number') return Number.isFinite(value) ? String(value) : '';", "value = String(value);", "cases", "a negative number stays"),
    ("film.js", "if (!touched || time >= lead.duration - lead.frame) seek(0);", "", "films", "a click plays it from its beginning"),
    ("film.js", "if (!videos[0].paused) return pause();", "", "films", "another one stops it"),
    ("film.js", "ArrowRight: () => step(1)", "ArrowUp: () => step(1)", "films", "after a click the right arrow"),
    ("film.js", "time = Math.max(0, Math.min(lead.duration, t));\n    videos.forEach(place);", "time = Math.max(0, Math.min(lead.duration, t));", "films", "the film is where the clock is"),
    ("film.js", "ArrowLeft: () => step(-1), ", "", "films", "the left one steps back"),
    ("film.js", "{' ': toggle, ", "{", "films", "space plays"),
    ("film.js", "shown(s.y[at], quantity)", "shown(s.y[0], quantity)", "films", "the values beside it"),
    ("page.css", "main { grid-column: 2; min-width: 0;", "main { grid-column: 2; min-width: 1200px;", "layout", "hang, 768 px: no sideways scrolling"),
    ("chart.js", "thin(axisX.selectAll('text').nodes());", "axisX.selectAll('text').attr('dx', '2em');", "layout", "hang, 390 px: no text of a chart"),
    ("page.css", "--muted: #59616e", "--muted: #a9b1be", "layout", "texts have contrast, light"),
    ("page.css", "--muted: #a3adba", "--muted: #59616e", "layout", "texts have contrast, dark"),
    ("film.js", "'aria-label': `Time of the film of ${short(scene.title)} [s]`,", "", "layout", "accessibility: the serious rules"),
    ("scene.js", "box.hidden = false; sceneView.build(i);", "", "prints", "all scenes are printed"),
    ("page.css", ".basis, .tile .basis { position: static; visibility: visible; opacity: 1;", ".basis, .tile .basis { position: static;", "prints", "with the basis of every claim"),
    ("page.css", "  td { overflow-wrap: anywhere; }\n", "", "prints", "paper: nothing is cut at the edge"),
    ("page.js", "part.open = true;", "", "prints", "and all that is folded"),
    ("page.js", "if (sceneView.boxes.length) sceneView.showOne();", "", "prints", "afterwards one scene again"),
    ("base.js", "document.createElement('span');\n  Object.assign(box, {className: 'long', tabIndex: 0, textContent: child});", "document.createElement('span');\n  box.innerHTML = child;", "hostile", "hostile texts do not make the page long"),
    ("base.js", "node.append(...", "node.insertAdjacentHTML('beforeend', children.filter((c) => typeof c === 'string').join('')); node.append(...", "hostile", "markup in a name stays text"),
    ("page.css", "color: var(--ink); overflow-wrap: anywhere;", "color: var(--ink);", "hostile", "hostile texts, 390 px: no sideways"),
    ("index.html", "JavaScript is off", "Welcome", "without_script", "without JavaScript it says"),
    ("index.html", "{{headlines}}", "", "without_script", "without JavaScript the headlines"),
    ("page.js", "\nstart();\n", "\nlet sum = 0;\nfor (let i = 0; i < 3e8; ++i) sum += Math.sqrt(i);\nstart();\n", "drawn", "it is drawn within two seconds"),
    ("index.html", "</html>", "</html>" + 8_000_000 * " ", "drawn", "it is smaller than 8 MB"),
    ("claim.js", "claimsAbout(['note'], ['all', 'only', 'failures'])", "[]", "drawn", "every claim is on the page"),
    ("page.js", "\nstart();\n", "\nstart();\nfetch('https://example.org/x');\n", "drawn", "the report: no"),
    ("scene.js", "box.hidden = i !== now;", "box.hidden = false;", "layout", "ball, 768 px: one scene at a time"),
    ("page.css", "section + section { margin-top: 40px; }", "section { min-height: 1500px; }", "layout", "hang, 1280 px: the page is below"),
    ("claim.js", "return fresh.length ? el", "return true ? el", "layout", "hang, 1280 px: nothing that is shown is empty"),
    ("scene.js", "state.get('scene'))", "state.get('scenes'))", "permalinks", "ball: its address shows it"),
    ("cases.js", "command(entry.command));", "'');", "permalinks", "ball: its case is open"),
    ("page.js", "requestAnimationFrame(() => requestAnimationFrame(() => placeOf(wanted)?.scrollIntoView()))", "0", "permalinks", "hang: the address of a chart"),
    ("base.js", "const isOff = (solver) => state", "const isOff = (solver) => false && state", "permalinks", "the address of a section leads there, its solver"),
    ("cases.js", "row.entry.status === state.get('ended')", "true", "table", "the table says how many"),
    ("cases.js", "(down ? -1 : 1)", "1", "table", "two clicks sort"),
    ("cases.js", "casesCsv(rows)", "casesCsv(model.cases)", "table", "the file holds what is shown"),
    ("cases.js", "download: 'cases.csv'", "download: 'x.csv'", "table", "a click downloads"),
    ("base.js", "return Number.isFinite(value) ? String(value) : '';", "return value.toPrecision(4);", "table", "with every digit"),
    ("map.js", "'data-s': solverOf(map.solver).order},\n            el('figcaption'", "'data-s': 0},\n            el('figcaption'", "switches", "bullet, switched off, has no map"),
    ("cases.js", "!isOff(row.entry.solver) &&", "", "switches", "bullet, switched off, is not in the table"),
    ("index.html", 'href="#main"', 'href="#case"', "keyboard", "the first Tab and Enter"),
    ("page.js", "type: 'button', className: 'switch',", "type: 'button', className: 'switch', tabIndex: -1,", "keyboard", "Tab reaches every control"),
]


def main(out, word):
    program = chromium.find()
    if program is None:
        print("SKIPPED: no chromium on this machine")
        return 77
    os.makedirs(out, exist_ok=True)
    unseen, browser = 0, chromium.Browser(program)
    for file, old, new, check, what in DAMAGES:
        title = f"{file}: {' '.join(old.split())[:60]}"
        if word not in title + check + what:
            continue
        used = []

        def change(name, text):
            if name != file:
                return text
            used.append(old in text)
            return text.replace(old, new)
        checks, said = Checks(browser, out, change), io.StringIO()
        try:
            with contextlib.redirect_stdout(said):
                page.ALL[check](checks)
        except Exception as error:
            checks.failures.append(what + f" ({str(error)[:60]})" if not any(f.startswith(what) for f in checks.failures) else what)
        if not all(used):
            result = "NOT FOUND"
        else:
            result = "seen" if any(f.startswith(what) for f in checks.failures) else "UNSEEN"
        unseen += result != "seen"
        print(f"{result:9} {title}  ->  {what}", "" if result == "seen" else checks.failures[:3], flush=True)
    browser.close()
    print(f"{unseen} of the damages were not seen")
    return 1 if unseen else 0


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else ""))
