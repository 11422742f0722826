#!/usr/bin/env python3
"""Opens a report in headless Chromium and uses it: no request leaves, no error is logged, the theme
switches, every chart has its numbers, texts have contrast, the slider moves the videos, everything fits
and can be read on a desk, a tablet, a phone and paper. Pictures for a human look go to OUT.

    report.py REPORT.html OUT        exit 0: all is well; 1: it is not; 77: there is no Chromium
"""

import os
import subprocess
import sys

import chromium

# Texts whose contrast with the background behind them is below WCAG AA, as "text: ratio".
CONTRAST = r"""
(() => {
  const parse = c => { const m = c.match(/[\d.]+/g).map(Number); return m.length < 4 ? [...m, 1] : m; };
  const light = c => c.slice(0, 3).map(v => v / 255)
      .map(v => v <= .04045 ? v / 12.92 : ((v + .055) / 1.055) ** 2.4)
      .reduce((s, v, i) => s + v * [.2126, .7152, .0722][i], 0);
  const behind = e => {
    for (; e; e = e.parentElement) {
      const c = parse(getComputedStyle(e).backgroundColor);
      if (c[3] > .99) return c;
    }
    return [255, 255, 255];
  };
  const bad = new Set();
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walk.nextNode()) {
    const text = walk.currentNode.textContent.trim(), e = walk.currentNode.parentElement;
    if (!text || !e.checkVisibility() || e.closest('script, style, .sr, .skip, title, desc')) continue;
    const style = getComputedStyle(e), svg = e.closest('svg.chart');
    if (svg && !e.closest('text')) continue;
    const [a, b] = [light(parse(svg ? style.fill : style.color)), light(behind(svg ? svg.parentElement : e))];
    const ratio = (Math.max(a, b) + .05) / (Math.min(a, b) + .05);
    // Glyphs lie on cells, not on the page: their colours are tested with the palette.
    if (svg && /^[×~–TM!E]$/.test(text)) continue;
    const large = parseFloat(style.fontSize) >= 24 ||
                  (parseFloat(style.fontSize) >= 18.6 && style.fontWeight >= 600);
    if (ratio < (large ? 3 : 4.5)) bad.add(text.slice(0, 40) + ': ' + ratio.toFixed(2));
  }
  return [...bad];
})()
"""

BARE_CHARTS = """
[...document.querySelectorAll('svg.chart')].filter(svg => {
  const box = svg.closest('figure, .timeline');
  return !svg.querySelector('title')?.textContent || !svg.querySelector('desc')?.textContent ||
         !box || !box.querySelector('details table tbody tr') || svg.querySelectorAll('path').length < 2;
}).map(svg => svg.querySelector('title')?.textContent || '?')
"""

REPEATED_IDS = """
[...document.querySelectorAll('[id]')].map(e => e.id).filter((id, i, all) => all.indexOf(id) !== i)
"""

# Texts of a chart that its viewBox cuts off.
CUT_TEXTS = """
[...document.querySelectorAll('svg.chart')].flatMap(svg => {
  const box = svg.getBoundingClientRect();
  return box.width === 0 ? [] : [...svg.querySelectorAll('text')].filter(text => {
    const t = text.getBoundingClientRect();
    return t.left < box.left - 1 || t.right > box.right + 1 || t.top < box.top - 1 || t.bottom > box.bottom + 1;
  }).map(text => text.textContent.trim() + ' in ' + svg.querySelector('title').textContent);
})
"""

