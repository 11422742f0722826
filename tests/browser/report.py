#!/usr/bin/env python3
"""Uses a report that taut wrote, without a network, as a reader would: what holds of every report, the sample among them.

    report.py REPORT.html OUT [CHECK...]        exit 0: all is well; 1: it is not; 77: there is no Chromium
"""

import bisect
import csv
import os
import sys
import time

import accessibility
import chromium
from checks import SCENES, SEEN, VISIBLE, Checks

EMPTY = """[...document.querySelectorAll('section, .card, figure, ul, dl, tbody, .claims')]
    .filter(e => e.checkVisibility() && !e.textContent.trim()).map(e => e.outerHTML.slice(0, 80))"""
HEIGHT, WIDTH = "document.documentElement.scrollHeight", "document.documentElement.scrollWidth"


def drawn(checks):
    """From a file, without a network: small, quickly there, whole, and it asks for nothing."""
    page = checks.browser
    page.call("Performance.enable", timeDomain="threadTicks")  # CPU time: others may use the machine
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
    placed = "model.claims.filter(c => !document.getElementById('claim-' + c.id)).map(c => c.id)"
    checks.empty(page.run(placed), "every claim is on the page")
    checks.quiet("the report")


def layout(checks):
    """On a desk, a tablet and a phone: one scene at a time, nothing overlaps, is empty, is cut or leaves the window; both
    themes have contrast and break no serious rule of accessibility."""
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
    """An address brings back the scene, the case, the section or chart and the solvers that it names."""
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
    """Of one scene and one status, sorted by a value at a click: that, in that order, with every digit, is downloaded."""
    page = checks.open()
    every = page.run("model.cases")
    pick = max(every, key=lambda c: len(c["values"]))
    scene, status, metric = pick["scene"], pick["status"], sorted(pick["values"])[-1]
    for name, value in (("in", scene), ("ended", status)):
        page.run(f"""(s => {{ if (s) {{ s.value = {value!r}; s.dispatchEvent(new Event('change')); }} }})
            (document.querySelector('#cases select[name={name}]'))""")
    column = f"caseColumns.findIndex(c => c.name === {metric!r})"
    for _ in range(2):  # rising, falling
        page.run(f"document.querySelectorAll('#cases thead button')[{column}].click()")
    page.settle()
    wanted = [c for c in every if c["scene"] == scene and c["status"] == status]
    said = page.run("document.querySelector('#cases [role=status]').innerText")
    checks.true(said.startswith(f"{len(wanted)} of {len(every)} case"), f"the table says how many of {scene} are {status}", said)
    page.run("document.querySelector('#cases .tall + button').click()")  # all of them
    shown = page.run("[...document.querySelectorAll('#cases tbody th')].map(th => th.textContent)")
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
    """A solver that is switched off leaves charts, maps and table; the others stay; switched on it is back."""
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
    """The first Tab offers to skip to the results; Tab reaches every control that is shown."""
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
    """Play and pause by click and keys; arrows step after a click; the cursor and the values follow."""
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
        """Where the film is once it plays; null if it does not within five seconds."""
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
    click(), click()  # the focus is where a click puts it
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
    """On paper: every scene, every basis, what is folded; afterwards as it was."""
    page = checks.open()
    titles = page.run("model.scenes.map(s => s.title)")
    page.size(688, 900)
    page.media("print")
    checks.true(page.run(SCENES) == titles, "all scenes are printed", page.run(SCENES))
    hidden = page.run(f"[...document.querySelectorAll('.claim:not(.said) > .basis')].filter(e => !({SEEN})(e)).length")
    checks.true(hidden == 0 and page.run("document.querySelectorAll('.basis').length === model.claims.length"), "with the basis of every claim", hidden)
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


ALL = {f.__name__: f for f in (drawn, layout, permalinks, table, switches, keyboard, films, prints)}


def use(report, out, every, names=()):
    """Runs checks (all of `every` without names) on a report, on the sample without one; the exit code."""
    program = chromium.find()
    if program is None:
        print("SKIPPED: no chromium on this machine")
        return 77
    os.makedirs(out, exist_ok=True)
    checks = Checks(chromium.Browser(program), out, report=report)
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
