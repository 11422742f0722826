'use strict';
// The sections on all scenes, except for the answer (table.js). A section without content is not
// made.

const section = (id, title, ...content) => el('section', {id}, el('h2', {}, title), content);
const list = (title, items) => items?.length ? [el('h3', {}, title), el('ul', {}, items)] : null;

/**
 * Differences between two folders. This section heads the page, above the contents of the second
 * folder.
 */
function differencesSection() {
  const both = model.differences;
  if (!both) return null;
  return el(
      'section', {id: 'differences'}, pageHead(), el('h2', {}, 'What differs'),
      note(`A: ${both.a}; B: ${both.b}`), note(both.matched),
      all(both.tables, tables).map((table) => tableNode(table, 'h3')));
}

function costSection() {
  const shown = all(model.cost?.tables, tables);
  if (!shown.length) return null;
  const where = 'charts and tables of single scenes are with their scenes';
  return section(
      'cost', 'What accuracy costs', note(`CPU time on ${model.cost.machine}; ${where}.`),
      shown.map((table) => tableNode(table, 'h3')));
}

function stepsSection() {
  const {steps} = model;
  if (!steps) return null;
  return section(
      'steps', 'Inside one step',
      note(
          'Each solver does 1, 2, 3, ... iterations of one step from the same state: ',
          'what does the next iteration gain? ', el('code', {}, 'taut converge')),
      figuresOf('steps').map((figure) => chartFigure(figure, (spec) => short(spec.title, 60))),
      all(steps.tables, tables).map(foldedTable));
}

function limitsSection() {
  const shown = all(model.limits?.tables, tables);
  if (!shown.length) return null;
  return section(
      'limits', 'What scenes require, and how far solvers go',
      shown.map((table) => tableNode(table, 'h3')));
}

function truthsSection() {
  const {truths} = model;
  if (!truths) return null;
  const columns = ['closed form or published number', 'solver', 'expected', 'measured', 'verdict'];
  const line = (r) =>
      row([r.statement, el('small', {}, ` ${r.source}`)], r.subject, r.expected, r.measured,
          [r.verdict, r.why && `: ${r.why}`]);
  const part = (title, rows, open) =>
      el('details', {open}, el('summary', {}, `${title} (${rows.length})`),
         tableOf(title, columns, rows.map(line)));
  const apart = truths.rows.filter((r) => r.verdict !== 'passed');
  const words = {
    passed: 'passed',
    deviates: 'deviate as explained',
    'not applicable': 'not applicable',
    broken: 'broken'
  };
  const counts = Object.entries(words)
                     .filter(([verdict]) => truths.verdicts[verdict])
                     .map(([verdict, word]) => `${truths.verdicts[verdict]} ${word}`)
                     .join(', ');
  return section(
      'truths', 'Checked against theory',
      el('div', {className: 'card'},
         el('p', {},
            el('b', {},
               truths.verdicts.broken ? `${truths.verdicts.broken} broken. ` : 'None is broken. '),
            `${count(truths.truths, 'statement')}, `,
            `${count(truths.findings, 'number')} compared: ${counts}.`),
         apart.length ? part('Where a solver differs, and why', apart, apart.length <= 6) : null,
         part('Each statement, with the number nearest to its tolerance', truths.rows, false)));
}

function regressionSection() {
  const found = model.regressions;
  if (!found) return null;
  const rows = (found.rows ?? []).map((r) => row(r.case, r.study, r.change));
  const result =
      rows.length ? `${count(rows.length, 'differs', 'differ')}.` : 'none left its tolerance.';
  return section(
      'regressions', 'Regressions',
      el('div', {className: 'card'},
         el('p', {}, `${count(found.values, 'value')} of ${count(found.cases, 'case')} `,
            `compared with the committed baselines: ${result}`),
         rows.length ? tableOf('Regressions', ['case', 'study', 'change'], rows) : null));
}

function methodSection() {
  const {method, missing, left_out: leftOut} = model;
  const refused = ({reason, scenes: on}) => el('div', {}, `${on.join(', ')}: ${reason}`);
  const solver = (s) =>
      row(named(s.id), s.summary, s.source, s.settings || '–', s.unsupported?.map(refused) ?? '–');
  const study = (s) => item(
      el('b', {}, s.name), `: ${s.question} `,
      el('span', {className: 'note'},
         `(${s.cases}${s.cases < s.planned ? ` of ${s.planned}` : ''} cases)`),
      s.unequal && el('p', {}, s.unequal));
  const glossary = Object.values(model.metrics)
                       .filter((m) => m.help)
                       .map((m) => row(m.title, m.help, m.unit, m.window));
  const known = (method.facts ?? []).map(({name}) => name);
  const build = Object.entries(model.meta.build ?? {})
                    .filter(([name]) => !known.includes(name))
                    .map(([name, value]) => ({name, value}));
  return section(
      'method', 'Method and limits',
      el('div', {className: 'card'},
         folded(
             'Solvers',
             tableOf(
                 'Solvers', ['solver', 'what it is', 'source', 'settings compared', 'cannot run'],
                 model.solvers.map(solver))),
         method.studies?.length ? el('ul', {}, method.studies.map(study)) : null,
         el('p', {}, 'This makes it all again:'), command(model.meta.command)),
      all(method.tables, tables).map(foldedTable),
      folded(
          'Metrics, build and machine',
          tableOf('Metrics', ['metric', 'definition', 'unit', 'window'], glossary),
          factList([...(method.facts ?? []), ...build])),
      list('What this does not show', method.limits?.map((text) => item(text))),
      list(
          'What was not made',
          missing?.map((m) => item(m.text, m.command && [' ', el('code', {}, m.command)]))),
      list('Left out', leftOut?.map((f) => item(el('code', {}, f.file), `: ${f.why}`))));
}
