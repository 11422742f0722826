'use strict';
// The model, its entries by id, and what the reader chose, which is kept in the address: every view has a permalink.

const model = JSON.parse(document.getElementById('model').textContent);

const index = (list, key = 'id') => new Map((list ?? []).map((entry) => [entry[key], entry]));
const cases = index(model.cases, 'key'), claims = index(model.claims), charts = index(model.charts);
const maps = index(model.maps), films = index(model.films), tables = index(model.tables);
const scenes = index(model.scenes), statuses = index(model.statuses);
const solvers = new Map(model.solvers.map((solver, order) => [solver.id, {...solver, order}]));

const solverOf = (id) => solvers.get(id) ?? {id, title: id, order: 0, marker: 'circle', dash: ''};
const statusOf = (id) => statuses.get(id) ?? {id, title: id, glyph: '?', help: '', failed: true};
const all = (ids, from) => (ids ?? []).map((id) => from.get(id)).filter(Boolean);

const state = {
  params: () => new URLSearchParams(location.hash.slice(1)),
  get: (key) => state.params().get(key) ?? '',
  /** The section asked for: `at=cost`, or an address that ends in `#cost`. */
  section: () => state.get('at') || [...state.params()].filter(([, value]) => !value).map(([key]) => key)[0] || '',
  /** Changes some choices ("" takes one back); `step` makes it one that the browser's "back" undoes. */
  set(changes, step = true) {
    const next = state.params();
    for (const [key, value] of [...next]) if (!value) next.delete(key);
    for (const [key, value] of Object.entries(changes)) {
      next.delete(key);
      for (const one of [value].flat()) if (one) next.append(key, one);
    }
    history[step ? 'pushState' : 'replaceState'](null, '', '#' + next);
    state.tell();
  },
  watchers: [],
  watch(watcher) { state.watchers.push(watcher); },
  tell() { for (const watcher of state.watchers) watcher(); },
};
addEventListener('popstate', () => state.tell());

/** A link that is a permalink by itself and, clicked, keeps all other choices. */
function choice(changes, props, ...children) {
  return el('a', {...props, href: '#' + new URLSearchParams(changes), onclick: (event) => {
    if (event.ctrlKey || event.metaKey || event.shiftKey) return;
    event.preventDefault();
    state.set(changes);
  }}, ...children);
}

const isOff = (solver) => state.params().getAll('off').includes(solver);

/** Colours of the solvers and statuses as custom properties, and the rules by which switched-off solvers vanish. */
function paint() {
  const sheet = document.styleSheets[0];
  const safe = (colour) => /^#[0-9a-f]{6}$/i.test(colour ?? '') ? colour : '#777777';
  const variables = (theme) => [
    ...[...solvers.values()].map((s) => `--s${s.order}:${safe(s.colour?.[theme])}`),
    ...model.statuses.flatMap((s, i) => [`--c${i}:${safe(s.colour?.[theme])}`, `--i${i}:${safe(s.ink?.[theme])}`])];
  sheet.insertRule(`:root{${variables('light').join(';')}}`, sheet.cssRules.length);
  sheet.insertRule(`@media (prefers-color-scheme:dark){:root{${variables('dark').join(';')}}}`, sheet.cssRules.length);
  for (const {order} of solvers.values())
    sheet.insertRule(`.off-${order} [data-s="${order}"]{display:none}`, sheet.cssRules.length);
  state.watch(() => {
    for (const {id, order} of solvers.values()) document.body.classList.toggle('off-' + order, isOff(id));
  });
}
const solverColour = (id) => `var(--s${solverOf(id).order})`;
const statusIndex = (id) => model.statuses.findIndex((status) => status.id === id);
