'use strict';
// What there is of one scene, and the scenes one at a time.

function resolvedSettings({caption, columns, rows}) {
  const who = ({solver, text}) => text.startsWith(solverOf(solver).title) ? mark(solver) : [named(solver), ' '];
  const heads = ['setting', ...columns.map((c) => [who(c), caseLink(c.case, short(c.text, 60))])];
  const line = ({name, differs, values}) => {
    const sign = differs && el('span', {className: 'differ', title: 'differs'}, ' ≠');
    const node = row([name, sign], ...values);
    node.classList.toggle('differs', differs);
    return node;
  };
  return folded(caption, note('Rows marked ≠ differ between solvers.'), tableOf(caption, heads, rows.map(line)));
}

function material({aspect, rows}) {
  const still = (solver) => ({t, text, image}) => {
    const alt = `${solverOf(solver).title}: strain of the sheet laid flat at ${number(t)} s, ${text} RMS`;
    return el('figure', {}, el('img', {src: image, alt, style: `aspect-ratio:${Number(aspect) || 1}`}),
      el('figcaption', {}, el('span', {}, `${number(t)} s`), el('b', {}, text)));
  };
  const stills = ({solver, moments}) => el('div', {className: 'stills', 'data-s': solverOf(solver).order},
    el('div', {}, named(solver)), moments.map(still(solver)));
  return folded('Strain in material space',
    note('The sheet laid flat, unlit, in the colours of the film; the number is the RMS strain.'), rows.map(stills));
}

/** How the cases of a scene ended, solver by solver. */
function ends(counts) {
  const part = ([status, n]) => el('span', {}, ' ', glyphBox(status), ` ${n} ${short(statusOf(status).title, 30)}`);
  return counts && el('ul', {className: 'key'}, bySolver(counts).map(([solver, byStatus]) =>
    el('li', {'data-s': solverOf(solver).order}, named(solver), Object.entries(byStatus).map(part))));
}

/** The film of a scene, or that there is none and what makes one. */
function filmOf(scene) {
  const list = all(scene.films, films), absent = `No film of ${short(scene.title)} was rendered`;
  if (!list.length) return note(absent, '; this renders one: ', el('code', {}, `taut render ${scene.id} --video`));
  return [player(scene, list), !list.some((film) => film.src) && note(absent, '.')];
}

const figureOf = (chart) => chart.kind === 'series' ? seriesFigure(chart) : chartFigure(chart);

function scenePart(scene) {
  const priced = model.cost?.scenes.find((entry) => entry.scene === scene.id);
  const figures = all(scene.charts, charts);
  const costs = all(priced?.charts, charts).filter((chart) => !figures.includes(chart));
  const claimsHere = [...all(scene.claims, claims), ...claimsAbout(['note'], [scene.id])];
  return el('article', {className: 'scene', 'aria-label': short(scene.title)},
    el('h3', {className: 'scene-title'}, scene.title), el('p', {}, scene.summary),
    scene.studied === false && note('No study of this report runs this scene: it is shown, not compared.'),
    ends(scene.statuses), claimList(claimsHere),
    (scene.refusals ?? []).map(({solver, reason}) => el('p', {}, named(solver), ` cannot run this scene: ${reason}.`)),
    filmOf(scene),
    scene.material && material(scene.material),
    figures.length ? el('div', {className: 'grid'}, figures.map(figureOf)) : null,
    mapsOf(scene),
    priced && el('section', {className: 'part'}, el('h3', {}, `What accuracy costs on ${short(scene.title)}`),
      note(priced.noise, priced.noisy && el('b', {}, ' No difference here is called clear.')),
      el('div', {className: 'grid'}, costs.map(figureOf), all(priced.tables, tables).map((table) => tableNode(table)))),
    scene.resolved_settings && resolvedSettings(scene.resolved_settings),
    scene.facts?.length ? folded('The scene in numbers', factList(scene.facts)) : null);
}

/** One scene at a time on screen; each is built when it is first shown, all of them for print. */
const sceneView = {
  boxes: [], built: new Set(), links: [],
  build(i) {
    if (!sceneView.built.has(i)) sceneView.boxes[i].append(scenePart(model.scenes[i]));
    sceneView.built.add(i);
  },
  showOne() {
    if (document.body.classList.contains('printing')) return;
    const now = Math.max(0, model.scenes.findIndex((scene) => scene.id === state.get('scene')));
    sceneView.boxes.forEach((box, i) => { box.hidden = i !== now; });
    sceneView.build(now);
    sceneView.links.forEach((link, i) => {
      if (i === now) link.setAttribute('aria-current', 'true');
      else link.removeAttribute('aria-current');
    });
    for (const video of document.querySelectorAll('[hidden] video')) video.pause();
  },
  showAll() {
    sceneView.boxes.forEach((box, i) => { box.hidden = false; sceneView.build(i); });
  },
};

function sceneSection() {
  if (!model.scenes?.length) return null;
  sceneView.boxes = model.scenes.map(() => el('div', {hidden: true}));
  sceneView.links = model.scenes.map(({id, title}) => choice({scene: id}, {title}, short(title, 30)));
  state.watch(sceneView.showOne);
  const chips = el('nav', {className: 'chips', 'aria-label': 'Scenes', onkeydown: (event) => {
    const by = {ArrowLeft: -1, ArrowRight: 1}[event.key];
    const next = by && sceneView.links[sceneView.links.indexOf(document.activeElement) + by];
    if (next) { next.focus(); next.click(); }
  }}, sceneView.links);
  return section('scenes', model.scenes.length > 1 ? 'Scene by scene' : 'The scene', chips, sceneView.boxes);
}
