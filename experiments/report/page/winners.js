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

/**
 * A setting that reaches the error: its solver, the factor by which it beats the next solver, its
 * cost, its parameters, arithmetic and links, and how stretched its cloth is.
 */
function contender(one, over) {
  const cost = (one.at_most ? '≤ ' : '') + shown(one.cost[1], frameCost, 2);
  const links = one.links && `springs of ${one.links}`;
  const stretch = one.stretch !== undefined &&
      `RMS stretch ${shown(one.stretch, metric(model.winners.metric), 2)}`;
  return el(
      'div', {className: 'contender'}, named(one.solver), over,
      el('div', {className: 'price'}, caseLink(one.case, cost), ' ',
         explained(one.setting, one.terms)),
      explained(
          [one.arithmetic, links].filter(Boolean).join(', '), [one.arithmetic], {className: 'how'}),
      stretch && el('small', {className: 'how'}, stretch));
}

/** How many times cheaper it is than the cheapest setting of another solver. */
function overNext(next, times) {
  const {title} = solverOf(next.solver);
  const cost = `${shown(next.cost[1], frameCost, 2)} by ${title}, ${next.setting}`;
  return el(
      'div', {
        className: 'over',
        title: `${cost}: ${number(times[0])} to ${number(times[2])} times as much`
      },
      el('b', {}, `${number(times[1], 2)}×`), ` cheaper than ${short(title, 24)}`);
}

/** A cell. On a phone, where columns are below each other, it also shows its error. */
function winnerCell(cell, level) {
  const error = shown(level, metric(model.winners.metric), 2);
  const node = (props, ...content) =>
      el('td', {...props, 'data-level': error}, el('div', {}, content));
  if (!cell.cheapest) return node({className: 'none'}, '–', el('small', {}, ' ', cell.why));
  const {cheapest, next, times} = cell, excluded = cell.excluded ?? [];
  const over = cheapest.length === 1 &&
      (next ? overNext(next, times) : el('div', {className: 'over'}, 'no other reaches it'));
  return node(
      {}, cheapest.map((one) => contender(one, over)),
      cheapest.length > 1 && el('small', {}, 'noise cannot tell them apart'),
      excluded.length > 0 &&
          el('small', {
            className: 'passed',
            title: excluded.map(({solver, why}) => `${solverOf(solver).title}: ${why}`).join('\n')
          },
             `not counted: ${excluded.map(({solver}) => solverOf(solver).title).join(', ')}`));
}

/** The map: a row for each scene, a column for each error. */
function winnersCard() {
  const {rows, levels, rules, certainty} = model.winners, error = metric(model.winners.metric);
  const judgedBy = {observables: 'by where it comes to rest', nothing: 'motion not judged'};
  const line = (row) => {
    const node =
        el('tr', {},
           el('th', {scope: 'row'},
              scenes.has(row.scene) ? choice({scene: row.scene, at: 'scenes'}, {}, row.title) :
                                      row.title,
              row.by in judgedBy && el('small', {}, judgedBy[row.by])),
           row.cells.map((cell, i) => winnerCell(cell, levels[i])));
    state.watch(() => node.classList.toggle('chosen', chosenScene() === row.scene));
    return node;
  };
  return el(
      'div', {className: 'card winners', id: 'winners'},
      el(model.differences ? 'h3' : 'h2', {}, `Cheapest for an error of at most ...`),
      scrolling(
          'The cheapest solver of each error on each scene',
          el('tr', {}, el('th', {scope: 'col'}, 'scene'),
             levels.map((level) => el('th', {scope: 'col'}, shown(level, error, 2)))),
          rows.map(line)),
      note([...rules, certainty].join(' ')));
}

/** The part of the first screen about what was timed. */
function winnersPart() {
  if (!model.winners) return null;
  const costs = figuresOf('cost');
  const nameOf = (spec) => short(spec.scene, 30);
  return [
    (model.winners.sentences ?? []).map(sentence),
    el('div', {className: 'first'}, winnersCard(),
       costs.map((figure) => chartFigure(figure, nameOf)))
  ];
}
