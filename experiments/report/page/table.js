'use strict';
// Tables of any answer. A cell is a number with its unit, a text or an interval; it can be marked
// as the best of its row, have a bar, and lead to its case. The answer on the first screen consists
// of such tables, each shown as one row that unfolds to its scenes.

/** Tables by name; their cells are {value, state, note, terms, key, scene, best}. */
function unpacked(tables) {
  for (const table of Object.values(tables ?? {})) {
    table.rows = table.rows.map((cells) => cells.map((value) => ({value})));
    const place = new Map(table.columns.map(({name}, i) => [name, i]));
    for (const {row: at, column, ...more} of table.notes)
      Object.assign(table.rows[at][place.get(column)], more);
  }
  return new Map(Object.entries(tables ?? {}).map(([name, table]) => [name, {...table, name}]));
}
const tables = unpacked(model.tables), questions = unpacked(model.answer?.tables);

/** Mark of a solver with its colour and its marker, so that hue is not the only distinction. */
function mark(id) {
  const svg = d3.create('svg')
                  .attr('class', 'mark')
                  .attr('viewBox', '-7 -7 14 14')
                  .attr('aria-hidden', 'true');
  svg.append('path').attr('d', markerPath(solverOf(id).marker, 60)).style('fill', solverColour(id));
  return svg.node();
}
const named = (id, title) =>
    el('span', {className: 'solver'}, mark(id), short(title ?? solverOf(id).title, 40));

/** A link that opens a case and shows its status as a tooltip. */
function caseLink(key, ...text) {
  if (!cases.has(key)) return el('span', {}, ...text);
  const link = choice({case: key}, {className: 'to-case'}, ...text);
  describe(link, [link.textContent, ...caseLines(cases.get(key).status, undefined, key)]);
  return link;
}

/** Entries of an object by solver, in the order of the solvers. */
const bySolver = (counts) =>
    Object.entries(counts).sort(([a], [b]) => solverOf(a).order - solverOf(b).order);

const middle = (value) => Array.isArray(value) ? value[1] : typeof value === 'number' ? value : NaN;
const unitOf = (column) => ({unit: column.shown ?? '', scale: column.scale ?? 1});

/** Text of a cell; for an interval, its middle. */
function cellText({value}, column) {
  if (Number.isFinite(middle(value))) return shown(middle(value), unitOf(column), column.digits);
  return value === null ? '' : typeof value === 'boolean' ? value ? 'yes' : 'no' : value;
}

/** Half width of an interval, "±0.3 %", with the interval as a tooltip. */
function spreadOf([low, mid, high], column) {
  return el(
      'small', {title: interval(low, high, unitOf(column))},
      ` ±${number(100 * Math.max(high - mid, mid - low) / mid, 1)}\u00A0%`);
}

/**
 * Whether a cell has words in place of a value: "not run", "exploded". A strain of cloth that is
 * elsewhere is a number, but it is not compared.
 */
const lacks = ({state, value}) =>
    Boolean(state) && state !== 'value' && !Number.isFinite(middle(value));

/** Content of a cell. `most` is the number of a full bar; without it there is no bar. */
function cellContent(cell, column, most) {
  const entry = cases.get(cell.key), text = cellText(cell, column), value = middle(cell.value),
        note = cell.note ?? '';
  const brief = lacks(cell) ? note.replace(/ \(\S*\)$/, '') : note;  // a setting does not fit
  const noted = cell.state === 'astray' ? 'is elsewhere' : brief;
  const whole = [note, explain(cell.terms)].filter(Boolean).join('\n');
  const share = 100 * Math.max(0, value) / most;
  const spread = Array.isArray(cell.value) && spreadOf(cell.value, column);
  const said = cell.best ? el('b', {className: 'best'}, text) : text;
  const failed = entry && entry.status !== 'ok' && lacks(cell) && glyphBox(entry.status);
  return [
    el('span', {className: 'said'}, failed, failed && ' ', entry ? caseLink(cell.key, said) : said,
       cell.best && el('span', {className: 'hidden'}, ' best'), spread,
       note && el('small', {title: whole}, ' ', kept(short(noted, 90)))),
    most > 0 && Number.isFinite(value) &&
        el('span', {className: 'bar', 'aria-hidden': 'true'},
           el('i', {style: `width:${share}%;background:${solverColour(column.name)}`}))
  ];
}

/** A row: its head, then a cell for each column. Cells of a solver are hidden with the solver. */
function tableRow(table, cells, props, head, bars) {
  const most = bars ? d3.max(cells, (cell) => middle(cell.value)) : 0;
  return el(
      'tr', props, el('th', {scope: 'row'}, head ?? cellContent(cells[0], table.columns[0])),
      cells.slice(1).map((cell, i) => {
        const column = table.columns[i + 1], solver = solvers.get(column.name);
        return el(
            'td', {'data-s': solver?.order, className: solver && lacks(cell) ? 'none' : ''},
            cellContent(cell, column, most));
      }));
}
/**
 * Heads of the columns with their units. `first` replaces the first head; units are then omitted.
 */
function tableHeads(table, first) {
  const solverHead = ({name, heading}) => {
    const {arithmetic, terms} = solverOf(name);
    const how = arithmetic && explained(arithmetic, terms, {className: 'arithmetic'});
    return [named(name, heading), how];
  };
  const head = (column, i) => {
    if (i === 0 && first !== undefined) return first;
    const unit = column.shown && first === undefined && ` [${column.shown}]`;
    return [solvers.has(column.name) && i > 0 ? solverHead(column) : column.heading, unit];
  };
  const cell = (column, i) =>
      el('th', {scope: 'col', 'data-s': solvers.get(column.name)?.order}, head(column, i));
  return el('tr', {}, table.columns.map(cell));
}

