'use strict';
// The table of all cases, which can be sorted, filtered and exported as CSV, and the dialog of a
// case.

/**
 * The columns in order of importance. `value` is used for sorting and for the CSV (in SI); `extra`
 * columns are shown on request.
 */
const caseColumns = (() => {
  const plain = (name, title, value, cell) =>
      ({name, title, value, cell: cell ?? ((c) => short(value(c) ?? '', 60))});
  const measured = (name, value) => ({
    name,
    title: titled(metric(name)),
    help: metric(name).help,
    numeric: true,
    value,
    scale: metric(name).scale,
    cell: (c) => number(value(c) === undefined ? NaN : value(c) * metric(name).scale)
  });
  const used = (name) => model.cases.some((c) => Number.isFinite(c.values[name]));
  const values = Object.keys(model.metrics).filter(used), told = (name) => model.metrics[name].role;
  const place = (name) => [...questions.keys(), name].indexOf(name);  // in the answer's order
  const cost = measured('cpu.per_second', (c) => c.cost?.['cpu.per_second']?.mid);
  const extra = (column) => ({...column, extra: true});
  return [
    plain('scene', 'scene', (c) => c.scene),
    plain('solver', 'solver', (c) => c.solver, (c) => named(c.solver)),
    {
      ...plain(
          'brief', 'setting', (c) => c.brief,
          (c) => caseLink(c.key, short(c.brief || 'defaults', 48))),
      head: true
    },
    measured('dt', (c) => c.dt),
    plain(
        'status', 'status', (c) => c.status,
        (c) => [glyphBox(c.status), ' ', statusOf(c.status).title]),
    ...values.filter(told)
        .sort((a, b) => place(a) - place(b))
        .map((name) => measured(name, (c) => c.values[name])),
    ...(model.cases.some((c) => c.cost) ? [cost] : []),
    ...values.filter((name) => !told(name))
        .map((name) => extra(measured(name, (c) => c.values[name]))),
    extra(measured('projections', (c) => c.projections)),
    extra(plain('case', 'case', (c) => c.key)),
    extra(plain('studies', 'studies', (c) => c.studies.join(' '))),
    extra(plain('reason', 'reason', (c) => c.reason)),
    extra(plain('settings', 'all settings', (c) => c.settings)),
  ];
})();

/**
 * Parses a filter: words that the case must have, and conditions such as "dt<=5" in the units
 * shown.
 */
function caseFilter(text) {
  const tests = text.toLowerCase().split(/\s+/).filter(Boolean).map((word) => {
    const [, name, sign, limit] = word.match(/^([\w.]+)(<=|>=|<|>)(.+)$/) ?? [];
    const column = caseColumns.find((c) => c.numeric && c.name.toLowerCase() === name);
    if (!column || !Number.isFinite(Number(limit))) return ({words}) => words.includes(word);
    const compare = {
      '<': (a, b) => a < b,
      '>': (a, b) => a > b,
      '<=': (a, b) => a <= b,
      '>=': (a, b) => a >= b
    }[sign];
    const of = (entry) => column.value(entry) * column.scale;
    return ({entry}) => Number.isFinite(of(entry)) && compare(of(entry), Number(limit));
  });
  return (row) => tests.every((test) => test(row));
}

const wordsOf =
    ({key, id, brief, status, reason, studies}) => [key, id, brief, status, reason, ...studies]
                                                       .join(' ')
                                                       .toLowerCase();
const caseRows = model.cases.map((entry) => ({entry, words: wordsOf(entry)}));

/** The cases that remain after the reader's choices, in the chosen order. */
function chosenCases() {
  const [name, down] = [state.get('sort').replace(/^-/, ''), state.get('sort').startsWith('-')];
  const column = caseColumns.find((c) => c.name === name), passes = caseFilter(state.get('find'));
  const chosen = (key, holds) => !state.get(key) || holds(state.get(key));
  const left = ({entry}) => !isOff(entry.solver) &&
      chosen('in', (scene) => entry.scene === scene) &&
      chosen('ended', (status) => entry.status === status) &&
      chosen('study', (study) => entry.studies.includes(study));
  const rows = caseRows.filter((row) => left(row) && passes(row)).map(({entry}) => entry);
  if (!column) return rows;
  const missing = (v) => v === undefined || v === null || Number.isNaN(v);
  return rows.sort((a, b) => {
    const [u, v] = [column.value(a), column.value(b)];
    if (missing(u) || missing(v)) return missing(u) - missing(v);
    return (down ? -1 : 1) *
        (column.numeric ? u - v : String(u).localeCompare(String(v), 'en', {numeric: true}));
  });
}

