#!/usr/bin/env python3
"""Uses a report that taut wrote as a reader would, without a network; every report must pass these checks.

    report.py REPORT.html OUT [CHECK...]        exit 0: all checks pass; 1: a check fails; 77: Chromium is missing
"""

import bisect
import csv
import json
import os
import sys
import time

import accessibility
import chromium
from checks import SCENES, SEEN, VISIBLE, Checks

EMPTY = """[...document.querySelectorAll('section, .card, figure, ul, dl, tbody')]
    .filter(e => e.checkVisibility() && !e.textContent.trim()).map(e => e.outerHTML.slice(0, 80))"""
HEIGHT, WIDTH = "document.documentElement.scrollHeight", "document.documentElement.scrollWidth"


def drawn(checks):
    """Opened from a file without a network, the page is small, fast and complete, and requests nothing."""
    page = checks.browser
    page.call("Performance.enable", timeDomain="threadTicks")  # CPU time, as others may use the machine
    page = checks.open()
    spent = {m["name"]: m["value"] for m in page.call("Performance.getMetrics")["metrics"]}["TaskDuration"]
    page.call("Performance.disable")
    checks.true(0 < spent < 2, "it is drawn within two seconds of CPU time", spent)
    size = os.path.getsize(checks.file)
    checks.true(size < 8e6, "it is smaller than 8 MB", size)
    checks.true(page.run("document.querySelectorAll('main > section').length >= 4"), "the sections are drawn")
    for scene in page.run("model.scenes.map(scene => scene.id)"):
        page.run(f"state.set({{scene: {scene!r}}})")
    page.settle()
    checks.quiet("the report")


def layout(checks):
    """On a desktop, a tablet and a phone the page shows one scene at a time; nothing overlaps, is empty, is cut off or leaves the
    window. Both themes have enough contrast and break no serious rule of accessibility."""
    page = checks.open()
    titles = page.run("model.scenes.map(scene => [scene.id, scene.title])")
    for width in (1280, 768, 390):
        page.size(width, 900)
        for scene, title in titles:
            page.run(f"state.set({{scene: {scene!r}}})")
            page.settle()
            here = f"{scene}, {width} px"
            checks.true(page.run(SCENES) == [title], f"{here}: one scene at a time", page.run(SCENES))
            checks.true(page.run(WIDTH) <= width, f"{here}: no sideways scrolling", page.run(WIDTH))
            checks.empty(page.run(accessibility.CROWDED), f"{here}: no text of a chart is cut off or lies on another")
            if width == 1280:
                checks.true(page.run(HEIGHT) < 9000, f"{here}: the page is below 9,000 px", page.run(HEIGHT))
                checks.empty(page.run(EMPTY), f"{here}: nothing that is shown is empty")
        page.screenshot(os.path.join(checks.out, f"page-{width}.png"))
    page.size(1280, 900)
    axe = accessibility.axe_core()
    if not axe:
        print("axe-core itself: not on this machine (npm install -g axe-core, or set AXE_CORE)")
    for theme in ("light", "dark"):
        page.media("", prefers_color_scheme=theme)
        for key in ("", page.run("model.cases[0].key")):
            what = f"{theme}{', in a case' if key else ''}"
            page = checks.open(address=key and f"case={key}")
            checks.empty(page.run(accessibility.CONTRAST), f"texts have contrast, {what}")
            if axe:
                page.run(axe + ";0")
                checks.empty(page.run(accessibility.AXE), f"axe-core finds no serious violation, {what}")
        page.screenshot(os.path.join(checks.out, f"page-{theme}.png"))
    page.media("")
    checks.empty(checks.open().run(accessibility.RULES), "accessibility: the serious rules, written out")


