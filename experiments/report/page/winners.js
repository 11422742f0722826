'use strict';
// Winners: the map of the cheapest solvers, error over cost beside it, a summary in sentences, and
// the meaning of every abbreviation.

const meanings = new Map((model.terms ?? []).map(({term, meaning}) => [term, meaning]));
/** Meanings of these terms, one per line. */
function explain(terms) {
  return (terms ?? [])
      .filter((term) => meanings.has(term))
      .map((term) => `${term}: ${meanings.get(term)}`)
      .join('\n');
}
/** Keeps "2 × 8" in a setting on one line. */
const kept = (text) => text.replaceAll(' × ', '\u00A0×\u00A0');
const explained = (text, terms, props = {}) =>
    el('small', {...props, title: explain(terms)}, kept(text));

/** The list of all terms; those of one meaning stand together. */
function termList() {
  if (!model.terms?.length) return null;
  const entry = ([meaning, terms], i) => {
    const names = terms.map((term) => term.replaceAll(' ', '\u00A0')).join(', ');
    return [i ? '; ' : '', el('b', {}, names), ` ${meaning}`];
  };
  const byMeaning = new Map();
  for (const {term, meaning} of model.terms)
    byMeaning.set(meaning, [...(byMeaning.get(meaning) ?? []), term]);
  return el('p', {className: 'note terms'}, [...byMeaning].map(entry), '.');
}

/** Part of a sentence. A number links to its case, or to the map whose cells it counts. */
function saidPart({text, case: key, map}) {
  if (key) return caseLink(key, text);
  return map ? choice({at: 'winners'}, {}, text) : text;
}
const sentence = (parts) => el('p', {className: 'finding'}, parts.map(saidPart));

const frameCost = {
  unit: 'ms',
  scale: 1e3 * (model.winners?.frame ?? 1)
};

/** The map that is shown: by the whole error, or by stretch alone. */
const mapOf = () => state.get('by') === 'stretch' ? model.winners.by_stretch : model.winners;
const levelText = (level, map) => shown(level, metric(map.metric), 2);
const costOf = (one) => (one.at_most ? '≤ ' : '') + shown(one.cost[1], frameCost, 2);
const timesText = ([low, mid, high]) =>
    `${number(mid, 2)} (${number(low, 2)} to ${number(high, 2)}) times`;

/** Address of a cell of the map: "swing@0.05". */
const cellId = (row, level) => `${row.title}@${level}`;
/** The opened cell; at first, in a wide window, the first that has a winner at a middle error. */
function openedCell() {
  const {rows, levels} = mapOf(), chosen = state.get('cell');
  if (chosen || innerWidth < 1000) return chosen;
  const middle = levels[Math.floor(levels.length / 2)];
  const row = rows.find(({cells}) => cells[levels.indexOf(middle)].cheapest);
  return row ? cellId(row, middle) : '';
}

/** A cell in three short lines: the solver, its cost, and how it compares with the next. */
function winnerCell(row, cell, level, map) {
  const {cheapest, next, times} = cell, id = cellId(row, level);
  const others =
      (cheapest ?? []).slice(1).map((one) => [mark(one.solver), solverOf(one.solver).title]);
  const over = () => others.length ? ['≈ ', others] :
      next                         ? [el('b', {}, `${number(times[1], 2)}×`), ' cheaper'] :
                                     'alone';
  const content = cheapest ?
      [named(cheapest[0].solver), el('span', {}, costOf(cheapest[0])), el('small', {}, over())] :
      el('small', {}, 'nobody');
  const button = el(
      'button',
      {type: 'button', onclick: () => state.set({cell: openedCell() === id ? 'none' : id}, false)},
      content);
  state.watch(() => button.setAttribute('aria-expanded', openedCell() === id));
  return el('td', {className: cheapest ? '' : 'none', 'data-level': levelText(level, map)}, button);
}

/** Up to which time step a solver is stable, as the answer says for this scene or another one. */
function largestStep(solver, scene) {
  const table = questions.get('largest_step');
  if (!table) return null;
  const cells = table.rows.find(([head]) => head.scene === scene) ?? table.rows[0];
  const place = table.columns.findIndex(({name}) => name === solver);
  if (place < 0 || cells[place].state === 'not_run') return null;
  const {value} = cells[place], rate = Math.round(1 / value);
  const whole = rate > 1 && Math.abs(1 / value - rate) < 1e-3;
  const text = whole ? `up to 1/${rate} s` : cellText(cells[place], table.columns[place]);
  return `stable ${Number.isFinite(value) ? text : `only ${value}`} on ${cells[0].scene} ${
      cells[0].note}`;
}

/** All of a setting that reaches the error, with the command that runs it. */
function contender(one, row, how) {
  const projections = cases.get(one.case)?.projections;
  const [low, , high] = one.cost;
  const facts = [
    [one.arithmetic, one.links && `springs of ${one.links}`].filter(Boolean).join(', '),
    one.motion !== undefined && `error ${levelText(one.motion, model.winners)}`,
    one.stretch !== undefined && `RMS stretch ${levelText(one.stretch, model.winners)}`,
    one.largest !== undefined && `largest ${levelText(one.largest, model.winners)}`,
    projections > 0 && `${number(projections)} projections a step`,
    largestStep(one.solver, row.scene)
  ];
  return el(
      'div', {className: 'contender'},
      el('div', {}, named(one.solver), ' ',
         el('span', {className: 'price'}, caseLink(one.case, costOf(one)), ' a frame ',
            el('small', {}, `(${interval(low, high, frameCost)})`)),
         ' ', explained(one.setting, one.terms, {className: 'setting'}), how && [' ', how]),
      el('small', {title: explain([one.arithmetic])}, facts.filter(Boolean).join(' · ')),
      !how && command(one.command));
}