function casesCsv(rows) {
  const head = caseColumns.map((c) => csvField(c.name)).concat('command');
  const line = (row) => [...caseColumns.map((c) => c.value(row)), row.command].map(csvField);
  return csvText([head, ...rows.map(line)]);
}

const rowsAtFirst = 100;
const shownColumns = () =>
    caseColumns.filter((c) => !c.extra || state.params().getAll('column').includes(c.name));

/** Checkboxes for the extra columns. */
function columnChooser() {
  const boxes = caseColumns.filter((c) => c.extra).map(({name, title}) => {
    const box = el('input', {
      type: 'checkbox',
      onchange: () => {
        const now = state.params().getAll('column');
        state.set(
            {column: box.checked ? [...now, name] : now.filter((other) => other !== name)}, false);
      }
    });
    state.watch(() => {
      box.checked = state.params().getAll('column').includes(name);
    });
    return el('label', {}, box, ' ', short(title, 60));
  });
  return el(
      'details', {}, el('summary', {}, `further columns (${boxes.length})`),
      el('div', {className: 'chooser'}, boxes));
}

function casesSection() {
  const body = el('tbody'), said = el('p', {className: 'note', role: 'status'});
  const choose = (name, title, values) => values.length < 2 ?
      null :
      el('label', {}, title + ' ',
         el('select', {name, onchange: (event) => state.set({[name]: event.target.value}, false)},
            el('option', {value: ''}, 'all'),
            values.map((value) => el('option', {value}, short(value, 40)))));
  const find = el('input', {
    type: 'search',
    name: 'find',
    placeholder: 'words, or dt<=5',
    autocomplete: 'off',
    oninput: () => state.set({find: find.value}, false)
  });
  const headOf = (column) =>
      el('th', {
        scope: 'col',
        className: column.numeric ? 'numeric' : '',
        'aria-sort':
            {[column.name]: 'ascending', ['-' + column.name]: 'descending'}[state.get('sort')] ??
            'none'
      },
         el('button', {
           type: 'button',
           title: column.help ?? '',
           'data-column': column.name,
           onclick: () => {
             const now = state.get('sort');
             state.set(
                 {
                   sort: now === column.name     ? '-' + column.name :
                       now === '-' + column.name ? '' :
                                                   column.name
                 },
                 false);
           }
         },
            short(column.title, 48)));
  const heads = el('tr');
  const table = el(
      'table', {}, el('caption', {className: 'hidden'}, 'All cases'), el('thead', {}, heads), body);
  const more = el('button', {type: 'button'});
  const save =
      el('a', {className: 'button', href: '#cases', download: 'cases.csv'},
         'download what is shown (CSV, SI units)');
  let rows = [];
  const line = (entry) =>
      el('tr', {'data-key': entry.key},
         shownColumns().map(
             (column) =>
                 el(column.head ? 'th' : 'td',
                    {scope: column.head && 'row', className: column.numeric ? 'numeric' : ''},
                    column.cell(entry))));
  const fill = (upTo) => {
    body.replaceChildren(...rows.slice(0, upTo).map(line));
    more.hidden = rows.length <= upTo;
    more.textContent = `show all ${rows.length}`;
  };
  more.onclick = () => fill(Infinity);
  save.onclick = () => {
    save.href = 'data:text/csv;charset=utf-8,' + encodeURIComponent(casesCsv(rows));
  };
  const selects = [
    choose('in', 'scene', [...new Set(model.cases.map((c) => c.scene))]),
    choose('ended', 'status', [...new Set(model.cases.map((c) => c.status))]),
    choose('study', 'study', [...new Set(model.cases.flatMap((c) => c.studies))])
  ];
  let last = null;
  state.watch(() => {
    const asked = JSON.stringify([
      ...['find', 'in', 'ended', 'study', 'sort'].map(state.get), state.params().getAll('off'),
      state.params().getAll('column')
    ]);
    if (asked === last) return;
    last = asked;
    rows = chosenCases();
    const focused = document.activeElement?.dataset?.column;
    heads.replaceChildren(...shownColumns().map(headOf));
    if (focused) heads.querySelector(`[data-column="${CSS.escape(focused)}"]`)?.focus();
    fill(rowsAtFirst);
    said.textContent = `${rows.length} of ${count(model.cases.length, 'case')}: ` +
        d3.nest()
            .key((c) => c.status)
            .rollup((group) => group.length)
            .entries(rows)
            .map(({key, value}) => `${value} ${statusOf(key).title}`)
            .join(', ');
    if (document.activeElement !== find) find.value = state.get('find');
    for (const select of selects.filter(Boolean))
      select.lastChild.value = state.get(select.lastChild.name);
  });
  return el(
      'section', {id: 'cases'}, el('h2', {}, 'All cases'),
      model.meta.listed &&
          note(
              `${model.meta.listed} of ${model.meta.cases} cases are listed here: `,
              'those that this page names, and others spread evenly over the studies. ',
              'Of a study of that size only the values of tables and charts are here. ',
              'This writes all cases with all values: ',
              el('code', {}, `taut export ${model.method.studies[0].name} -o cases.csv`)),
      el('div', {className: 'filters'}, el('label', {}, 'find ', find), selects, save),
      columnChooser(), said,
      el('div', {
        className: 'card scroll tall',
        tabIndex: 0,
        role: 'region',
        'aria-label': 'Table of cases'
      },
         table),
      more,
      el('p', {className: 'print-only'},
         'The table of all cases is on the screen; it is too wide for paper.'));
}

