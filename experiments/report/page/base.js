'use strict';
// Basics that all other files of the page use: elements and numbers, the model and its entries by
// id, and the reader's choices. Choices are kept in the address, so that every view has a
// permalink. Whatever comes from the model becomes a text node or an attribute, never markup.

/** Text of any length; a very long one scrolls in a box of its own. */
function boxed(child) {
  if (typeof child !== 'string' || child.length < 500) return child;
  const box = document.createElement('span');
  Object.assign(box, {className: 'long', tabIndex: 0, textContent: child});
  return box;
}

/**
 * Makes an element. `props` are properties (`className`, `onclick`) or else attributes; children
 * are elements or texts.
 */
function el(name, props = {}, ...children) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(props)) {
    if (value === undefined || value === null || value === false) continue;
    if (key in node)
      node[key] = value;
    else
      node.setAttribute(key, value === true ? '' : value);
  }
  node.append(...children.flat(Infinity).filter((child) => child || child === 0).map(boxed));
  return node;
}

const note = (...content) => el('p', {className: 'note'}, content);
const item = (...content) => el('li', {}, content);
const folded = (title, ...content) =>
    el('details', {className: 'card'}, el('summary', {}, title), content);
/** A row of a table: its head and its cells. */
const row = (head, ...cells) =>
    el('tr', {}, el('th', {scope: 'row'}, head), cells.map((cell) => el('td', {}, cell)));

/** A table that scrolls within its box if it is too wide. */
const scrolling = (title, heads, rows) =>
    el('div', {className: 'scroll', tabIndex: 0, role: 'region', 'aria-label': short(title, 100)},
       el('table', {}, el('caption', {className: 'hidden'}, short(title, 120)),
          el('thead', {}, heads), el('tbody', {}, rows)));
const tableOf = (title, columns, rows) =>
    scrolling(title, el('tr', {}, columns.map((text) => el('th', {scope: 'col'}, text))), rows);

/** A list of names and values. */
const factList = (facts) => facts?.length ?
    el('dl', {className: 'facts'},
       facts.map(({name, value}) => [el('dt', {}, name), el('dd', {}, value)])) :
    null;

/** A text shortened to fit a heading or a chip. */
function short(text, length = 60) {
  const letters = [...String(text)];
  return letters.length > length ? letters.slice(0, length - 1).join('') + '…' : String(text);
}

/** Text of a number: "0.0123" for 0.012345, "5×10⁻⁵" for 5e-5, "–" for no value. */
function number(value, digits = 3) {
  if (typeof value !== 'number' || !Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e-4 && size < 1e6)
    return String(size >= 10 ** digits ? Math.round(value) : Number(value.toPrecision(digits)))
        .replace('-', '−')
        .replace(/\B(?=(\d{3})+$)/g, size >= 1e4 ? '\u202F' : '');
  const [mantissa, exponent] = value.toExponential(digits - 1).split('e');
  const raised = (c) => c === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[c];
  const power = String(Number(exponent)).replace(/./g, raised);
  const factor = String(Number(mantissa)).replace('-', '−');
  return factor === '1' ? '10' + power : factor + '×10' + power;
}

/** Entry of a metric in the glossary; an unknown metric is shown in SI under its own name. */
const metric = (name) => Object.hasOwn(model.metrics, name) ?
    model.metrics[name] :
    {title: name, help: '', unit: '', scale: 1, axis: 'linear', window: ''};

/** An SI value in the unit of `quantity` (a metric, or an axis of a chart). */
function shown(value, quantity, digits) {
  const text = number(value === null || value === undefined ? NaN : value * quantity.scale, digits);
  return text === '–' || !quantity.unit ? text : text + '\u00A0' + quantity.unit;
}

/** A 95 % interval: "0.31–0.35 %"; "" without an end. */
function interval(low, high, quantity) {
  if (typeof low !== 'number' || typeof high !== 'number') return '';
  return number(low * quantity.scale) + '–' + shown(high, quantity);
}

const titled = (quantity) => quantity.title + (quantity.unit ? ` [${quantity.unit}]` : '');
const count = (n, one, many = one + 's') => `${n} ${n === 1 ? one : many}`;