/** What is known of a cell: its contenders, the next, Bullet, and who does not count. */
function cellDetail(row, cell, level, map) {
  const {cheapest = [], next, times, bullet, excluded = []} = cell;
  const beside = (one, ratio, said) =>
      contender(one, row, el('span', {className: 'over'}, said(ratio)));
  const isThere = (one) => one && ![...cheapest, next].some((other) => other?.case === one.case);
  const lines = [
    cheapest.map((one) => contender(one, row)),
    cheapest.length > 1 && note('Noise cannot tell these apart.'),
    !cheapest.length && note(`Nobody: ${cell.why}.`),
    cheapest.length && !next && note('No other solver reaches it with a setting that was timed.'),
    next && beside(next, times, (t) => `costs ${timesText(t)} as much`),
    isThere(bullet) &&
        beside(bullet, cell.bullet_times, (t) => t ? `costs ${timesText(t)} as much` : 'dearer'),
    !bullet && row.bullet && note(`btSoftBody: ${row.bullet}.`),
    excluded.map(({solver, why}) => note(`Not counted: ${solverOf(solver).title}: ${why}.`))
  ];
  return el(
      'div', {},
      el('h4', {}, `${row.title} at ${levelText(level, map)} `,
         el('button',
            {type: 'button', className: 'copy', onclick: () => state.set({cell: 'none'}, false)},
            'close')),
      lines);
}

/** The rows of a scene: its cells, and the opened one below them. */
function winnerRows(row, map) {
  const {levels} = map;
  const judgedBy = {observables: 'by where it comes to rest', nothing: 'motion not judged'};
  const line =
      el('tr', {},
         el('th', {scope: 'row'},
            scenes.has(row.scene) ? choice({scene: row.scene, at: 'scenes'}, {}, row.title) :
                                    row.title,
            row.by in judgedBy && el('small', {}, judgedBy[row.by])),
         row.cells.map((cell, i) => winnerCell(row, cell, levels[i], map)));
  const box = el('td', {colSpan: levels.length + 1}),
        detail = el('tr', {className: 'detail', hidden: true}, box);
  let shown = '';
  state.watch(() => {
    line.classList.toggle('chosen', chosenScene() === row.scene);
    const at = levels.findIndex((level) => map === mapOf() && openedCell() === cellId(row, level));
    detail.hidden = at < 0;
    const now = at < 0 ? '' : cellId(row, levels[at]);
    if (now && now !== shown) box.replaceChildren(cellDetail(row, row.cells[at], levels[at], map));
    shown = now;
  });
  return [line, detail];
}

/** A row for each scene, a column for each error. */
function winnersTable(map) {
  const node = scrolling(
      'The cheapest solver of each error on each scene',
      el('tr', {}, el('th', {scope: 'col'}, 'scene'),
         map.levels.map((level) => el('th', {scope: 'col'}, levelText(level, map)))),
      map.rows.map((row) => winnerRows(row, map)));
  state.watch(() => {
    node.hidden = map !== mapOf();
  });
  return node;
}

/** The switch between the map by the whole error and that by stretch alone. */
function errorSwitch() {
  const kinds = [['', 'motion and stretch'], ['stretch', 'stretch alone']];
  const buttons = kinds.map(
      ([by, text]) =>
          el('button', {type: 'button', className: 'switch', onclick: () => state.set({by}, false)},
             text));
  state.watch(
      () => kinds.forEach(
          ([by], i) => buttons[i].setAttribute('aria-pressed', state.get('by') === by)));
  return el('div', {className: 'kinds', role: 'group', 'aria-label': 'what the error is'}, buttons);
}

/** The map of the cheapest solvers. */
function winnersCard() {
  const {rules, certainty, frame, by_stretch: byStretch} = model.winners;
  return el(
      'div', {className: 'card winners', id: 'winners'},
      el('div', {className: 'head'},
         el(model.differences ? 'h3' : 'h2', {}, 'Cheapest for an error of at most ...'),
         errorSwitch()),
      winnersTable(model.winners), winnersTable(byStretch),
      note(
          `CPU time a frame of 1/${number(1 / frame)} s; `,
          '≈: noise cannot tell them apart; alone: no other solver reaches it. ',
          'A click on a cell shows its setting, its command and the others.'),
      all(model.winners.tables, tables)
          .map((table) => el('details', {}, el('summary', {}, table.title), tableBody(table))),
      el('details', {}, el('summary', {}, 'What the error is, and which settings count'),
         note([...rules, certainty].join(' '))));
}

/** A figure whose panel is that of the opened cell's scene. */
function sceneFigure(figure) {
  const node = chartFigure(figure, (spec) => short(spec.scene, 30), true);
  const panels =
      all(figure.charts, charts)
          .map(({id, scene}) => [scene, node.querySelector(`#${CSS.escape(`chart-${id}`)}`)]);
  state.watch(() => {
    const {rows, levels} = mapOf(), opened = openedCell();
    const row = rows.find((one) => levels.some((level) => cellId(one, level) === opened));
    const chosen = panels.some(([scene]) => scene === row?.scene) ? row.scene : panels[0][0];
    for (const [scene, panel] of panels) panel.hidden = scene !== chosen;
  });
  return node;
}

/** The part of the first screen about what was timed. */
function winnersPart() {
  if (!model.winners) return null;
  const costs = figuresOf('cost');
  const {sentences = [], authors, noise} = model.winners;
  return [
    sentences.map(sentence),
    note(`${authors ?? ''} Two runs of identical code differed by up to ${noise} in cost.`),
    el('div', {className: 'first'}, winnersCard(), costs.map(sceneFigure))
  ];
}
