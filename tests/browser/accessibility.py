"""Rules of accessibility: the serious rules of axe-core, written out because Debian 12 does not package axe-core; contrast; and
texts that overlap or are cut off. Each script returns a list of violations."""

import os
import subprocess

# Texts whose contrast with their background is below WCAG AA, as "text: ratio".
CONTRAST = r"""
(() => {
  const parse = c => {
    const m = c.match(/[\d.]+/g).map(Number), of = c.startsWith('color(srgb') ? 255 : 1;  // a mixture
    return [...m.slice(0, 3).map(v => of * v), m[3] ?? 1];
  };
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
    if (!text || !e.checkVisibility({visibilityProperty: true}) || e.closest('script, style, .hidden, .skip')) continue;
    const style = getComputedStyle(e), svg = e.closest('svg');
    const [a, b] = [light(parse(svg ? style.fill : style.color)), light(behind(svg ? svg.parentElement : e))];
    const ratio = (Math.max(a, b) + .05) / (Math.min(a, b) + .05);
    const large = parseFloat(style.fontSize) >= 24 || (parseFloat(style.fontSize) >= 18.6 && style.fontWeight >= 600);
    const glyph = e.closest('.cell, .glyph-box');  // a picture of one character beside its name
    if (ratio < (large || glyph ? 3 : 4.5)) bad.add(text.slice(0, 40) + ': ' + ratio.toFixed(2));
  }
  return [...bad];
})()
"""

RULES = r"""
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
  let level = 0;
  for (const h of all('main :is(h1,h2,h3,h4,h5,h6)')) {
    if (!h.textContent.trim()) say('empty-heading', h);
    if (+h.tagName[1] > level + 1) say('heading-order', h);
    level = +h.tagName[1];
  }
  const ids = all('[id]').map(e => e.id);
  ids.filter((id, i) => ids.indexOf(id) !== i).forEach(id => say('duplicate-id ' + id));
  for (const e of all('img')) if (!e.hasAttribute('alt')) say('image-alt', e);
  for (const e of all('video, [role=img], [role=region], [role=group], svg:not([aria-hidden])'))
    if (!named(e)) say('name of ' + e.tagName, e);
  for (const e of all('button, a[href], summary, input, select, [role=button]')) if (!hidden(e) && !named(e)) say('name of control', e);
  for (const e of all('button[aria-label], a[aria-label], input[aria-label]')) {
    const seen = (e.innerText || '').trim().toLowerCase();
    if (/[a-z]{2}/.test(seen) && !e.getAttribute('aria-label').toLowerCase().includes(seen)) say('label-content-name-mismatch', e);
  }
  for (const e of all('a')) if (!e.hasAttribute('href')) say('link without target', e);
  for (const e of all('[tabindex]')) if (e.tabIndex > 0) say('tabindex', e);
  for (const e of all('[aria-labelledby], [aria-describedby]'))
    for (const a of ['aria-labelledby', 'aria-describedby'])
      for (const id of refers(e, a)) if (!document.getElementById(id)) say(a, e);
  const roles = new Set(['img', 'region', 'group', 'button', 'status', 'tooltip']);
  for (const e of all('[role]')) if (!roles.has(e.getAttribute('role'))) say('role', e);
  for (const e of all('[aria-hidden=true]')) if (e.querySelector('a[href], button, input, [tabindex]')) say('aria-hidden-focus', e);
  for (const e of all('button, a[href], summary')) if (e.querySelector('a, button, input')) say('nested-interactive', e);
  for (const e of all('table')) {
    if (!e.caption && !named(e)) say('table-caption', e);
    if (!e.querySelector('th')) say('table-headers', e);
  }
  for (const e of all('th')) if (!['col', 'row'].includes(e.scope)) say('scope', e);
  for (const e of all('ul, ol')) for (const c of e.children) if (c.tagName !== 'LI') say('list', c);
  for (const e of all('dt, dd')) if (!e.parentElement.matches('dl')) say('dlitem', e);
  for (const e of all('*'))
    if (e.checkVisibility() && e.scrollWidth > e.clientWidth + 1 && /auto|scroll/.test(getComputedStyle(e).overflowX) &&
        e.tabIndex < 0 && !e.querySelector('a[href], button, [tabindex]')) say('scrollable-region-focusable', e);
  return found;
})()
"""

# Texts of a chart that overlap or extend beyond the chart.
CROWDED = r"""
[...document.querySelectorAll('.plot svg')].filter(svg => svg.checkVisibility()).flatMap(svg => {
  const frame = svg.getBoundingClientRect(), name = svg.getAttribute('aria-label').slice(0, 60);
  const texts = [...svg.querySelectorAll('text:not(.glyph)')].filter(t => t.textContent.trim())
      .map(t => ({text: t.textContent, box: t.getBoundingClientRect()}));
  const cut = texts.filter(({box}) => box.left < frame.left - 1 || box.right > frame.right + 1 || box.top < frame.top - 1 ||
                                      box.bottom > frame.bottom + 1).map(({text}) => `"${text}" is cut in ${name}`);
  const meets = (a, b) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 2 && b.top < a.bottom - 2;
  return cut.concat(texts.flatMap((a, i) => texts.slice(i + 1).filter(b => meets(a.box, b.box))
      .map(b => `"${a.text}" on "${b.text}" in ${name}`)));
})
"""

AXE = """axe.run(document, {resultTypes: ['violations']}).then(r => r.violations
    .filter(v => v.impact === 'serious' || v.impact === 'critical')
    .map(v => v.id + ' x' + v.nodes.length + ': ' + v.nodes[0].target))"""


def axe_core():
    """The text of axe.min.js if this machine has it ($AXE_CORE, or installed by npm), otherwise None."""
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