/** A field of a CSV file. A text that a spreadsheet would take for a formula gets an apostrophe. */
function csvField(value) {
  if (value === null || value === undefined) return '';
  if (typeof value === 'number') return Number.isFinite(value) ? String(value) : '';
  const text = /^[=+\-@\t\r]/.test(value) ? '\'' + value : String(value);
  return /[",\r\n]/.test(text) ? '"' + text.replaceAll('"', '""') + '"' : text;
}

/** Text of a CSV file. `lines` are lists of fields. */
const csvText = (lines) => lines.map((fields) => fields.join(',') + '\r\n').join('');

/**
 * A button that copies a text to the clipboard; if that is refused, it shows the text to be copied
 * by hand.
 */
function copyButton(text) {
  const button = el('button', {type: 'button', className: 'copy'}, 'copy');
  button.onclick = async () => {
    try {
      await navigator.clipboard.writeText(text());
      button.textContent = 'copied';
    } catch {
      const area = el('textarea', {value: text(), 'aria-label': 'text to copy'});
      button.after(area);
      area.select();
      button.textContent = document.execCommand('copy') ? 'copied' : 'press Ctrl+C';
      if (button.textContent === 'copied') area.remove();
    }
    setTimeout(() => {
      button.textContent = 'copy';
    }, 2500);
  };
  return button;
}

function command(text) {
  const code = el('code', {}, text);
  return el('div', {className: 'command'}, el('pre', {tabIndex: 0}, code), copyButton(() => text));
}

const model = JSON.parse(document.getElementById('model').textContent);

const index = (list, key = 'id') => new Map((list ?? []).map((entry) => [entry[key], entry]));
const cases = index(model.cases, 'key'), charts = index(model.charts), maps = index(model.maps),
      films = index(model.films);
const scenes = index(model.scenes), statuses = index(model.statuses);
const solvers = new Map(model.solvers.map((solver, order) => [solver.id, {...solver, order}]));

const solverOf = (id) => solvers.get(id) ?? {id, title: id, order: 0, marker: 'circle', dash: ''};
const statusOf = (id) => statuses.get(id) ?? {id, title: id, glyph: '?', help: '', failed: true};
const all = (ids, from) => (ids ?? []).map((id) => from.get(id)).filter(Boolean);
/** Figures of a part of the page. */
const figuresOf = (part) => (model.figures ?? []).filter(({of}) => of === part);

/** The reader's choices, by their keys in the address. */
const state = {
  watchers: [],
  params() { return new URLSearchParams(location.hash.slice(1)); },
  get(key) { return state.params().get(key) ?? ''; },
  /** The requested section: `at=cost`, or an address that ends in `#cost`. */
  section() {
    const bare = [...state.params()].find(([, value]) => !value);
    return state.get('at') || bare?.[0] || '';
  },
  /**
   * Changes some choices ("" takes one back); `step` makes it one that the browser's "back" undoes.
   */
  set(changes, step = true) {
    const next = state.params();
    for (const [key, value] of [...next])
      if (!value) next.delete(key);
    for (const [key, value] of Object.entries(changes)) {
      next.delete(key);
      for (const one of [value].flat())
        if (one) next.append(key, one);
    }
    history[step ? 'pushState' : 'replaceState'](null, '', '#' + next);
    state.tell();
  },
  watch(watcher) { state.watchers.push(watcher); },
  tell() {
    for (const watcher of state.watchers) watcher();
  },
};
addEventListener('popstate', () => state.tell());

/** A link that is a permalink, but keeps all other choices when clicked. */
function choice(changes, props, ...children) {
  return el(
      'a', {
        ...props,
        href: '#' + new URLSearchParams(changes),
        onclick: (event) => {
          if (event.ctrlKey || event.metaKey || event.shiftKey) return;
          event.preventDefault();
          state.set(changes);
        }
      },
      ...children);
}

const isOff = (solver) => state.params().getAll('off').includes(solver);

/**
 * Sets the colours of solvers and statuses as custom properties, and the rules that hide solvers
 * that are switched off.
 */
function paint() {
  const sheet = document.styleSheets[0];
  const safe = (colour) => /^#[0-9a-f]{6}$/i.test(colour ?? '') ? colour : '#777777';
  const variables = (theme) =>
      [...[...solvers.values()].map((s) => `--s${s.order}:${safe(s.colour?.[theme])}`),
       ...model.statuses.flatMap(
           (s, i) => [`--c${i}:${safe(s.colour?.[theme])}`, `--i${i}:${safe(s.ink?.[theme])}`])];
  sheet.insertRule(`:root{${variables('light').join(';')}}`, sheet.cssRules.length);
  sheet.insertRule(
      `@media (prefers-color-scheme:dark){:root{${variables('dark').join(';')}}}`,
      sheet.cssRules.length);
  for (const {order} of solvers.values())
    sheet.insertRule(`.off-${order} [data-s="${order}"]{display:none}`, sheet.cssRules.length);
  state.watch(() => {
    for (const {id, order} of solvers.values())
      document.body.classList.toggle('off-' + order, isOff(id));
  });
}
const solverColour = (id) => `var(--s${solverOf(id).order})`;
const statusIndex = (id) => model.statuses.findIndex((status) => status.id === id);
