'use strict';
// The page from top to bottom, its contents, one scene at a time, and printing.

/** A cell of a table of the model. */
function tableCell(cell, head) {
  const it = typeof cell === 'object' && cell !== null ? cell : {text: String(cell)};
  return el(head ? 'th' : 'td', {scope: head ? 'row' : undefined}, it.case ? caseLink(it.case, it.text) : it.text,
            it.note && el('small', {}, ' ', it.note), it.sure && el('small', {className: 'sure', 'data-sure': it.sure}, it.sure));
}

const scrolled = (label, table) => el('div', {className: 'scroll', tabIndex: 0, role: 'region', 'aria-label': short(label)}, table);

function plainTable(title, columns, rows) {
  return el('table', {}, el('caption', {className: 'hidden'}, short(title, 120)),
    el('thead', {}, el('tr', {}, columns.map((text) => el('th', {scope: 'col'}, text)))), el('tbody', {}, rows));
}

function tableNode(table, heading = 'h4') {
  const rows = table.rows.map((row) => el('tr', {}, row.map((cell, i) => tableCell(cell, i === 0))));
  return el('div', {className: 'card', id: `table-${table.id}`}, el(heading, {}, short(table.title, 120)),
            el('p', {className: 'note'}, table.caption), scrolled(`${table.title} (${table.id})`, plainTable(table.title, table.columns.map((c) => c.title), rows)));
}

const section = (id, title, ...content) => el('section', {id}, el('h2', {}, title), content);
const figureOf = (chart) => chart.kind === 'series' ? seriesFigure(chart) : chartFigure(chart);
const factList = (facts) => facts?.length
  ? el('dl', {className: 'facts'}, facts.map(({name, value}) => [el('dt', {}, name), el('dd', {}, value)])) : null;

function answer() {
  const {meta} = model, told = ['headline', 'tile'];
  const besides = model.claims.filter((c) => !told.includes(c.kind) && ['all', 'only', 'failures'].includes(c.about));
  return el('section', {id: 'answer'},
    el('p', {className: 'note'}, el('b', {}, 'taut'), ` report · ${meta.cases < meta.planned ? `${meta.cases} of ${meta.planned}` : meta.cases} cases`,
      meta.preset && ` · ${meta.preset}`, ` · ${meta.made}`, meta.machine && ` · ${meta.machine}`),
    el('h1', {}, meta.question || meta.title), meta.question && el('p', {className: 'note'}, meta.title),
    claimList(model.claims.filter((c) => c.kind === 'headline')),
    el('div', {className: 'tiles'}, model.claims.filter((c) => c.kind === 'tile').map(tileNode)),
    claimList(besides));
}

function fairness({caption, columns, rows}) {
  const cells = rows.map((row) => el('tr', {className: row.differs ? 'differs' : ''},
    el('th', {scope: 'row'}, row.name, row.differs && el('span', {className: 'differ', title: 'differs'}, ' ≠')),
    row.values.map((value) => el('td', {}, value))));
  const heads = ['setting', ...columns.map((c) => [named(c.solver), ' ', caseLink(c.case, short(c.text, 60))])];
  return el('details', {className: 'card'}, el('summary', {}, caption), el('p', {className: 'note'}, 'Rows marked ≠ differ between solvers.'),
            scrolled(caption, plainTable(caption, heads, cells)));
}

function material({aspect, rows}) {
  const still = (solver) => ({t, text, image}) => el('figure', {}, el('img', {src: image, style: `aspect-ratio:${Number(aspect) || 1}`,
    alt: `${solverOf(solver).title}: strain of the sheet laid flat at ${number(t)} s, ${text} RMS`}),
    el('figcaption', {}, el('span', {}, `${number(t)} s`), el('b', {}, text)));
  return el('details', {className: 'card material'}, el('summary', {}, 'Strain in material space'),
    el('p', {className: 'note'}, 'The sheet laid flat, unlit, in the colours of the film; the number is the RMS strain.'),
    rows.map(({solver, moments}) => el('div', {className: 'stills', 'data-s': solverOf(solver).order}, el('div', {}, named(solver)), moments.map(still(solver)))));
}