# Texts of one chart that lie on each other or on a marker: the boxes of their letters, turned as they are, share
# an area.
OVERLAPS = r"""
[...document.querySelectorAll('svg.chart')].filter(svg => svg.checkVisibility()).flatMap(svg => {
  const box = (e, text, from, to) => {
    const b = e.getBBox(), m = e.getScreenCTM(), [top, bottom] = [b.y + b.height * from, b.y + b.height * to];
    const corners = [[b.x, top], [b.x + b.width, top], [b.x + b.width, bottom], [b.x, bottom]]
        .map(([x, y]) => [m.a * x + m.c * y + m.e, m.b * x + m.d * y + m.f]);
    return {text, corners};
  };
  // A line of text is higher than its letters: a sixth above them and a tenth below.
  const texts = [...svg.querySelectorAll('text')].filter(text => text.textContent.trim())
      .map(text => box(text, text.textContent.trim(), 1 / 6, .9));
  const marks = [...svg.querySelectorAll('use')].map(mark => box(mark, 'a marker', 0, 1));
  const separated = (a, b) => [[0, 1], [1, 2]].some(([i, j]) => {
    const [dx, dy] = [a[j][0] - a[i][0], a[j][1] - a[i][1]], length = Math.hypot(dx, dy) || 1;
    const along = p => (p[0] * dx + p[1] * dy) / length;
    const [u, v] = [a.map(along), b.map(along)];
    return Math.max(...u) <= Math.min(...v) + .3 || Math.max(...v) <= Math.min(...u) + .3;
  });
  const meets = (a, b) => !separated(a.corners, b.corners) && !separated(b.corners, a.corners);
  return texts.flatMap((a, i) => [...texts.slice(i + 1), ...marks].filter(b => meets(a, b))
      .map(b => '"' + a.text + '" on "' + b.text + '" in ' + svg.querySelector('title').textContent));
})
"""

# Charts that leave the window or whose text is shrunk: drawn at less than SCALE of their own size.
HARD_TO_READ = """
[...document.querySelectorAll('svg.chart')].filter(svg => svg.checkVisibility()).flatMap(svg => {
  const box = svg.getBoundingClientRect(), scale = box.width / svg.viewBox.baseVal.width;
  return scale >= SCALE && box.left >= 0 && box.right <= innerWidth
      ? [] : [scale.toFixed(2) + ' to ' + box.right + ' px: ' + svg.querySelector('title').textContent];
})
"""

# Charts that are shown twice, or not at all.
SHOWN_ONCE = """
[...document.querySelectorAll('figure, .timeline')].filter(box => box.querySelector('svg.chart') &&
    [...box.querySelectorAll('svg.chart')].filter(svg => svg.checkVisibility()).length !== 1)
    .map(box => box.querySelector('svg.chart title').textContent)
"""

# Charts that do not fill the box in which their playhead moves.
ASTRAY = """
[...document.querySelectorAll('.plot')].filter(plot => plot.checkVisibility()).filter(plot => {
  const a = plot.getBoundingClientRect(), b = plot.querySelector('svg').getBoundingClientRect();
  return Math.abs(a.left - b.left) > 1 || Math.abs(a.right - b.right) > 1;
}).map(plot => plot.querySelector('title').textContent)
"""

# Pictures of films narrower than a stamp, and films that leave the cell beside them empty.
LOST_FILMS = """
[...document.querySelectorAll('.clip')].filter(clip => clip.getBoundingClientRect().width < 90)
    .map(clip => 'squeezed: ' + clip.innerText)
    .concat([...document.querySelectorAll('.films')].filter(films =>
        Math.abs(films.lastElementChild.getBoundingClientRect().right - films.getBoundingClientRect().right) > 1)
    .map(films => 'an empty cell after ' + films.lastElementChild.id))
"""

SCRUB = """
(async () => {
  const box = document.querySelectorAll('.player')[PLAYER];
  const videos = [...box.querySelectorAll('video')];
  box.scrollIntoView();  // what is far off is not loaded
  await Promise.all(videos.map(v => v.readyState > 1 || new Promise(r => v.addEventListener('canplay', r))));
  const scrub = box.querySelector('.scrub');
  const head = [...box.querySelectorAll('.playhead')].find(e => e.checkVisibility());
  const play = box.querySelector('.play');
  play.textContent.startsWith('pause') && play.click();
  const at = async share => {
    scrub.value = Number(scrub.min) + share * (scrub.max - scrub.min);
    scrub.dispatchEvent(new Event('input'));
    await Promise.all(videos.map(v => !v.seeking || new Promise(r => v.addEventListener('seeked', r))));
    return [head.getBoundingClientRect().left, ...videos.map(v => v.currentTime)];
  };
  return [await at(.2), await at(.8)];
})()
"""


