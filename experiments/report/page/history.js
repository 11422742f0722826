'use strict';
// History from build to build: a line for each case with a mark at each step; a click shows both
// builds of the step.

/**
 * A small curve over builds. A null interrupts it; equal values give a straight line in the middle.
 */
function sparkline({values, steps = []}, title) {
  const width = 260, height = 26, pad = 4, known = values.filter((v) => v !== null);
  let [low, high] = d3.extent(known);
  if (low === high) [low, high] = [low - 1, high + 1];
  const x = d3.scaleLinear([0, Math.max(1, values.length - 1)], [pad, width - pad]),
        y = d3.scaleLinear([low, high], [height - pad, pad]);
  const line = d3.line().x((_, i) => x(i)).y((v) => y(v)).defined((v) => v !== null);
  const svg = d3.create('svg')
                  .attr('class', 'sparkline')
                  .attr('viewBox', `0 0 ${width} ${height}`)
                  .attr('width', width)
                  .attr('height', height)
                  .attr('role', 'img')
                  .attr('aria-label', title);
  svg.append('path').attr('d', line(values)).attr('fill', 'none').attr('stroke', 'currentColor');
  for (const {at} of steps)
    svg.append('circle')
        .attr('cx', x(at))
        .attr('cy', values[at] === null ? height / 2 : y(values[at]))
        .attr('r', 3.5)
        .attr('class', 'stepped');
  return svg.node();
}

const shownSentences = 5;

/** Both builds of a step: how the case ended, and each value that changed. */
function stepDetails(step) {
  const link = ({key, case: of}) => of ? caseLink(of, key) : el('code', {}, key);
  const end = (one) => [one.status, one.key && [' ', link(one)]];
  return [
    el('p', {}, el('code', {}, step.before), ': ', end(step.cases[0]), '; ',
       el('code', {}, step.now), ': ', end(step.cases[1])),
    tableOf(
        `What changed at ${step.now}`, ['value', 'change'],
        step.values.map((v) => row(v.title, v.text)))
  ];
}

function historyStudy({study, metric: name, builds, rows, sentences, earlier}) {
  const quantity = metric(name), gaps = builds.filter((b) => b.gap);
  const day = ({made}) => made.slice(0, 10);
  const lines = rows.map((r) => {
    const known = r.values.filter((v) => v !== null), steps = r.steps ?? [];
    return row(
        [named(r.solver), ' ', r.id],
        sparkline(r, `${quantity.title} of ${r.id} over ${count(builds.length, 'build')}`),
        shown(known[0], quantity), shown(known.at(-1), quantity),
        steps.length ?
            steps.map(
                (s) =>
                    el('details', {className: 'step'}, el('summary', {}, s.now), stepDetails(s))) :
            '–');
  });
  return el(
      'div', {className: 'card', id: `history-${study}`}, el('h3', {}, study),
      note(
          `${count(builds.length, 'build')} from ${day(builds[0])} to ${day(builds.at(-1))}` +
          (earlier ? `, ${earlier} earlier ones are in the results file` : '') +
          (gaps.length ? `, ${count(gaps.length, 'gap')}` : '') + '.'),
      sentences?.length ?
          el('ul', {}, sentences.slice(0, shownSentences).map((text) => item(text))) :
          el('p', {}, 'No value stepped.'),
      sentences?.length > shownSentences ?
          el('details', {}, el('summary', {}, 'What else stepped'),
             el('ul', {}, sentences.slice(shownSentences).map((text) => item(text)))) :
          null,
      tableOf(
          `${quantity.title} from build to build`,
          ['case', titled(quantity), 'first', 'last', 'stepped at'], lines),
      gaps.length ? folded(
                        'Builds without results',
                        el('ul', {}, gaps.map((b) => item(el('code', {}, b.id), `: ${b.gap}`)))) :
                    null);
}

function historySection() {
  if (!model.history) return null;
  return section(
      'history', 'From build to build',
      note(
          'A value steps if it changes by more than the tolerance of ',
          el('code', {}, 'taut check'),
          '; a cost, if it changes by more than interval and control of two builds timed in turns. ',
          el('code', {}, 'taut history')),
      model.history.map(historyStudy));
}