/** How the cases of a scene ended, solver by solver. */
const ends = (counts) => counts && el('ul', {className: 'key'}, Object.entries(counts).map(([solver, byStatus]) =>
  el('li', {'data-s': solverOf(solver).order}, named(solver), Object.entries(byStatus).map(([status, n]) =>
    el('span', {}, ' ', glyphBox(status), ` ${n} ${short(statusOf(status).title, 30)}`)))));

function scenePart(scene) {
  const priced = model.cost?.scenes.find((entry) => entry.scene === scene.id);
  const list = all(scene.films, films), figures = all(scene.charts, charts);
  const costs = all(priced?.charts, charts).filter((c) => !figures.includes(c)), missing = list.some((film) => film.src) ? '' :
    `No film of ${short(scene.title)} was rendered`;
  return el('article', {className: 'scene', 'aria-label': short(scene.title)},
    el('h3', {className: 'scene-title'}, scene.title), el('p', {}, scene.summary),
    scene.studied === false && el('p', {className: 'note'}, 'No study of this report runs this scene: it is shown, not compared.'),
    ends(scene.statuses), claimList([...all(scene.claims, claims), ...claimsAbout(['note'], [scene.id])]
      .filter((claim) => !figures.some((chart) => chart.claims?.includes(claim.id)))),
    (scene.refusals ?? []).map(({solver, reason}) => el('p', {}, named(solver), ` cannot run this scene: ${reason}.`)),
    list.length ? player(scene, list) : null,
    missing && el('p', {className: 'note'}, missing, list.length ? '.' : ['; this renders one: ', el('code', {}, `taut render ${scene.id} --video`)]),
    scene.material && material(scene.material),
    figures.length ? el('div', {className: 'grid'}, figures.map(figureOf)) : null,
    mapsOf(scene),
    priced && el('section', {className: 'part'}, el('h3', {}, `What accuracy costs on ${short(scene.title)}`),
      el('p', {className: 'note'}, `Timing noise: ${priced.noise}. `, priced.noisy && el('b', {}, 'Too noisy to judge.')),
      el('div', {className: 'grid'}, costs.map(figureOf), all(priced.tables, tables).map((table) => tableNode(table)))),
    scene.fairness && fairness(scene.fairness), factList(scene.facts) && el('details', {className: 'card'},
      el('summary', {}, 'The scene in numbers'), factList(scene.facts)));
}

/** One scene at a time on screen; each is built when it is first shown, all of them for print. */
function sceneSection() {
  if (!model.scenes?.length) return null;
  const links = model.scenes.map((scene) => choice({scene: scene.id}, {title: scene.title}, short(scene.title, 30)));
  const boxes = model.scenes.map(() => el('div', {hidden: true})), built = new Set();
  const build = (i) => {
    if (!built.has(i)) boxes[i].append(scenePart(model.scenes[i]));
    built.add(i);
  };
  const current = () => Math.max(0, model.scenes.findIndex((scene) => scene.id === state.get('scene')));
  const show = () => {
    if (document.body.classList.contains('printing')) return;
    const now = current();
    boxes.forEach((box, i) => { box.hidden = i !== now; });
    build(now);
    links.forEach((link, i) => {
      if (i === now) link.setAttribute('aria-current', 'true');
      else link.removeAttribute('aria-current');
    });
    for (const video of document.querySelectorAll('[hidden] video')) video.pause();
  };
  state.watch(show);
  sceneSection.showAll = () => boxes.forEach((box, i) => { box.hidden = false; build(i); });
  sceneSection.showOne = show;
  const chips = el('nav', {className: 'chips', 'aria-label': 'Scenes', onkeydown: (event) => {
    const by = {ArrowLeft: -1, ArrowRight: 1}[event.key], at = links.indexOf(document.activeElement);
    if (by && links[at + by]) { links[at + by].focus(); links[at + by].click(); }
  }}, links);
  return section('scenes', model.scenes.length > 1 ? 'Scene by scene' : 'The scene', chips, boxes);
}

