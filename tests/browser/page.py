#!/usr/bin/env python3
"""Uses the report's page in headless Chromium, with made-up models. Pictures for a human look go to OUT.

    page.py OUT [CHECK...]        exit 0: all is well; 1: it is not; 77: there is no Chromium
"""

import csv
import io
import json
import os
import sys
import urllib.parse

import accessibility
import assemble
import report
import sample
from checks import SEEN, VISIBLE


def sections(checks):
    """Every part of a full model is shown, no section of a bare one is empty."""
    page = checks.open(sample.make())
    shown = page.run("[...document.querySelectorAll('main > section')].map(s => s.id)")
    checks.true(shown == ["answer", "differences", "scenes", "cost", "truths", "regressions", "cases", "method"],
                "every section is there, in order", shown)
    linked = page.run("[...document.querySelectorAll('#contents li a')].map(a => a.hash.slice(4))")
    checks.true(linked == shown, "the contents name them all", linked)
    checks.true(page.run("document.querySelector('h1').textContent") == "Which solver stretches less?", "the question heads the page")
    page.run("scrollTo(0, document.body.scrollHeight)")
    page.settle()
    top = page.run("document.querySelector('#contents').getBoundingClientRect().top")
    checks.true(0 <= top < 20, "the contents stay in sight", top)
    checks.true(page.run("document.documentElement.scrollHeight") < 9000, "the page is below 9,000 px")
    checks.quiet("a full model")
    page = checks.open(sample.bare())
    shown = page.run("[...document.querySelectorAll('main > section')].map(s => s.id)")
    checks.true(shown == ["answer", "scenes", "cases", "method"], "what there is not has no section", shown)
    empty = page.run("""[...document.querySelectorAll('section, .card, figure, ul, dl, tbody, .claims, .tiles')]
        .filter(e => e.checkVisibility() && !e.matches('.tiles:empty') && !e.innerText.trim()).map(e => e.outerHTML.slice(0, 80))""")
    checks.empty(empty, "nothing that is shown is empty")
    checks.true("taut render hang --video" in page.run("document.querySelector('#scenes').innerText"), "a scene without a film says so")
    checks.quiet("a bare model")


def claims(checks):
    """Every sentence is on the page once, with what it rests on at the pointer, at the focus and in print."""
    model = sample.make()
    page = checks.open(model)
    for scene in model["scenes"]:
        page.run(f"state.set({{scene: {json.dumps(scene['id'])}}})")
        page.settle()
    found = page.run("""[...document.querySelectorAll('.claim')].map(c =>
        [c.id.slice(6), c.textContent, [...c.querySelectorAll('.value')].map(v => v.textContent)])""")
    placed = sorted(i for i, _, _ in found)
    checks.true(placed == sorted(c["id"] for c in model["claims"]), "every claim is placed once", placed)
    texts, values, lacking = {i: text for i, text, _ in found}, {i: v for i, _, v in found}, []
    for claim in model["claims"]:
        entry = claim["basis"][0]
        wanted = [claim["sentence"], claim["sure"], entry["window"], entry["rule"], entry["settings"][0]["text"], entry["left_out"], "RMS stretch",
                  *entry["scenes"], "5 ok, 1 exploded"]
        lacking += [f"{claim['id']}: {w}" for w in wanted if w not in texts.get(claim["id"], "")]
        numbers = [v["text"] if v["value"] is not None else v["status"] for v in entry["values"]]
        if sorted(numbers) != sorted(values.get(claim["id"], [])):
            lacking.append(f"{claim['id']}: {numbers}, not {values.get(claim['id'])}")
    checks.empty(lacking, "each claim holds its metric, window, rule, settings, scenes, values, failures and how sure")
    page.run("scrollTo({top: 0, behavior: 'instant'})")
    hidden = f"!({SEEN})(document.querySelector('#basis-head'))"
    checks.true(page.run(hidden), "a basis is put away at first")
    page.run("document.querySelector('#claim-head .sure').focus()")
    page.run("new Promise(done => setTimeout(done, 500))")
    checks.true(not page.run(hidden), "the focus shows it")
    page.press("Escape")
    page.run("new Promise(done => setTimeout(done, 500))")
    checks.true(page.run(hidden), "Escape puts it away")
    page.run("document.activeElement.blur()")
    x, y = page.run("(b => [b.left + 30, b.top + 8])(document.querySelector('#claim-head p').getBoundingClientRect())")
    page.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
    page.run("new Promise(done => setTimeout(done, 600))")
    checks.true(not page.run(hidden), "the pointer shows it")
    bars = page.run("[...document.querySelectorAll('#claim-tile li')].map(li => li.innerText.replace(/\\s+/g, ' '))")
    checks.true(bars == ["Jakobsen 0.6 %", "Bullet no value"], "a tile shows each solver's number, a failure too", bars)