def permalinks(checks):
    """An address restores the scene, the case, the section or chart, and the solvers that it names."""
    page = checks.open()
    studied = page.run("""model.scenes.filter(s => s.studied).map(s => {
        const one = model.cases.findLast(c => c.scene === s.id); return [s.id, s.title, s.charts?.[0], one.key, one.command]; })""")
    for scene, title, chart, key, command in studied:
        page = checks.open(address=f"scene={scene}&case={key}")
        checks.true(page.run(SCENES) == [title], f"{scene}: its address shows it", page.run(SCENES))
        said = page.run("document.querySelector('dialog').open && document.querySelector('dialog').innerText") or ""
        checks.true(key in page.run("location.hash") and command in said, f"{scene}: its case is open, with its command", said[:200])
        page = checks.open(address=f"scene={scene}&at=chart-{chart}")
        page.run("new Promise(done => setTimeout(done, 900))")
        top = page.run(f"document.getElementById('chart-{chart}').getBoundingClientRect().top")
        checks.true(-5 < top < 150, f"{scene}: the address of a chart leads there", top)
    solver = page.run("model.solvers[0].id")
    page = checks.open(address=f"at=method&off={solver}")
    page.run("new Promise(done => setTimeout(done, 900))")
    at = page.run("[innerHeight - document.querySelector('#method').getBoundingClientRect().top, document.querySelector('.switch')?.ariaPressed]")
    checks.true(at[0] > 300 and at[1] in ("false", None), "the address of a section leads there, its solver is off", at)


def table(checks):
    """The table, filtered by scene and status and sorted by a click, is downloaded with these rows in this order with all digits."""
    page = checks.open()
    every = page.run("model.cases")
    pick = max(every, key=lambda c: len(c["values"]))
    scene, status, metric = pick["scene"], pick["status"], sorted(pick["values"])[-1]
    for name, value in (("in", scene), ("ended", status)):
        page.run(f"""(s => {{ if (s) {{ s.value = {value!r}; s.dispatchEvent(new Event('change')); }} }})
            (document.querySelector('#cases select[name={name}]'))""")
    page.run("document.querySelector('#cases details').open = true")
    head = f"document.querySelector('#cases thead [data-column={json.dumps(metric)}]')"
    if not page.run(f"!!{head}"):
        page.run(f"[...document.querySelectorAll('#cases .chooser label')][caseColumns.filter(c => c.extra).findIndex(c => c.name === {metric!r})].click()")
        page.settle()
    checks.true(page.run(f"!!{head}"), f"the column {metric} is shown when it is chosen")
    for _ in range(2):  # ascending, descending
        page.run(head + ".click()")
        page.settle()
    page.settle()
    wanted = [c for c in every if c["scene"] == scene and c["status"] == status]
    said = page.run("document.querySelector('#cases [role=status]').innerText")
    checks.true(said.startswith(f"{len(wanted)} of {len(every)} case"), f"the table says how many of {scene} are {status}", said)
    page.run("document.querySelector('#cases .tall + button').click()")  # shows all rows
    shown = page.run("[...document.querySelectorAll('#cases tbody tr')].map(tr => tr.dataset.key)")
    values = {c["key"]: c["values"].get(metric) for c in wanted}
    falling = [values[key] for key in shown if values.get(key) is not None]
    checks.true(sorted(shown) == sorted(values), f"the table is of {scene}, {status}", f"{len(shown)} of {len(values)}")
    checks.true(len(falling) > 1 and falling == sorted(falling, reverse=True), f"two clicks sort by {metric}, largest first", falling[:9])
    folder = os.path.abspath(checks.out)
    file = os.path.join(folder, "cases.csv")
    if os.path.exists(file):
        os.remove(file)
    page.call("Page.setDownloadBehavior", behavior="allow", downloadPath=folder)
    page.run("document.querySelector('#cases .button').click()")
    end = time.time() + 10
    while not os.path.exists(file) and time.time() < end:
        page.settle()
    checks.true(os.path.exists(file), "a click downloads cases.csv")
    if os.path.exists(file):
        with open(file, newline="", encoding="utf-8") as read:
            rows = list(csv.DictReader(read))
        checks.true([row["case"] for row in rows] == shown, "the file holds what is shown", f"{len(rows)} of {len(shown)}")
        off = [row for row in rows if (row[metric] or None) != (None if values[row["case"]] is None else row[metric])
               or row[metric] and float(row[metric]) != values[row["case"]]]
        checks.empty(off, "with every digit")
    page.run("state.set({in: '', ended: '', sort: ''})")


