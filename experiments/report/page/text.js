'use strict';
// Elements and numbers. Whatever comes from the model becomes a text node or an attribute, never markup.

/** A text of any length; a very long one scrolls in a box of its own. */
function boxed(child) {
  if (typeof child !== 'string' || child.length < 500) return child;
  const box = document.createElement('span');
  Object.assign(box, {className: 'long', tabIndex: 0, textContent: child});
  return box;
}

/** An element. `props` are properties (`className`, `onclick`), else attributes; children are elements or texts. */
function el(name, props = {}, ...children) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(props)) {
    if (value === undefined || value === null || value === false) continue;
    if (key in node) node[key] = value;
    else node.setAttribute(key, value === true ? '' : value);
  }
  node.append(...children.flat(Infinity).filter((child) => child || child === 0).map(boxed));
  return node;
}

const note = (...content) => el('p', {className: 'note'}, content);
const item = (...content) => el('li', {}, content);
const folded = (title, ...content) => el('details', {className: 'card'}, el('summary', {}, title), content);
/** A row of a table: its head and its cells. */
const row = (head, ...cells) =>
  el('tr', {}, el('th', {scope: 'row'}, head), cells.map((cell) => el('td', {}, cell)));

/** A table that scrolls in its box where it is too wide. */
function tableOf(title, columns, rows) {
  return el('div', {className: 'scroll', tabIndex: 0, role: 'region', 'aria-label': short(title, 100)},
    el('table', {}, el('caption', {className: 'hidden'}, short(title, 120)),
       el('thead', {}, el('tr', {}, columns.map((text) => el('th', {scope: 'col'}, text)))), el('tbody', {}, rows)));
}

/** Names and values. */
const factList = (facts) => facts?.length
  ? el('dl', {className: 'facts'}, facts.map(({name, value}) => [el('dt', {}, name), el('dd', {}, value)])) : null;

/** A text as a heading or a chip can hold it. */
function short(text, length = 60) {
  const letters = [...String(text)];
  return letters.length > length ? letters.slice(0, length - 1).join('') + '…' : String(text);
}


/** 0.012345 as "0.0123", 5e-5 as "5×10⁻⁵", no value as "–". */
function number(value, digits = 3) {
  if (typeof value !== 'number' || !Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e-4 && size < 1e6)
    return String(size >= 10 ** digits ? Math.round(value) : Number(value.toPrecision(digits)))
        .replace('-', '−').replace(/\B(?=(\d{3})+$)/g, size >= 1e4 ? '\u202F' : '');
  const [mantissa, exponent] = value.toExponential(digits - 1).split('e');
  const power = String(Number(exponent)).replace(/./g, (c) => c === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[c]);
  const factor = String(Number(mantissa)).replace('-', '−');
  return factor === '1' ? '10' + power : factor + '×10' + power;
}

/** The glossary's entry of a metric; an unknown one is shown in SI under its own name. */
const metric = (name) => Object.hasOwn(model.metrics, name) ? model.metrics[name] :
    {title: name, help: '', unit: '', scale: 1, axis: 'linear', window: '', better: ''};

/** An SI value in the unit of `quantity` (a metric, or an axis of a chart). */
function shown(value, quantity, digits) {
  const text = number(value === null || value === undefined ? NaN : value * quantity.scale, digits);
  return text === '–' || !quantity.unit ? text : text + '\u00A0' + quantity.unit;
}

/** "0.31–0.35 %": a 95 % interval; "" without one. */
function interval(low, high, quantity) {
  if (typeof low !== 'number' || typeof high !== 'number') return '';
  return number(low * quantity.scale) + '–' + shown(high, quantity);
}

const titled = (quantity) => quantity.title + (quantity.unit ? ` [${quantity.unit}]` : '');
const count = (n, one, many = one + 's') => `${n} ${n === 1 ? one : many}`;

/** A field of a CSV file. A spreadsheet would run a text that begins like a formula: such a text gets an apostrophe. */
function csvField(value) {
  if (value === null || value === undefined) return '';
  if (typeof value === 'number') return Number.isFinite(value) ? String(value) : '';
  const text = /^[=+\-@\t\r]/.test(value) ? "'" + value : String(value);
  return /[",\r\n]/.test(text) ? '"' + text.replaceAll('"', '""') + '"' : text;
}

/** A button that hands a text to the clipboard; where that is refused, the text is selected. */
function copyButton(source) {
  const button = el('button', {type: 'button', className: 'copy'}, 'copy');
  button.onclick = async () => {
    try {
      await navigator.clipboard.writeText(source.textContent);
      button.textContent = 'copied';
    } catch {
      getSelection().selectAllChildren(source);
      button.textContent = 'selected: press Ctrl+C';
    }
    setTimeout(() => { button.textContent = 'copy'; }, 2500);
  };
  return button;
}

function command(text) {
  const code = el('code', {}, text);
  return el('div', {className: 'command'}, el('pre', {tabIndex: 0}, code), copyButton(code));
}