function costSection() {
  if (!model.cost) return null;
  return section('cost', 'What accuracy costs', el('p', {className: 'note'}, `CPU time on ${model.cost.machine}; the charts stand with their scenes.`),
    claimList(all(model.cost.claims, claims).filter((c) => c.kind === 'note')), all(model.cost.tables, tables).map((table) => tableNode(table, 'h3')));
}

function truthsSection() {
  const {truths} = model;
  if (!truths) return null;
  const apart = truths.rows.filter((row) => row.verdict !== 'passed');
  const row = (r) => el('tr', {}, el('th', {scope: 'row'}, r.statement, el('small', {}, ` ${r.source}`)), el('td', {}, r.subject),
    el('td', {}, r.expected), el('td', {}, r.measured), el('td', {}, r.verdict, r.why && `: ${r.why}`));
  const table = (title, rows) => scrolled(title, plainTable(title, ['closed form or published number', 'solver', 'expected', 'measured', 'verdict'], rows.map(row)));
  const counts = Object.entries(truths.verdicts).map(([verdict, n]) => `${n} ${verdict}`).join(', ');
  return section('truths', 'Checked against theory', el('div', {className: 'card'},
    el('p', {}, el('b', {}, truths.verdicts.broken ? `${truths.verdicts.broken} broken. ` : 'None is broken. '),
       `${count(truths.truths, 'statement')}, ${count(truths.findings, 'number')} compared: ${counts}.`),
    apart.length ? el('details', {open: apart.length <= 6}, el('summary', {}, `where a solver differs, and why (${apart.length})`), table('Differs', apart)) : null,
    el('details', {}, el('summary', {}, `each statement, with the number nearest to its tolerance (${truths.rows.length})`), table('All statements', truths.rows))));
}

function regressionSection() {
  const found = model.regressions;
  if (!found) return null;
  const rows = (found.rows ?? []).map((r) => el('tr', {}, el('th', {scope: 'row'}, r.case), el('td', {}, r.study), el('td', {}, r.change)));
  return section('regressions', 'Regressions', el('div', {className: 'card'},
    el('p', {}, `${count(found.values, 'value')} of ${count(found.cases, 'case')} compared with the committed baselines: `,
       rows.length ? `${count(rows.length, 'differs', 'differ')}.` : 'none left its tolerance.'),
    rows.length ? scrolled('Regressions', plainTable('Regressions', ['case', 'study', 'change'], rows)) : null));
}

function differencesSection() {
  const both = model.differences;
  if (!both) return null;
  return section('differences', 'What differs', el('p', {className: 'note'}, `A: ${both.a}; B: ${both.b}`),
                 claimList(all(both.claims, claims)), all(both.tables, tables).map((table) => tableNode(table, 'h3')));
}

function methodSection() {
  const {method, missing, left_out: leftOut} = model;
  const solver = (s) => el('tr', {}, el('th', {scope: 'row'}, named(s.id)), el('td', {}, s.summary), el('td', {}, s.source), el('td', {}, s.settings),
    el('td', {}, s.unsupported ? s.unsupported.map(({reason, scenes: on}) => el('div', {}, `${on.join(', ')}: ${reason}`)) : '–'));
  const study = (s) => el('li', {}, el('b', {}, s.name), `: ${s.question} `, el('span', {className: 'note'},
    `(${s.cases < s.planned ? `${s.cases} of ${s.planned}` : s.cases} cases)`), s.unequal && el('p', {}, s.unequal));
  return section('method', 'Method and limits', el('div', {className: 'card'},
    scrolled('Solvers', plainTable('Solvers', ['solver', 'what it is', 'source', 'settings compared', 'cannot run'], model.solvers.map(solver))),
    method.studies?.length ? el('ul', {}, method.studies.map(study)) : null,
    el('p', {}, 'This makes it all again:'), command(model.meta.command)),
    el('details', {className: 'card'}, el('summary', {}, 'Metrics, build and machine'),
      scrolled('Metrics', plainTable('Metrics', ['metric', 'definition', 'unit', 'window'], Object.values(model.metrics).filter((m) => m.help).map((m) =>
        el('tr', {}, el('th', {scope: 'row'}, m.title), el('td', {}, m.help), el('td', {}, m.unit), el('td', {}, m.window))))),
      factList([...(method.facts ?? []), ...Object.entries(model.meta.build ?? {}).map(([name, value]) => ({name, value}))])),
    method.limits?.length ? [el('h3', {}, 'What this does not show'), el('ul', {}, method.limits.map((text) => el('li', {}, text)))] : null,
    missing?.length ? [el('h3', {}, 'What was not made'), el('ul', {}, missing.map((m) => el('li', {}, m.text, m.command && [' ', el('code', {}, m.command)])))] : null,
    leftOut?.length ? [el('h3', {}, 'Left out'), el('ul', {}, leftOut.map((f) => el('li', {}, el('code', {}, f.file), `: ${f.why}`)))] : null);
}