# The serious rules of axe-core that apply to such a page, written out: axe-core is no package of Debian 12.
# What each element breaks, as "rule: element".
ACCESSIBILITY = r"""
(() => {
  const found = [];
  const all = selector => [...document.querySelectorAll(selector)];
  const say = (rule, e) => found.push(rule + ': ' + (e ? e.outerHTML.slice(0, 90) : 'page'));
  const refers = (e, attribute) => (e.getAttribute(attribute) || '').split(/\s+/).filter(Boolean);
  const named = e => (e.getAttribute('aria-label') || '').trim() ||
      refers(e, 'aria-labelledby').some(id => document.getElementById(id)?.textContent.trim()) ||
      (e.labels && e.labels.length) || (e.innerText || e.textContent || '').trim();
  const hidden = e => !e.checkVisibility() || e.closest('[aria-hidden=true]');
  if (!document.documentElement.lang) say('html-has-lang');
  if (!document.title.trim()) say('document-title');
  if (all('main').length !== 1) say('landmark-one-main');
  if (all('h1').length !== 1) say('page-has-heading-one');
  if (/user-scalable=no|maximum-scale=1/.test(document.querySelector('meta[name=viewport]').content)) say('meta-viewport');
  let level = 0;
  for (const h of all('h1,h2,h3,h4,h5,h6')) {
    if (!h.textContent.trim()) say('empty-heading', h);
    if (+h.tagName[1] > level + 1) say('heading-order', h);
    level = +h.tagName[1];
  }
  for (const e of all('img')) if (!e.hasAttribute('alt')) say('image-alt', e);
  for (const e of all('video, [role=img], [role=region], [role=group], svg:not([aria-hidden])'))
    if (!named(e)) say('name of ' + e.tagName, e);
  for (const e of all('button, a[href], summary, input, select, textarea')) if (!hidden(e) && !named(e)) say('name of control', e);
  for (const e of all('button[aria-label], a[aria-label], input[aria-label]')) {
    const seen = (e.innerText || '').trim().toLowerCase();
    if (/[a-z]{2}/.test(seen) && !e.getAttribute('aria-label').toLowerCase().includes(seen)) say('label-content-name-mismatch', e);
  }
  for (const e of all('a')) if (!e.hasAttribute('href')) say('link without target', e);
  for (const e of all('a[href^="#"]')) if (e.hash && !document.querySelector(e.hash)) say('link to nowhere', e);
  for (const e of all('[tabindex]')) if (e.tabIndex > 0) say('tabindex', e);
  for (const e of all('[aria-labelledby], [aria-describedby], [aria-controls]'))
    for (const a of ['aria-labelledby', 'aria-describedby', 'aria-controls'])
      for (const id of refers(e, a)) if (!document.getElementById(id)) say(a, e);
  const roles = new Set(['img', 'region', 'group', 'presentation', 'note']);
  for (const e of all('[role]')) if (!roles.has(e.getAttribute('role'))) say('role', e);
  for (const e of all('[aria-hidden=true]'))
    if (e.querySelector('a[href], button, input, [tabindex]')) say('aria-hidden-focus', e);
  for (const e of all('button, a[href], summary')) if (e.querySelector('a, button, input, [tabindex]')) say('nested-interactive', e);
  for (const e of all('table')) {
    if (!e.caption && !named(e)) say('table-caption', e);
    if (!e.querySelector('th')) say('table-headers', e);
  }
  for (const e of all('th')) if (!['col', 'row', 'colgroup', 'rowgroup'].includes(e.scope)) say('scope', e);
  for (const e of all('li')) if (!e.parentElement.matches('ul, ol')) say('listitem', e);
  for (const e of all('ul, ol')) for (const c of e.children) if (c.tagName !== 'LI') say('list', c);
  for (const e of all('dt, dd')) if (!e.parentElement.matches('dl')) say('dlitem', e);
  for (const e of all('*'))
    if (e.checkVisibility() && e.scrollWidth > e.clientWidth + 1 && /auto|scroll/.test(getComputedStyle(e).overflowX) &&
        e.tabIndex < 0 && !e.querySelector('a[href], button, [tabindex]')) say('scrollable-region-focusable', e);
  for (const e of all('video[autoplay]')) if (!e.muted) say('no-autoplay-audio', e);
  return found;
})()
"""

