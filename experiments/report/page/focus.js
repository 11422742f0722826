'use strict';
// Texts of points and cells, shown at the pointer and on focus, and navigation between them with
// the arrow keys.

const tip = document.getElementById('tip');

let told = null;  // subject of the tip: {anchor, lines}

function showTip(anchor, lines) {
  told = {anchor, lines};
  tip.replaceChildren(...lines.map((line) => el('div', {}, line)));
  tip.hidden = false;
  const at = anchor.getBoundingClientRect(), size = tip.getBoundingClientRect(), gap = 8;
  const below = at.bottom + gap + size.height < innerHeight || at.top < size.height + gap;
  const left = Math.min(innerWidth - size.width - gap, at.left + at.width / 2 - size.width / 2);
  tip.style.left = Math.max(gap, left) + 'px';
  tip.style.top = (below ? at.bottom + gap : at.top - gap - size.height) + 'px';
}
const hideTip = () => {
  tip.hidden = true;
};
addEventListener('scroll', () => {
  if (!tip.hidden && document.activeElement === told.anchor)
    showTip(told.anchor, told.lines);
  else
    hideTip();
}, {passive: true, capture: true});
addEventListener('keydown', (event) => {
  if (event.key === 'Escape') hideTip();
});

/** Gives an element a text for the pointer, for focus and for screen readers. */
function describe(node, lines) {
  node.setAttribute('aria-label', lines.join('; '));
  const show = () => showTip(node, lines);
  node.addEventListener('pointerenter', show);
  node.addEventListener('focus', show);
  node.addEventListener('pointerleave', hideTip);
  node.addEventListener('blur', hideTip);
}

/** Lines about a case: how it ended, which case it is, and how to see more of it. */
function caseLines(status, reason, key) {
  const entry = statusOf(status), known = cases.get(key), why = reason ?? known?.reason;
  return [
    `status: ${entry.title}${why ? ` (${short(why, 120)})` : ''}`,
    ...(known ?
            [`case ${key}: ${short(known.id, 160)}`, 'Enter or click: settings, values, command'] :
            [])
  ];
}

/**
 * Makes all items of a box a single stop of the Tab key. Each item has a `data-group` (a series, or
 * a row of a map). Left and right move within the group, up and down to the nearest item of the
 * previous or next group.
 */
function rove(box, selector) {
  const items =
      () => [...box.querySelectorAll(selector)].filter((item) => item.getClientRects().length);
  const at = (item) => {
    const r = item.getBoundingClientRect();
    return r.left + r.width / 2;
  };
  const stop = (item) => {
    for (const other of box.querySelectorAll(selector))
      other.setAttribute('tabindex', other === item ? 0 : -1);
  };
  const reset = () => {
    const shown = items();
    if (shown.length && !shown.some((item) => item.getAttribute('tabindex') === '0'))
      stop(shown[0]);
  };
  box.addEventListener('focusin', (event) => {
    if (event.target.matches(selector)) stop(event.target);
  });
  box.addEventListener('keydown', (event) => {
    const here = event.target.closest(selector);
    if (!here ||
        !['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', 'Home', 'End'].includes(event.key))
      return;
    event.preventDefault();
    const groups = d3.nest().key((item) => item.dataset.group).entries(items());
    const mine = groups.findIndex((group) => group.key === here.dataset.group);
    const row = (groups[mine]?.values ?? []).sort((a, b) => at(a) - at(b)),
          place = row.indexOf(here);
    const next = {
      ArrowLeft: row[place - 1],
      ArrowRight: row[place + 1],
      Home: row[0],
      End: row[row.length - 1]
    }[event.key];
    const other = groups[mine + {ArrowUp: -1, ArrowDown: 1}[event.key]];
    (next ?? (other && d3.least(other.values, (item) => Math.abs(at(item) - at(here)))))?.focus();
  });
  state.watch(reset);  // the stop may have been switched off with its solver
  return reset;
}