/** The contents, which stay in sight, and the solvers' switches. */
function contents(sections) {
  const links = sections.map((part) => choice({at: part.id}, {}, part.id === 'answer' ? 'Answer' : part.querySelector('h2').textContent));
  const seen = new IntersectionObserver(() => {
    const now = sections.findLastIndex((part) => part.getBoundingClientRect().top < 140);
    links.forEach((link, i) => link.classList.toggle('here', i === Math.max(0, now)));
  }, {rootMargin: '-130px 0px -50% 0px', threshold: d3.range(0, 1.01, 0.05)});
  for (const part of sections) seen.observe(part);
  const flip = (id) => {
    const off = state.params().getAll('off');
    state.set({off: off.includes(id) ? off.filter((other) => other !== id) : [...off, id]}, false);
  };
  const switches = [...solvers.values()].map(({id}) => el('button', {type: 'button', className: 'switch', onclick: () => flip(id)}, named(id)));
  state.watch(() => [...solvers.keys()].forEach((id, i) => switches[i].setAttribute('aria-pressed', !isOff(id))));
  document.getElementById('contents').append(el('ul', {}, links.map((link) => el('li', {}, link))),
    switches.length > 1 ? el('div', {className: 'switches', role: 'group', 'aria-label': 'Solvers shown'}, switches) : '');
}

/** All scenes and folded parts for paper; afterwards as it was. */
function watchPrinting() {
  let folded = [];
  const begin = () => {
    if (document.body.classList.contains('printing')) return;
    document.body.classList.add('printing');
    sceneSection.showAll?.();
    folded = [...document.querySelectorAll('main details:not([open])')];
    for (const part of folded) part.open = true;
    for (const {svg, zoom} of drawn) if (zoom) svg.call(zoom.transform, d3.zoomIdentity);
    for (const {draw} of drawn) draw(330);
  };
  const end = () => {
    document.body.classList.remove('printing');
    for (const part of folded) part.open = false;
    sceneSection.showOne?.();
    for (const {draw, plot} of drawn) draw(plot.clientWidth);
  };
  addEventListener('beforeprint', begin);
  addEventListener('afterprint', end);
  matchMedia('print').addEventListener('change', (event) => (event.matches ? begin : end)());
}

/** A section, a claim or a chart by its id, or the part of that name of the scene shown ("film"). */
const placeOf = (id) => document.getElementById(id) ??
  [...document.querySelectorAll(`[data-at="${CSS.escape(id)}"]`)].find((node) => node.checkVisibility());

function start() {
  paint();
  const sections = [answer(), differencesSection(), sceneSection(), costSection(), truthsSection(), regressionSection(),
                    casesSection(), methodSection()].filter(Boolean);
  const main = document.getElementById('main');
  main.append(...sections);
  contents(sections);
  watchCase();
  watchPrinting();
  let at = null, scene = null;
  state.watch(() => {
    const wanted = state.section(), now = state.get('scene');
    if (wanted && (wanted !== at || now !== scene)) placeOf(wanted)?.scrollIntoView();
    [at, scene] = [wanted, now];
  });
  state.tell();
}
start();