# The first player after a fresh start under reduced motion: whether it stands, and the simulated times of
# its poster, its film, its clock and its playhead, which is read from its place between the ends of the chart.
STATE = """(box => {
  const v = box.querySelector('video'), line = box.querySelector('.timeline').dataset;
  const plot = [...box.querySelectorAll('.plot')].find(e => e.checkVisibility());
  const head = parseFloat(plot.querySelector('.playhead').style.left) / 100;
  return [v.paused, Number(v.dataset.poster), v.currentTime * v.dataset.speed, parseFloat(box.querySelector('.clock').textContent),
          Number(line.low) + (head - plot.dataset.left) / (plot.dataset.right - plot.dataset.left) * (line.high - line.low),
          Number(v.dataset.frame)];
})(document.querySelector('.player'))"""
# Films far below the window: how many there are, and how many are loaded already.
FAR = """(far => [far.length, far.filter(v => v.src).length])([...document.querySelectorAll('video')]
    .filter(v => v.getBoundingClientRect().top > innerHeight + 1500))"""
READY = """new Promise(done => { const v = document.querySelector('.player video');
    v.readyState > 1 ? done(1) : v.addEventListener('canplay', () => done(1)); })"""


class Checks:
    def __init__(self):
        self.failures = []

    def empty(self, found, what):
        print(("ok      " if not found else "FAILED  ") + what)
        if found:
            self.failures.append(what)
            for line in found[:12]:
                print("        " + str(line))

    def true(self, holds, what, detail=""):
        self.empty([] if holds else [detail or "does not hold"], what)


def logged(events):
    requests, errors = [], []
    for event in events:
        kind, params = event.get("method"), event.get("params", {})
        if kind == "Network.requestWillBeSent":
            url = params["request"]["url"]
            if not url.startswith(("data:", "blob:")) and params.get("type") != "Document":
                requests.append(url)
        elif kind == "Runtime.exceptionThrown":
            errors.append(params["exceptionDetails"].get("text"))
        elif kind == "Runtime.consoleAPICalled" and params["type"] in ("error", "warning", "assert"):
            errors.append(str(params["args"])[:300])
        elif kind == "Log.entryAdded" and params["entry"]["level"] in ("error", "warning"):
            errors.append(params["entry"]["text"][:300])
    return requests, errors


def axe_core():
    """The text of axe.min.js if the machine has it ($AXE_CORE, or installed for npm), else None."""
    places = [os.environ.get("AXE_CORE", "")]
    try:
        root = subprocess.run(["npm", "root", "-g"], capture_output=True, text=True, timeout=20).stdout
        places.append(os.path.join(root.strip(), "axe-core", "axe.min.js"))
    except (OSError, subprocess.SubprocessError):
        pass
    for place in places:
        if place and os.path.isfile(place):
            with open(place, encoding="utf-8") as file:
                return file.read()
    return None


def check_theme(page, checks, out):
    colour = "getComputedStyle(document.body).backgroundColor"
    first = page.run(colour)
    for theme in ("first", "switched"):
        checks.empty(page.run(CONTRAST), f"texts have contrast, theme {theme}")
        page.screenshot(os.path.join(out, f"desktop-{theme}.png"))
        page.run("document.getElementById('theme').click()")
        if theme == "first":
            checks.true(page.run(colour) != first, "the button switches the theme")
    checks.true(page.run(colour) == first, "pressed again it switches back")


def check_media(page, checks):
    if not page.run("document.querySelectorAll('.stage video').length"):
        print("skipped the slider: this report has no video")
        return
    stuck, apart = [], []
    for player in range(page.run("document.querySelectorAll('.player').length")):
        if not page.run(f"document.querySelectorAll('.player')[{player}].querySelectorAll('video').length"):
            continue
        early, late = page.run(SCRUB.replace("PLAYER", str(player)))
        if late[0] < early[0] + 50 or not all(b > a for a, b in zip(early[1:], late[1:])):
            stuck.append(f"player {player}: {early} {late}")
        if max(late[1:]) - min(late[1:]) > 0.05:
            apart.append(f"player {player}: {late}")
    checks.empty(stuck, "each slider moves its playhead and its videos")
    checks.empty(apart, "the videos of a scene stay together")