def charts(checks):
    """Points have their marks, are reached by the keyboard, say what they are, and lead to their case."""
    model = sample.make()
    page = checks.open(model)
    chart = "document.querySelector('#chart-hang-convergence')"
    spec = next(c for c in model["charts"] if c["id"] == "hang-convergence")
    labels = page.run(f"[...{chart}.querySelectorAll('.point')].map(p => p.getAttribute('aria-label'))")
    points = [p for s in spec["series"] for p in s["points"]]
    checks.true(len(labels) == len(points), "each point is drawn, a failed one too", f"{len(labels)} of {len(points)}")
    lacking = [f"{p['case']}: {label}" for p, label in zip(points, labels) if p["case"] not in label or "status: " + p["status"] not in label or
               (not p["failed"] and abs(float(label.split("stretch: ")[1].split("\u00a0")[0]) / 100 / p["y"] - 1) > 1e-3)]
    checks.empty(lacking, "each says value, status and case")
    costs = page.run("[...document.querySelectorAll('#chart-hang-cost .point')].map(p => p.getAttribute('aria-label'))")
    checks.empty([label for label in costs if "95 %: " not in label], "each cost says its interval")
    place = page.run(f"""(c => [c.querySelector('.glyph').textContent, c.querySelector('.glyph').getBoundingClientRect().bottom,
        Math.min(...[...c.querySelectorAll('.dot')].map(d => d.getBoundingClientRect().top))])({chart})""")
    checks.true(place[0] == "×" and place[1] < place[2], "a failed case is an × above all points", place)
    floor = page.run(f"(c => ['.floor', '.axis.x'].map(s => c.querySelector(s).getBoundingClientRect().top))({chart})")
    checks.true(floor[0] < floor[1] - 4, "the reference's own error lies in the picture", floor)
    zeros = page.run("document.querySelectorAll('#chart-hang-penetration .zero').length")
    checks.true(zeros == 5, "exact zeros are triangles on the axis", zeros)
    key = page.run("document.querySelector('#chart-hang-penetration .key').innerText")
    checks.true("above the plot: exploded" in key and "on the axis: exactly zero" in key, "the key says what × and triangle are", key)
    cost = page.run("document.querySelector('#chart-hang-cost .error').getAttribute('d')")
    checks.true(cost.count("H") == 6, "the cost has bars", cost)
    flat = page.run("document.querySelector('#chart-hang-zeros').innerText")
    checks.true("Every value is exactly zero (6 cases)" in flat, "a chart of zeros only says so", flat)
    stops = page.run(f"[...{chart}.querySelectorAll('.point')].filter(p => p.tabIndex === 0).length")
    checks.true(stops == 1, "a chart is one stop of the Tab key", stops)
    page.run(f"{chart}.querySelector('.tools button:last-child').focus()")
    page.press("Tab")
    here = "document.activeElement.getAttribute('aria-label') || ''"
    checks.true(points[0]["case"] in page.run(here), "Tab reaches the first point", page.run(here))
    tip = page.run("document.querySelector('#tip').hidden ? '' : document.querySelector('#tip').innerText")
    checks.true(points[0]["case"] in tip and "status: ok" in tip, "the focus shows what it says", tip)
    page.press("ArrowRight", "ArrowRight")
    checks.true(points[2]["case"] in page.run(here), "arrows move along the curve", page.run(here))
    page.press("ArrowDown")
    checks.true(points[8]["case"] in page.run(here), "and to the other solver", page.run(here))
    page.press("Enter")
    dialog = page.run("document.querySelector('dialog').open && document.querySelector('dialog').innerText") or ""
    one = next(c for c in model["cases"] if c["key"] == points[8]["case"])
    checks.empty([w for w in (one["command"], "substeps", "python3 a.py, b=1", "exploded" if one["status"] != "ok" else "ok", "81 vertices", "RMS stretch", "No film") if w not in dialog],
                 "Enter opens the case: settings, values, status, film, command")
    checks.true(page.run("state.get('case')") == one["key"], "the case has a permalink")
    page.press("Escape")
    checks.true(page.run("!document.querySelector('dialog').open && !state.get('case')"), "Escape closes it")
    checks.true(one["key"] in page.run(here), "and the focus is where it was", page.run(here))
    before = page.run(f"{chart}.querySelectorAll('.axis.y text').length && {chart}.querySelector('.axis.y').textContent")
    page.run(f"{chart}.querySelector('.tools button:last-child').click()")
    page.settle()
    checks.true(page.run(f"{chart}.querySelector('.axis.y').textContent") != before, "the vertical scale can be switched")
    low = "Math.min(...[...document.querySelectorAll('#chart-hang-convergence .axis.x text')].map(t => Number(t.textContent)))"
    full = page.run(f"{chart}.querySelectorAll('.point').length")
    page.run(f"{chart}.querySelector('.tools button').click()")
    page.run("new Promise(done => setTimeout(done, 350))")
    checks.true(page.run(f"{chart}.querySelectorAll('.point').length") < full, "a chart can be enlarged", page.run(low))
    page.run(f"{chart}.querySelectorAll('.tools button')[2].click()")
    page.run("new Promise(done => setTimeout(done, 350))")
    checks.true(page.run(f"{chart}.querySelectorAll('.point').length") == full, "and shown whole again")
    many = page.run("[2, 8, 14, 40].map(n => ticksOf(scaleOf('log', [10 ** -n, 1], [228, 10]), {scale: 1}, 'log', 5).length)")
    checks.true(all(3 <= n <= 11 for n in many), "ticks have room over many powers of ten", many)
    lines = page.run("['5e-5', '0.01234', '-0.5', '123456', '3.4e-13', '0', 'NaN'].map(v => number(Number(v)))")
    checks.true(lines == ["5×10⁻⁵", "0.0123", "−0.5", "123\u202f456", "3.4×10⁻¹³", "0", "–"], "numbers read right", lines)