/** Measured values of a case, each with its window or interval. */
function caseValues(entry) {
  const line = (quantity, text, remark) => {
    const node = row(quantity.title, text, remark);
    node.firstChild.title = quantity.help;
    return node;
  };
  const rows = Object.entries(entry.values)
                   .map(
                       ([name, value]) =>
                           line(metric(name), shown(value, metric(name), 4), metric(name).window));
  const cost = entry.cost?.['cpu.per_second'], unit = metric('cpu.per_second');
  if (cost)
    rows.push(line(
        unit, `${shown(cost.mid, unit, 4)} (${interval(cost.low, cost.high, unit)})`,
        `95 %, n = ${cost.n}`));
  return rows.length ? tableOf('Values', ['value', 'measured', 'window'], rows) :
                       el('p', {}, 'It has no values.');
}

/**
 * Fills the dialog of a case: how it ended, its settings, values and film, and the command that
 * runs it again.
 */
function fillCase(dialog, entry) {
  const status = statusOf(entry.status), film = films.get(entry.film);
  const facts = [
    {
      name: 'status',
      value: [
        glyphBox(entry.status), ` ${status.title}${entry.reason ? `: ${entry.reason}` : ''}`,
        entry.step >= 0 && `, step ${entry.step}`, entry.vertex >= 0 && `, vertex ${entry.vertex}`
      ]
    },
    ...(entry.finding ? [{name: 'finding', value: entry.finding}] : []),
    {name: 'time step', value: shown(entry.dt, metric('dt'), 4)},
    {name: 'steps', value: entry.steps}, {
      name: 'cloth',
      value: `${count(entry.vertices, 'vertex', 'vertices')}, ${count(entry.links, 'link')}`
    },
    {name: 'work', value: `${entry.projections} projections per step`},
    ...Object.entries(entry.parameters).map(([name, value]) => ({name: short(name), value})),
    {name: 'studies', value: entry.studies.join(', ')},
    {name: 'case', value: el('code', {}, entry.id)}
  ];
  dialog.setAttribute('aria-labelledby', 'case-title');
  dialog.replaceChildren(
      el('header', {},
         el('h2', {id: 'case-title'}, named(entry.solver),
            ` ${short(entry.brief, 80)} on ${short(entry.scene)}`),
         el('button',
            {type: 'button', onclick: () => state.set({case: ''}), 'aria-label': 'close the case'},
            'close')),
      el('div', {className: 'columns'}, factList(facts), caseValues(entry)),
      film ? el('p', {}, choice({scene: film.scene, at: 'film', case: ''}, {}, 'see its film')) :
             note('No film shows this case.'),
      el('p', {}, 'This runs it again, from any folder:'), command(entry.command));
}

function watchCase() {
  const dialog = document.getElementById('case');
  dialog.addEventListener('close', () => {
    if (state.get('case')) state.set({case: ''});
  });
  dialog.addEventListener('click', (event) => {
    if (event.target === dialog) dialog.close();
  });
  state.watch(() => {
    const entry = cases.get(state.get('case'));
    if (!entry) return dialog.open && dialog.close();
    fillCase(dialog, entry);
    if (!dialog.open) dialog.showModal();
    return undefined;
  });
}