def check_keys(page, checks, report):
    """Reduced motion: nothing plays by itself, and poster, film, clock and playhead agree. The arrow steps a
    frame, the space bar plays and stops."""
    if not page.run("document.querySelectorAll('.stage video').length"):
        return
    page.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": "reduce"}])
    page.open(report)
    page.run(READY)
    start = page.run(STATE)
    checks.true(start[0], "reduced motion: nothing plays by itself", f"{start}")
    checks.true(max(start[1:5]) - min(start[1:5]) < max(0.011, start[5] / 4),
                "poster, film, clock and playhead show the same moment", f"{start}")
    far, loaded = page.run(FAR)
    checks.true(loaded == 0, "films far below are not loaded", f"{loaded} of {far}")

    def press(key, code):
        for kind in ("keyDown", "keyUp"):
            page.call("Input.dispatchKeyEvent", type=kind, key=key, code=code)
    press("ArrowRight", "ArrowRight")
    after = page.run(STATE)
    stepped = (after[2] - start[2]) / start[5]
    checks.true(after[0] and 0.9 < stepped < 1.1, "the right arrow steps one frame", f"{start} {after}")
    press(" ", "Space")
    checks.true(not page.run(STATE)[0], "the space bar plays")
    press(" ", "Space")
    checks.true(page.run(STATE)[0], "and stops")
    page.call("Emulation.setEmulatedMedia", features=[])


def check_fit(page, checks, medium, width, scale):
    """On paper, a phone and a desk: charts fit and can be read, films have room."""
    page.call("Emulation.setEmulatedMedia", media="print" if medium == "print" else "")
    page.size(width, 900)
    checks.true(page.run("document.documentElement.scrollWidth") <= width, f"{medium}: no sideways scrolling",
                page.run("document.documentElement.scrollWidth"))
    checks.empty(page.run(CUT_TEXTS), f"{medium}: no text of a chart is cut off")
    checks.empty(page.run(OVERLAPS), f"{medium}: no text of a chart lies on another or on a marker")
    checks.empty(page.run(HARD_TO_READ.replace("SCALE", str(scale))), f"{medium}: every chart fits and can be read")
    checks.empty(page.run(SHOWN_ONCE), f"{medium}: every chart is shown once")
    checks.empty(page.run(ASTRAY), f"{medium}: playheads move over their charts")
    checks.empty(page.run(LOST_FILMS), f"{medium}: every film has room, and no cell is empty")
    page.call("Emulation.setEmulatedMedia", media="")


def check_axe(page, checks):
    script = axe_core()
    if script is None:
        print("axe-core itself: not on this machine (npm install -g axe-core, or set AXE_CORE)")
        return
    page.run(script + ";0")
    found = page.run("""axe.run(document, {resultTypes: ['violations']}).then(r => r.violations
        .filter(v => v.impact === 'serious' || v.impact === 'critical')
        .map(v => v.id + ' x' + v.nodes.length + ': ' + v.nodes[0].target))""")
    checks.empty(found, "axe-core finds no serious violation")


def main(report, out):
    program = chromium.find()
    if program is None:
        print("SKIPPED: no chromium on this machine")
        return 77
    os.makedirs(out, exist_ok=True)
    checks, page = Checks(), chromium.Browser(program)
    try:
        page.size(1280, 900)
        page.open(report)
        checks.true(page.run("document.querySelectorAll('svg.chart').length") > 0, "there are charts")
        checks.empty(page.run(BARE_CHARTS), "every chart has title, description and a data table")
        checks.empty(page.run(REPEATED_IDS), "no id is used twice")
        for medium, width, scale in (("print", 688, 0.8), ("tablet", 768, 0.9), ("phone", 390, 0.9),
                                     ("desktop", 1280, 0.9)):
            check_fit(page, checks, medium, width, scale)
        check_theme(page, checks, out)
        checks.empty(page.run(ACCESSIBILITY), "accessibility: the serious rules, written out")
        check_media(page, checks)
        check_axe(page, checks)
        check_keys(page, checks, report)
        page.size(390, 844)
        page.screenshot(os.path.join(out, "phone.png"))
        page.pdf(os.path.join(out, "print.pdf"))
        requests, errors = logged(page.events)
        checks.empty(requests, "no request leaves the page")
        checks.empty(errors, "nothing is logged as error or warning")
    finally:
        page.close()
    print(f"{len(checks.failures)} failures; pictures in {out}")
    return 1 if checks.failures else 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2]))