def maps(checks):
    """A table with a glyph in every cell; cells answer to pointer and keyboard."""
    model = sample.make()
    page = checks.open(model)
    cells = page.run("""[...document.querySelectorAll('#map-hang-map-bullet tbody tr')].map(tr => [...tr.querySelectorAll('td')].map(td => td.innerText.trim()))""")
    checks.true(all(c in "✓~×·" and c for row in cells for c in row), "every cell has a glyph", cells)
    checks.true(cells[0][2] == "×" and cells[5][3] == "×" and cells[4][3] == "×", "rows go up, columns to the right", cells)
    key = page.run("document.querySelector('#scenes .part .key').innerText")
    checks.true(all(w in key for w in ("help of ok", "help of exploded")), "the legend says what they are", key)
    page.run("document.querySelector('#map-hang-map-bullet .cell[tabindex=\"0\"]').focus()")
    first = page.run("document.activeElement.getAttribute('aria-label')")
    page.press("ArrowRight", "ArrowRight")
    label = page.run("document.activeElement.getAttribute('aria-label')")
    one = next(c for c in model["cases"] if c["scene"] == "hang" and c["solver"] == "bullet" and c["status"] == "exploded" and c["brief"] == "1 × 32")
    checks.true("status: exploded (gained energy)" in label and one["key"] in label and "16.67" in label, "arrows reach a cell, which says status and case", [first, label])
    page.press("Enter")
    checks.true(page.run("state.get('case')") == one["key"], "Enter opens its case")
    page.press("Escape")


