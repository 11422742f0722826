'use strict';
// The answer on the first screen: sentences and tiles. What each rests on, its basis, shows at the pointer, at the
// focus and in print.

/** A solver's mark: its colour and its marker, so that hue is not the only carrier. */
function mark(id) {
  const svg = d3.create('svg').attr('class', 'mark').attr('viewBox', '-7 -7 14 14').attr('aria-hidden', 'true');
  svg.append('path').attr('d', markerPath(solverOf(id).marker, 60)).style('fill', solverColour(id));
  return svg.node();
}
const named = (id) => el('span', {className: 'solver'}, mark(id), short(solverOf(id).title, 40));

/** A link that opens a case. */
function caseLink(key, ...text) {
  if (!cases.has(key)) return el('span', {}, ...text);
  return choice({case: key}, {className: 'to-case', title: short(cases.get(key).id, 160)}, ...text);
}

/** A text in which "1 × 16" is not broken over two lines. */
const unbroken = (text) => text.split(/(\d+ × \d+)/)
    .map((part, i) => i % 2 ? el('span', {className: 'work'}, part) : part);

/** The sentence with its strong parts and its solvers marked. */
function sentence({sentence: text, strong}) {
  const marked = [...(strong ?? []).map((part) => ({part, make: () => el('b', {}, part)})),
    ...[...solvers.values()].map(({id, title}) => ({part: title,
      make: () => el('span', {className: 'solver', style: `color:${solverColour(id)}`}, title)}))]
      .filter(({part}) => part).sort((a, b) => b.part.length - a.part.length);
  const nodes = [];
  let plain = '';
  for (let at = 0; at < text.length;) {
    const found = marked.find(({part}) => text.startsWith(part, at));
    if (found) nodes.push(unbroken(plain), found.make());
    plain = found ? '' : plain + text[at];
    at += found ? found.part.length : 1;
  }
  return [...nodes, unbroken(plain)];
}

/** Entries of an object by solver, in the order of the solvers. */
const bySolver = (counts) => Object.entries(counts).sort(([a], [b]) => solverOf(a).order - solverOf(b).order);

/** One number that went in: a failure says so instead of a value. */
function evidenceValue(value, quantity) {
  const text = value.value === null ? statusOf(value.status).title : value.text ?? shown(value.value, quantity);
  const spread = interval(value.low, value.high, quantity);
  return el('span', {className: 'value'}, mark(value.solver), caseLink(value.case, text),
            spread && ` (${spread})`, value.value !== null && value.n > 1 && ` n\u00A0=\u00A0${value.n}`,
            value.value !== null && value.status !== 'ok' && `, ${statusOf(value.status).title}`);
}

function evidence(entry) {
  const quantity = metric(entry.metric), group = d3.nest().key((value) => value.scene).entries(entry.values ?? []);
  const statusText = bySolver(entry.statuses ?? {}).map(([solver, counts]) =>
    `${solverOf(solver).title}: ${Object.entries(counts).map(([s, n]) => `${n} ${statusOf(s).title}`).join(', ')}`);
  const rows = [
    ['metric', [quantity.title, entry.window && `, ${entry.window}`, quantity.help && `: ${quantity.help}`]],
    ['rule', [entry.rule]],
    ['settings', (entry.settings ?? []).map(({solver, text}) => el('div', {}, named(solver), ' ', text))],
    ...group.map(({key, values}) => [key || 'values', values.map((value) => evidenceValue(value, quantity))]),
    ['cases looked at', [...statusText, entry.unlisted && `${entry.unlisted} further values are not listed`]
      .filter(Boolean).map((line) => el('div', {}, line))],
    ['left out', [entry.left_out]],
  ];
  return rows.filter(([, content]) => content.some(Boolean))
      .flatMap(([name, content]) => [el('dt', {}, short(name, 40)), el('dd', {}, content)]);
}

function basis(claim) {
  const policy = model.meta.policy?.[claim.sure];
  return el('div', {className: 'basis', id: `basis-${claim.id}`},
            el('dl', {}, claim.basis.map(evidence), el('dt', {}, 'how sure'),
               el('dd', {}, claim.sure, policy && `: ${policy}`)));
}

/** Escape puts a basis away until the pointer or the focus comes again. */
function dismissable(node) {
  node.addEventListener('keydown', (event) => { if (event.key === 'Escape') node.classList.add('quiet'); });
  for (const event of ['pointerleave', 'focusout']) node.addEventListener(event, () => node.classList.remove('quiet'));
  return node;
}

const sureness = (claim) => el('button', {type: 'button', className: 'sure', 'data-sure': claim.sure,
  'aria-describedby': `basis-${claim.id}`, 'aria-label': `${claim.sure}: basis`}, claim.sure);

function claimNode(claim) {
  const film = films.get(claim.film);
  return dismissable(el('div', {className: `claim ${claim.kind}`, id: `claim-${claim.id}`},
    el('p', {}, sentence(claim), ' ', sureness(claim),
       film && [' ', choice({scene: film.scene, at: 'film'}, {className: 'film-link'}, `film of ${short(film.scene, 40)}`)],
       claim.film_note && el('small', {}, ' ', unbroken(claim.film_note))),
    basis(claim)));
}

/** A tile: a bar for each solver and the sentence that judges them. */
function tileNode(claim) {
  const quantity = metric(claim.metric), bars = claim.bars ?? [];
  const largest = d3.max(bars, (bar) => bar.value ?? 0) || 1;
  const said = claims.has(claim.id.replace(/^tile-/, '')) && claim.id.startsWith('tile-');
  return dismissable(el('article', {className: `claim tile ${said ? 'said' : ''}`, id: `claim-${claim.id}`},
    el('h2', {}, claim.heading ?? quantity.title),
    el('ul', {}, bars.map((bar) => el('li', {},
      named(bar.solver), el('span', {className: 'amount'}, bar.text ?? shown(bar.value, quantity)),
      el('span', {className: 'bar', 'aria-hidden': 'true'},
         el('i', {style: `width:${100 * (bar.value ?? 0) / largest}%;background:${solverColour(bar.solver)}`}))))),
    el('p', {}, sentence(claim), ' ', sureness(claim),
       said && el('span', {className: 'print-only'}, 'It rests on what its sentence above does.')), basis(claim)));
}

/** All claims of a kind about something; those named are left out. */
const claimsAbout = (kinds, about) => model.claims.filter((c) => kinds.includes(c.kind) && about.includes(c.about));
const placed = new Set();

/** Claims that are not on the page yet, each once. */
function claimList(list) {
  const fresh = list.filter(({id}) => !placed.has(id) && placed.add(id));
  return fresh.length ? el('div', {className: 'claims'}, fresh.map(claimNode)) : null;
}

/** The first screen: the question, the headlines, the tiles, and what else is to be known. */
function answerSection() {
  const {meta} = model, of = meta.cases < meta.planned ? ` of ${meta.planned}` : '';
  return el('section', {id: 'answer'},
    note(el('b', {}, 'taut'), ' report · ',
         [`${meta.cases}${of} cases`, meta.preset, meta.made, meta.machine].filter(Boolean).join(' · ')),
    el('h1', {}, meta.question || meta.title), meta.question && note(meta.title),
    claimList(model.claims.filter((claim) => claim.kind === 'headline')),
    el('div', {className: 'tiles'}, model.claims.filter((claim) => claim.kind === 'tile').map(tileNode)),
    claimList(claimsAbout(['note'], ['all', 'only', 'failures'])));
}