/** Text for copying: the table for a spreadsheet, with numbers in SI. */
function tableCsv(table) {
  const field = ({value}) => csvField(Array.isArray(value) ? value[1] : value);
  const unit = (c) => c.unit && c.unit !== '1' ? ` [${c.unit}]` : '';
  const heads = table.columns.map((c) => csvField(c.heading + unit(c)));
  return csvText([heads, ...table.rows.map((cells) => cells.map(field))]);
}

const tableBody = (table) =>
    [note(table.caption),
     scrolling(
         `${table.title} (${table.name})`, tableHeads(table),
         table.rows.map((cells) => tableRow(table, cells)))];
const tableNode = (table, heading = 'h4') =>
    el('div', {className: 'card', id: `table-${table.name}`},
       el(heading, {}, short(table.title, 120), ' ', copyButton(() => tableCsv(table))),
       tableBody(table));
const foldedTable = (table) =>
    folded(table.title, copyButton(() => tableCsv(table)), tableBody(table));

/** Names of unfolded questions; by default the first, if the window is wide and has no map. */
function unfolded() {
  const chosen = state.params().getAll('open').filter((name) => name !== 'none');
  const folded = state.get('open') || innerWidth < 1000 || model.winners;
  return folded ? chosen : [...questions.keys()].slice(0, 1);
}

/** The scene of a row; "" for the row of all scenes. */
const sceneOf = ([{scene}]) => scene ?? '';
const scenesOf = (table) => table.rows.length > 2 ? table.rows.slice(0, -1) : [];

/**
 * Rows of a question: that of all scenes together or of the chosen scene, then those of each scene,
 * which a click unfolds.
 */
function questionRows(table) {
  const last = table.rows[table.rows.length - 1], id = `answer-${table.name}`;
  const sceneCell = ([{value, scene, note: why}]) =>
      [scenes.has(scene) ? choice({scene, at: 'scenes'}, {}, value) : value,
       why && el('small', {}, ' ', why)];
  const folds = [
    el('tr', {className: 'fold'},
       el('td', {colSpan: table.columns.length}, el('small', {}, table.caption, ' '),
          copyButton(() => tableCsv(table)))),
    ...scenesOf(table).map(
        (cells) => tableRow(table, cells, {className: 'fold'}, sceneCell(cells), true))
  ];
  const button = el('button', {type: 'button', className: 'unfold'}, table.title),
        body = el('tbody', {id}, folds);
  button.onclick = () => {
    const others = unfolded().filter((name) => name !== table.name);
    const opens = others.length === unfolded().length;
    state.set({open: opens ? [...others, table.name] : others.length ? others : 'none'}, false);
  };
  let head = null, shown = null;
  state.watch(() => {
    const open = unfolded().includes(table.name), scene = chosenScene();
    const empty = () => [{value: `not on ${scene}`}, ...last.slice(1).map(() => ({value: null}))];
    const rowOf = () => table.rows.find((row) => sceneOf(row) === scene) ?? empty();
    const cells = scene ? rowOf() : last;
    button.setAttribute('aria-expanded', open);
    for (const fold of folds) fold.classList.toggle('folded', !open);
    if (cells === shown) return;
    head?.remove();
    shown = cells;
    head = tableRow(
        table, cells, {className: scene ? 'question of-scene' : 'question'},
        [
          button,
          el('small', {title: cells[0].note ?? ''}, cells[0].value,
             cells[0].scene && cells[0].note && ` ${cells[0].note}`)
        ],
        true);
    body.prepend(head);
  });
  return body;
}

/** Scenes for which there are answers. */
const answered = [...new Set([...questions.values()].flatMap(scenesOf).map(sceneOf))];
/** The scene whose cells the questions show; "" for all scenes together. */
const chosenScene = () => answered.includes(state.get('scene')) ? state.get('scene') : '';
function sceneChooser() {
  const links = ['', ...answered].map((scene) => choice({scene}, {}, scene || 'All scenes'));
  state.watch(() => links.forEach((link, i) => {
    if (['', ...answered][i] === chosenScene())
      link.setAttribute('aria-current', 'true');
    else
      link.removeAttribute('aria-current');
  }));
  return el(
      'nav', {className: 'chips still', id: 'answer-scenes', 'aria-label': 'scene of the answer'},
      el('span', {}, 'The table below is of'), links);
}

/** Head of the page: what it is about and the question. */
function pageHead() {
  const {meta} = model, of = meta.cases < meta.planned ? ` of ${meta.planned}` : '';
  const facts = [`${meta.cases}${of} cases`, meta.preset, meta.made, meta.machine].filter(Boolean);
  return [
    note(el('b', {}, 'taut'), ' report · ', facts.join(' · ')),
    el('h1', {}, meta.question || meta.title)
  ];
}

/** The first screen, with a row for each question. */
function answerSection() {
  const asked = [...questions.values()];
  return el(
      'section', {id: 'answer'},
      model.differences ? el('h2', {}, `B alone: ${model.differences.b}`) : pageHead(),
      winnersPart(), answered.length > 1 && sceneChooser(),
      asked.length ?
          el('div', {
            className: `card scroll answer ${asked[0].columns.length < 5 ? 'few' : ''}`,
            tabIndex: 0,
            role: 'region',
            'aria-label': 'The answer'
          },
             el('table', {}, el('caption', {}, model.answer.subject),
                el('thead', {}, tableHeads(asked[0], 'question')), asked.map(questionRows))) :
          null,
      asked.length ? termList() : null);
}