def switches(checks):
    """A solver that is switched off disappears from charts, maps and table, while others stay; switched on it reappears."""
    page = checks.open()
    solvers = page.run("""model.solvers.map(solver => [solver.id,
        model.charts.find(c => c.kind !== 'series' && c.series.some(s => s.solver === solver.id))?.scene])""")
    points = f"{VISIBLE}('.point').map(p => +p.closest('[data-s]').dataset.s)"
    maps = f"{VISIBLE}('table.map').map(m => m.closest('figure').id.slice(4)).sort()"
    said = "document.querySelector('#cases [role=status]').innerText"
    checks.true(len(solvers) > 1 and any(scene for _, scene in solvers), "several solvers have points", solvers)
    for i, (solver, scene) in enumerate(solvers):
        scene = scene or ""
        page.run(f"state.set({{scene: {scene!r}}})")
        page.settle()
        before = page.run(points)
        others = page.run(f"all(scenes.get({scene!r} || model.scenes[0].id).maps, maps).filter(m => m.solver !== {solver!r}).map(m => m.id).sort()")
        checks.true(before.count(i) > 0 or not scene, f"{solver} has points")
        page.run(f"document.querySelectorAll('.switch')[{i}].click()")
        page.settle()
        checks.true(page.run(points) == [k for k in before if k != i], f"{solver}, switched off, has none, the others stay")
        checks.true(page.run(maps) == others, f"{solver}, switched off, has no map, the others stay", page.run(maps))
        left = page.run(f"model.cases.filter(c => c.solver !== {solver!r}).length")
        checks.true(page.run(said).startswith(f"{left} of "), f"{solver}, switched off, is not in the table", page.run(said))
        page.run(f"document.querySelectorAll('.switch')[{i}].click()")
        page.settle()
        checks.true(page.run(points) == before, f"{solver}, switched on again, is back")


def keyboard(checks):
    """The first Tab offers to skip to the results; Tab reaches every visible control."""
    page = checks.open()
    page.press("Tab")
    skip = page.run("document.activeElement.className")
    page.press("Enter")
    checks.true(skip == "skip" and page.run("document.activeElement.id") == "main", "the first Tab and Enter skip to the results", skip)
    page.run("document.activeElement.blur(); window.reached = new Set(); addEventListener('focusin', (e) => reached.add(e.target))")
    controls = VISIBLE + "('a[href], button:not([disabled]), input, select, summary, [tabindex=\"0\"]').filter(e => e.tabIndex >= 0)"
    for _ in range(2 * page.run(controls + ".length")):
        for kind in ("keyDown", "keyUp"):
            page.call("Input.dispatchKeyEvent", type=kind, key="Tab", windowsVirtualKeyCode=9)
    page.settle()
    checks.true(page.run("reached.size") > 30, "Tab goes on")
    checks.empty(page.run(controls + ".filter(e => !reached.has(e)).map(e => e.outerHTML.slice(0, 90))"), "Tab reaches every control")