def choices(checks):
    """A solver can be switched off everywhere; scenes are shown one at a time; an address brings all of it back."""
    model = sample.make()
    page = checks.open(model)
    count = f"{VISIBLE}('.point').filter(p => p.closest('[data-s=\"1\"]')).length"
    checks.true(page.run(count) > 10, "both solvers have points")
    page.run("[...document.querySelectorAll('.switch')][1].click()")
    page.settle()
    checks.true(page.run(count) == 0, "a solver that is switched off has none")
    checks.true(page.run(f"{VISIBLE}('#map-hang-map-bullet').length") == 0, "nor a map")
    said = page.run("document.querySelector('#cases [role=status]').innerText")
    checks.true(said.startswith("48 of 96 cases"), "nor cases in the table", said)
    page.run("[...document.querySelectorAll('.switch')].forEach(b => b.click())")
    page.settle()
    stop = page.run("[...document.querySelectorAll('.plot svg')].filter(s => s.querySelector('.point')).every(s => [...s.querySelectorAll('.point[tabindex=\"0\"]')].some(p => p.getClientRects().length))")
    checks.true(stop, "the Tab key still finds a point that is shown")
    page.run("[...document.querySelectorAll('.switch')][0].click()")
    page.settle()
    checks.true(page.run(count) > 10, "switched on again it is back")
    shown = f"{VISIBLE}('.scene').map(s => s.ariaLabel)"
    checks.true(page.run(shown) == ["Hang"], "one scene at a time", page.run(shown))
    page.run("[...document.querySelectorAll('.chips a')][1].click()")
    page.settle()
    checks.true(page.run(shown) == ["Ball"] and page.run("location.hash") == "#scene=ball", "a click shows another", page.run("location.hash"))
    page.run("history.back()")
    page.settle()
    checks.true(page.run(shown) == ["Hang"], "and back brings the first one back")
    key = next(c["key"] for c in model["cases"] if c["scene"] == "ball")
    page = checks.open(model, f"scene=ball&case={key}&off=bullet&sort=-dt&find=ball")
    checks.true(page.run(shown) == ["Ball"] and page.run("document.querySelector('dialog').open"), "an address shows its scene and its case")
    checks.true(page.run(count) == 0 and page.run("document.querySelector('#cases [role=status]').innerText").startswith("24 of 96"),
                "its solvers and its filter")
    page = checks.open(model, "scene=ball&at=cost")
    page.run("new Promise(done => setTimeout(done, 900))")
    at = page.run("document.querySelector('#cost').getBoundingClientRect().top")
    checks.true(-5 < at < 100, "the address of a section leads there", at)


def cases(checks):
    """The table sorts, filters and is taken away as it is shown."""
    model = sample.make()
    model["cases"][0].update(brief="=HYPERLINK(1)", reason="+1", values={"stretch.rms": -0.5})
    model["cases"][1]["dt"] = 5e-5
    page = checks.open(model, "find=hang&sort=stretch.rms")
    column = "caseColumns.findIndex(c => c.name === 'stretch.rms')"
    cells = page.run(f"[...document.querySelectorAll('#cases tbody tr')].map(tr => tr.children[{column}].textContent)")
    numbers = [float(c.replace("−", "-")) for c in cells if c != "–"]
    checks.true(numbers == sorted(numbers) and cells[-1] == "–" and len(numbers) == 45, "sorted by number, what has none at the end", cells)
    page.run(f"document.querySelectorAll('#cases thead button')[{column}].click()")
    page.settle()
    again = page.run(f"[...document.querySelectorAll('#cases tbody tr')].map(tr => tr.children[{column}].textContent)")
    checks.true(again[0] == max(cells[:45], key=lambda c: float(c.replace("−", "-"))) and again[-1] == "–", "a click sorts the other way", again)
    checks.true(page.run(f"document.querySelectorAll('#cases thead th')[{column}].ariaSort") == "descending", "and says so")
    said = lambda: page.run("document.querySelector('#cases [role=status]').innerText")
    for text, begin in (("dt<=5 bullet", "12 of 96"), ("exploded", "6 of 96"), ("dt<=0.05", "1 of 96"), ("dt<5e-2", "0 of 96"), ("dt<=5e-2", "1 of 96"), ("1 × 32 ball", "8 of 96")):
        page.run(f"(e => {{ e.focus(); e.value = {json.dumps(text)}; e.dispatchEvent(new Event('input')); }})(document.querySelector('[name=find]'))")
        page.settle()
        checks.true(said().startswith(begin), f"find: {text}", said())
    page.run("state.set({find: '', ended: 'exploded', in: 'ball'})")
    page.settle()
    checks.true(said().startswith("3 of 96") and "3 exploded" in said(), "statuses and scenes filter", said())
    page.run("state.set({find: 'jakobsen', ended: '', in: 'hang', sort: 'brief'})")
    page.settle()
    page.run("document.querySelector('#cases .button').addEventListener('click', e => e.preventDefault())")
    page.run("document.querySelector('#cases .button').click()")
    text = urllib.parse.unquote(page.run("document.querySelector('#cases .button').getAttribute('href')").split(",", 1)[1])
    rows = list(csv.DictReader(io.StringIO(text)))
    order = page.run("[...document.querySelectorAll('#cases tbody th')].map(th => th.textContent)")
    checks.true([r["case"] for r in rows] == order and len(rows) == 24, "the CSV holds what is shown, in its order", f"{len(rows)} {order[:3]}")
    spoiled = next(r for r in rows if r["case"] == model["cases"][0]["key"])
    checks.true(spoiled["brief"] == "'=HYPERLINK(1)" and spoiled["reason"] == "'+1", "what begins like a formula is made safe", spoiled)
    checks.true(float(spoiled["stretch.rms"]) == -0.5, "a negative number stays a number", spoiled["stretch.rms"])
    small = next(r for r in rows if r["case"] == model["cases"][1]["key"])
    checks.true(float(small["dt"]) == 5e-5, "a small number is read right", small["dt"])