def films(checks):
    """A film plays and pauses by click and by keys; arrows step after a click; cursor and values follow."""
    page = checks.open()
    list_ = page.run("(model.films ?? []).filter(f => f.src && f.type.startsWith('video/')).map(({src, poster, ...film}) => film)")
    if not list_:
        print("skipped: no ffmpeg, so no film")
        return
    film = list_[0]
    page.media("", prefers_reduced_motion="reduce")
    page = checks.open(address=f"scene={film['scene']}")
    player = f"{VISIBLE}('.player')[0]"
    page.run(f"{player}.scrollIntoView({{block: 'center', behavior: 'instant'}})")
    page.settle()
    now = f"parseFloat({player}.querySelector('.clock').textContent)"
    video = f"{player}.querySelector('video')"
    checks.true(page.run(f"{video}.paused") and abs(page.run(now) - film["poster_t"]) < 0.01, "it stands at its poster", page.run(now))
    x, y = page.run(f"(b => [b.left + b.width / 2, b.top + b.height / 2])({video}.getBoundingClientRect())")

    def click():
        for kind in ("mousePressed", "mouseReleased"):
            page.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def moving():
        """Position of the film once it plays; null if it does not play within five seconds."""
        return page.run(f"""new Promise(done => {{
            const end = Date.now() + 5000, look = () => {video}.currentTime > 0 && !{video}.paused ? done({video}.currentTime)
                : Date.now() > end ? done(null) : setTimeout(look, 10);
            look(); }})""")

    def drag(to):
        """Moves the slider to a time [s]."""
        page.run(f"(s => {{ s.value = {to}; s.dispatchEvent(new Event('input')); }})({player}.querySelector('input[type=range]'))")
        page.settle()
    page.run(f"{video}.addEventListener('playing', () => {{ window.first = {video}.currentTime; }}, {{once: true}})")
    click()
    first = page.run("window.first") if moving() is not None else None
    checks.true(first is not None and first < 0.5, "a click plays it from its beginning", first)
    click()
    page.settle()
    checks.true(page.run(f"{video}.paused"), "another one stops it")
    drag(0.3 * film["duration"])
    click()
    click()  # moves the focus to the film
    page.settle()
    start, frame = page.run(now), film["frame"]
    page.press("ArrowRight", "ArrowRight", "ArrowRight")
    page.run("new Promise(done => setTimeout(done, 200))")
    stepped = page.run(now) - start
    checks.true(1.9 * frame < stepped < 4.2 * frame, "after a click the right arrow steps frames", stepped)
    shown = page.run(f"{video}.currentTime") * film["speed"]
    checks.true(abs(shown - page.run(now)) < 0.02, "the film is where the clock is", shown)
    page.press("ArrowLeft")
    checks.true(page.run(now) < start + stepped - frame / 2, "the left one steps back")
    page.press(" ")
    checks.true(moving() is not None, "space plays")
    page.press(" ")
    checks.true(page.run(f"{video}.paused"), "and stops")
    track = film["tracks"][0]
    line, scale = track["series"][0], page.run(f"metric({track['metric']!r}).scale")
    cursor = f"parseFloat({player}.querySelector('.cursor').getAttribute('d').slice(1))"
    places = []
    for share in (0.75, 0.25):
        drag(share * film["duration"])
        its = line["y"][bisect.bisect_right(line["t"], page.run(f"+{player}.querySelector('input[type=range]').value") + 1e-9) - 1] * scale
        said = page.run(f"{player}.querySelector('.key output').textContent").replace("−", "-").split("\u00a0")[0]
        said = said.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")).replace("×10", "e")
        checks.true(abs(float(said) - its) <= 0.01 * abs(its), "the values beside it are those of the moment", [said, its])
        places.append(page.run(cursor))
    checks.true(places[1] < places[0] - 50, "and the cursor moves", places)
    wanted = film["panels"][0]["settings"][:100]
    checks.true(wanted in page.run(f"{player}.querySelector('.panels').innerText"), "captions name the settings")
    checks.quiet("a film")
    page.media("")


def prints(checks):
    """Paper shows the selection with every scene, every question with its scenes, and folded parts. The screen is unchanged afterwards."""
    page = checks.open()
    titles = page.run("model.scenes.map(s => s.title)")
    page.media("print")
    checks.true(page.run(SCENES) == [], "scenes are not printed unless they are chosen", page.run(SCENES))
    checks.true(page.run(f"({SEEN})(document.getElementById('answer'))"), "the answer is")
    page.media("")
    page.settle()
    page.run("document.querySelectorAll('.to-paper input:not(:checked)').forEach(box => box.click())")
    page.size(688, 900)
    page.media("print")
    checks.true(page.run(SCENES) == titles, "all scenes are printed", page.run(SCENES))
    hidden = page.run(f"[...document.querySelectorAll('.answer tr')].filter(e => !({SEEN})(e)).length")
    checks.true(hidden == 0, "every question has its scenes", hidden)
    checks.true(page.run("[...document.querySelectorAll('main details')].every(d => d.open)"), "and all that is folded")
    checks.true(page.run("[...document.querySelectorAll('.plot svg')].every(s => s.childElementCount)"), "every chart is drawn")
    checks.empty(page.run(accessibility.CROWDED), "paper: no text of a chart is cut off or lies on another")
    checks.true(page.run(WIDTH) <= 688, "paper: nothing is cut at the edge", page.run(WIDTH))
    page.media("")
    page.size(1280, 900)
    page.settle()
    checks.true(page.run(SCENES) == titles[:1] and page.run("document.querySelectorAll('#scenes details[open]').length") == 0,
                "afterwards one scene again, folded", page.run(SCENES))
    page.pdf(os.path.join(checks.out, "page.pdf"))
    checks.true(page.run(SCENES) == titles[:1], "after a real print, too")


def answer(checks):
    """The first screen shows every question with all its cells within 1280 x 800. On a phone it shows them without notes, and a map
    is as wide as the screen and has its first scene. A click unfolds its scenes; a number leads to its case and its command."""
    page = checks.open()
    tables = checks.model()[0]["answer"]["tables"]
    page.size(1280, 800)
    page.settle()
    mapped = page.run("Boolean(model.winners)")
    bottom = f"document.querySelector('{'#winners tbody' if mapped else '.answer'}').getBoundingClientRect().bottom"
    checks.true(page.run(bottom) <= 800, "the answer is one screen", page.run(bottom))
    page.size(390, 844)
    page.run("state.set({open: 'none'})")
    page.settle()
    if mapped:
        bottom = "document.querySelector('#winners tbody tr').getBoundingClientRect().bottom"
        wide = page.run("(box => box.scrollWidth - box.clientWidth)(document.querySelector('#winners .scroll'))")
        checks.true(wide <= 1, "on a phone the map needs no scrolling sideways", wide)
    checks.true(page.run(bottom) <= 844, "and one of a phone", page.run(bottom))
    page.size(1280, 800)
    for name, table in tables.items():
        page.run(f"state.set({{open: {name!r}}})")
        page.settle()
        body = f"document.getElementById('answer-{name}')"
        rows = page.run(f"[...{body}.querySelectorAll('tr:not(.folded)')].map(tr => [...tr.querySelectorAll('td:not([colspan])')].map(td => td.innerText))")
        each = len(table["rows"]) - 1 if len(table["rows"]) > 2 else 0
        checks.true(len(rows) == 2 + each, f"{name}: it unfolds to its scenes", len(rows))
        cells = [cell for row in rows for cell in row]
        values = [value for row in table["rows"][-1:] + table["rows"][:each] for value in row[1:]]
        scale = table["columns"][1].get("scale", 1)
        wrong = []
        for said, value in zip(cells, values, strict=True):
            first = said.split("\u00a0")[0].split()[0].replace("−", "-").replace("\u202f", "") if said else ""
            if isinstance(value, str):
                wrong += [] if value[:40] in said else [[said, value]]
            elif value is not None:
                value = (value[1] if isinstance(value, list) else value) * scale
                number = float(first.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")).replace("×10", "e"))
                wrong += [] if abs(number - value) <= 0.06 * abs(value) + 1e-12 else [[said, value]]
        checks.empty(wrong, f"{name}: each cell says its value")
        marked = page.run(f"{body}.querySelectorAll('tr:not(.folded) .best').length")
        best = sum(n.get("best", False) and (n["row"] == len(table["rows"]) - 1 or each > 0) for n in table["notes"])
        checks.true(marked == best, f"{name}: the best are marked", [marked, best])
    names = page.run("answered")
    for scene in names:
        page.run(f"[...document.querySelectorAll('#answer-scenes a')].find(a => a.textContent === {scene!r}).click()")
        page.settle()
        wrong = []
        for name, table in tables.items():
            its = [row for row in table["rows"] if str(row[0]).split(" (")[0] == scene]
            said = page.run(f"[...document.getElementById('answer-{name}').querySelectorAll('.question td')].map(td => td.innerText)")
            lacking = its and sum(value is not None for value in its[0][1:]) != sum(map(bool, said))
            wrong += [[name, said]] if lacking or not its and any(said) else []
        checks.empty(wrong, f"{scene} chosen: each question has its cells and no others")
    if len(names) > 1:
        checks.true(page.run("state.get('scene')") == names[-1], "the choice is in the address")
        page.run("state.set({scene: ''})")
    link = "document.querySelector('.answer .fold:not(.folded) .to-case')"
    page.run("state.set({open: 'stretch.rms'})")
    page.settle()
    label = page.run(f"{link}.ariaLabel")
    page.run(f"{link}.click()")
    page.settle()
    entry = page.run("cases.get(state.get('case'))")
    dialog = page.run("document.querySelector('dialog').innerText")
    checks.true(entry["command"] in dialog and entry["key"] in label, "a click opens its case with the command", [label, dialog[:99]])
    page.press("Escape")


def winners(checks):
    """For each scene and error the map names the cheapest solver, its lead, cost and setting, or the reason why no solver is cheapest.
    Each number in its sentences is a link."""
    page = checks.open()
    model = checks.model()[0]
    if "winners" not in model:
        checks.true(page.run("document.getElementById('winners')") is None, "nothing was timed: no map")
        return
    titles, rows = {s["id"]: s["title"] for s in model["solvers"]}, model["winners"]["rows"]
    cells = "document.querySelectorAll('#winners .scroll:not([hidden]) tbody tr:not(.detail)')"
    said = page.run(f"[...{cells}].map(tr => [...tr.querySelectorAll('td')].map(td => td.innerText))")
    checks.true([len(row) for row in said] == [len(row["cells"]) for row in rows], "a cell for each error of each scene", said)
    long = [text for row in said for text in row if len(text.strip().split("\n")) > 3]
    checks.empty(long, "a cell has at most three lines")
    wrong = []
    kept = lambda text: text.replace(" × ", "\u00a0×\u00a0")
    for r, row in enumerate(rows):
        for c, cell in enumerate(row["cells"]):
            names = [titles[one["solver"]] for one in cell.get("cheapest", [])] or ["nobody"]
            wrong += [[said[r][c], name] for name in names if name not in said[r][c]]
            page.run(f"{cells}[{r}].querySelectorAll('td button')[{c}].getAttribute('aria-expanded') === 'true' || "
                     f"{cells}[{r}].querySelectorAll('td button')[{c}].click()")
            opened = page.run("document.querySelector('#winners .scroll:not([hidden]) .detail:not([hidden])').innerText")
            wanted = [cell["why"]] if "why" in cell else []
            for one in cell.get("cheapest", []):
                wanted += [titles[one["solver"]], kept(one["setting"]), one["arithmetic"].split(" (")[0], one["command"]]
            for one in (cell.get("next"), cell.get("bullet")):
                wanted += [titles[one["solver"]], kept(one["setting"])] if one else []
            wrong += [[opened, part] for part in wanted if part not in opened]
    checks.empty(wrong, "each cell names its solvers, and opens to their settings and commands")
    page.run("[...document.querySelectorAll('#winners .kinds button')][1].click()")
    heads = page.run("[...document.querySelectorAll('#winners .scroll:not([hidden]) thead th')].length")
    checks.true(heads == 1 + len(model["winners"]["by_stretch"]["levels"]), "a switch shows the map by stretch alone", heads)
    page.run("[...document.querySelectorAll('#winners .kinds button')][0].click()")
    parts = [part["text"] for sentence in model["winners"]["sentences"] for part in sentence if any(c.isdigit() for c in part["text"])]
    linked = page.run("[...document.querySelectorAll('.finding a')].map(a => a.textContent)")
    checks.true(set(parts) <= set(linked), "each number of a sentence is a link", [linked, parts])
    if page.run("document.querySelector('.finding .to-case') !== null"):  # else nobody wins
        page.run("document.querySelector('.finding .to-case').click()")
        page.settle()
        checks.true(page.run("cases.has(state.get('case'))"), "that opens its case")
        page.press("Escape")
    terms = {term["term"]: term["meaning"] for term in model.get("terms", [])}
    shown = set(page.run("[...document.querySelectorAll('#winners .setting')].map(e => e.title)"))
    wanted = {"\n".join(f"{term}: {terms[term]}" for term in one.get("terms", []) if term in terms)
              for row in rows + model["winners"]["by_stretch"]["rows"] for cell in row["cells"] for one in [*cell.get("cheapest", []), *filter(None, [cell.get("next"), cell.get("bullet")])]}
    checks.true(shown <= wanted, "the tooltip of a setting explains what it names and nothing else", [list(shown)[:3], list(wanted)[:3]])


def charts(checks):
    """Each quantity has a figure with a panel for each scene, all on the same axes."""
    page = checks.open()
    specs = [c for c in page.run("model.charts.map(({id, kind, scene, x, y, zeros}) => ({id, kind, scene, zeros, x: x.metric, y: y.metric}))")
             if c["kind"] not in ("series", "step")]
    for quantity in dict.fromkeys(c["y"] for c in specs):
        page.run(f"state.set({{chart: {quantity!r}}})")
        page.run("document.querySelectorAll('.first .panel').forEach(panel => { panel.hidden = false; })")  # one scene at a time
        page.settle()
        for x in dict.fromkeys(c["x"] for c in specs if c["y"] == quantity):
            own = [c for c in specs if (c["x"], c["y"]) == (x, quantity)]
            panels = page.run("(ids => ids.map(id => document.getElementById(id)).map(p => p && [...p.querySelectorAll('.axis.y .tick')].map(t => "
                              f"[t.textContent, t.getAttribute('transform')].join(' '))))({json.dumps(['chart-' + c['id'] for c in own])})")
            drawn = [ticks for c, ticks in zip(own, panels, strict=True) if not c.get("zeros")]
            checks.true(None not in panels and all(drawn), f"{quantity} over {x}: each scene has its panel", panels)
            checks.true(len(set(map(tuple, drawn))) <= 1, f"{quantity} over {x}: on the same axis", drawn[:2])
            same = page.run(f"new Set({json.dumps(['chart-' + c['id'] for c in own])}.map(id => document.getElementById(id).closest('figure'))).size")
            checks.true(same == 1, f"{quantity} over {x}: in one figure under one key", same)


def points(checks):
    """Points of a chart state value, status and case; arrows move between them, and Enter opens the case. Cells of maps do the same."""
    page = checks.open()
    spec = page.run("(c => ({id: c.id, scene: c.scene, series: c.series}))(model.charts.find(c => c.kind === 'convergence'))")
    page.run(f"state.set({{scene: {spec['scene']!r}}})")
    page.settle()
    chart = f"document.getElementById('chart-{spec['id']}')"
    labels = page.run(f"[...{chart}.querySelectorAll('.point')].map(p => p.getAttribute('aria-label'))")
    every = [p for s in spec["series"] for p in s["points"]]
    lacking = [p["case"] for p, label in zip(every, labels, strict=True) if p["case"] not in label or "status: " + p["status"] not in label]
    checks.empty(lacking, "each point says its status and its case")
    here = "document.activeElement.getAttribute('aria-label') || ''"
    page.run(f"{chart}.querySelector('.point[tabindex=\"0\"]').focus()")
    page.press("ArrowRight")
    checks.true(every[1]["case"] in page.run(here), "arrows move along the curve", page.run(here))
    page.press("Enter")
    checks.true(page.run("state.get('case')") == every[1]["case"], "Enter opens the case", page.run("location.hash"))
    page.press("Escape")
    checks.true(every[1]["case"] in page.run(here), "and the focus is where it was")
    map_ = page.run("(m => m && ({id: m.id, scene: m.scene, cells: m.cells}))(model.maps?.[0])")
    checks.true(bool(map_), "there is a map")
    page.run(f"state.set({{scene: {map_['scene']!r}}})")
    page.settle()
    shown = page.run(f"[...document.querySelectorAll('#map-{map_['id']} .cell')].map(c => [c.textContent, c.getAttribute('aria-label')])")
    glyphs = page.run("Object.fromEntries(model.statuses.map(s => [s.id, s.glyph]))")
    by_case = {c["case"]: c for c in map_["cells"]}
    wrong = [label for glyph, label in shown if not any(key in label and glyphs[c["status"]] == glyph for key, c in by_case.items())]
    checks.true(len(shown) == len(by_case), "every cell is there")
    checks.empty(wrong, "and has its glyph and its case")


HOSTILE = ["<img src=x onerror='window.harmed = 1'>", "</script><script>window.harmed = 1</script>", "=HYPERLINK(1)",
           "\u202eright to left", "w" * 3000]


def hostile(checks):
    """Texts from users stay texts and do not break the layout."""
    model = checks.model()[0]
    for i, case in enumerate(model["cases"]):
        case.update(brief=HOSTILE[i % 5], reason=HOSTILE[(i + 1) % 5])
    for i, scene in enumerate(model["scenes"]):
        scene.update(summary=HOSTILE[i % 5])
    for table in list(model["answer"]["tables"].values()) + list(model["tables"].values()):
        table["title"], table["caption"] = HOSTILE[0] + table["title"], HOSTILE[4]
        for i, row in enumerate(table["rows"]):
            row[1:] = [HOSTILE[(i + 1) % 5] if isinstance(value, str) else value for value in row[1:]]
    model["meta"]["question"] = HOSTILE[0] + HOSTILE[4]
    page = checks.open(model)
    checks.true(page.run("window.harmed === undefined && !document.querySelector('main img[onerror]')"), "markup in a text stays text")
    for width in (1280, 390):
        page.size(width, 900)
        page.settle()
        checks.true(page.run(WIDTH) <= width, f"hostile texts, {width} px: no sideways scrolling", page.run(WIDTH))
    page.size(1280, 900)
    page.settle()
    checks.quiet("hostile texts")


def without_script(checks):
    """Without JavaScript the page shows the answer and says what is missing."""
    page = checks.browser
    page.call("Emulation.setScriptExecutionDisabled", value=True)
    page.open(checks.report)
    tree = page.call("Accessibility.getFullAXTree")["nodes"]
    page.call("Emulation.setScriptExecutionDisabled", value=False)
    text = " ".join(n.get("name", {}).get("value", "") for n in tree if n.get("role", {}).get("value") in ("StaticText", "heading"))
    lacking = [t["title"] for t in checks.model()[0]["answer"]["tables"].values() if t["title"] not in text]
    checks.empty(lacking, "without JavaScript the answer is there")
    checks.true("JavaScript is off" in text and "taut report --json" in text, "and what is missing is said", text[:300])


def compared(checks):
    """Column heads state a solver's precision, a film names the solvers that it lacks, and differences come first for two folders."""
    model, _, _ = checks.model()
    solver = model["solvers"][0]
    page = checks.open()
    head = page.run(f"document.querySelector('#answer thead [data-s=\"0\"]').innerText")
    checks.true(solver["arithmetic"].split(" (")[0] in head.replace("\u00a0", " "), "the head of a column has its arithmetic", head)
    with_film = next((s for s in model["scenes"] if s.get("film")), None)
    if with_film:
        film = next(f for f in model["films"] if f["id"] == with_film["film"])
        film["panels"] = film["panels"][:1]
        page = checks.open(model, f"scene={with_film['id']}")
        said = page.run(f"{VISIBLE}('.player')[0].innerText")
        columns = len(next(iter(model["answer"]["tables"].values()))["columns"]) - 1
        checks.true(f"1 of {columns} solvers compared" in said or columns == 1, "a film says who is not in it", said[:300])
    model, _, _ = checks.model()
    model["differences"] = {"a": "before", "b": "after", "matched": "by names", "tables": []}
    page = checks.open(model)
    order = page.run("[...document.querySelectorAll('#main > section')].slice(0, 2).map(s => s.id)")
    checks.true(order == ["differences", "answer"], "what differs comes first", order)
    heads = page.run("[...document.querySelectorAll('#main > section > h1, #answer h2')].map(h => h.textContent)")
    checks.true(len(heads) == 2 and heads[1] == "B alone: after", "the values of B say that they are its alone", heads)
    checks.quiet("with differences")


ALL = {f.__name__: f for f in (drawn, answer, winners, compared, charts, layout, permalinks, table, points, switches, keyboard, films, prints, hostile, without_script)}


def use(report, out, every, names=()):
    """Runs the named checks on a report, or all of `every`; returns the exit code."""
    program = chromium.find()
    if program is None:
        print("SKIPPED: no chromium on this machine")
        return 77
    os.makedirs(out, exist_ok=True)
    checks = Checks(chromium.Browser(program), out, os.path.abspath(report))
    checks.browser.call("Network.emulateNetworkConditions", offline=True, latency=0, downloadThroughput=-1, uploadThroughput=-1)
    try:
        for name in names or every:
            every[name](checks)
    finally:
        checks.browser.close()
    print(f"{len(checks.failures)} failures; pictures in {out}")
    return 1 if checks.failures else 0


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    sys.exit(use(sys.argv[1], sys.argv[2], ALL, sys.argv[3:]))