def hostile(checks):
    """Texts of users stay texts and do not break the layout."""
    page = checks.open(sample.hostile())
    checks.true(page.run("window.harmed === undefined && !document.querySelector('main img[onerror]')"), "markup in a name stays text")
    text = page.run("document.querySelector('main').textContent")
    checks.empty([t for t in sample.HOSTILE if t[:200] not in text], "every text is shown as it is")
    for width in (1280, 390):
        page.size(width, 900)
        page.settle()
        wide = page.run("document.documentElement.scrollWidth")
        checks.true(wide <= width, f"hostile texts, {width} px: no sideways scrolling", wide)
        checks.empty(page.run(accessibility.CROWDED), f"hostile texts, {width} px: charts stay readable")
    page.size(1280, 900)
    page.settle()
    checks.true(page.run("document.documentElement.scrollHeight") < 9000, "hostile texts do not make the page long", page.run("document.documentElement.scrollHeight"))
    page.run(f"state.set({{case: {json.dumps(sample.make()['cases'][3]['key'])}}})")
    page.settle()
    checks.true(page.run("document.querySelector('dialog').scrollWidth <= document.querySelector('dialog').clientWidth"), "nor a case wide")
    checks.quiet("hostile texts")


def without_script(checks):
    """Without JavaScript the page says what is missing."""
    page = checks.browser
    page.call("Emulation.setScriptExecutionDisabled", value=True)
    file = os.path.join(checks.out, "page.html")
    with open(file, "w", encoding="utf-8") as write:
        write.write(assemble.assemble(sample.make(), checks.change))
    page.open(file)
    tree = page.call("Accessibility.getFullAXTree")["nodes"]
    page.call("Emulation.setScriptExecutionDisabled", value=False)
    text = " ".join(n.get("name", {}).get("value", "") for n in tree if n.get("role", {}).get("value") in ("StaticText", "heading"))
    heads = [c for c in sample.make()["claims"] if c["kind"] == "headline"]
    lacking = [c["sentence"] for c in heads if f"{c['sentence']} ({c['sure']})" not in text]
    checks.empty(lacking or [] if heads else ["the sample has no headline"], "without JavaScript the headlines are there")
    checks.true("JavaScript is off" in text and "Which solver stretches less?" in text and "taut report --json" in text, "without JavaScript it says what is missing", text[:300])


ALL = {f.__name__: f for f in (sections, claims, charts, maps, choices, cases, hostile, without_script)} | report.ALL


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(report.use(None, sys.argv[1], ALL, sys.argv[2:]))
