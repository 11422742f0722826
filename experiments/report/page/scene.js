'use strict';
// What there is of one scene, and the scenes one at a time.

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
  return el('article', {className: 'scene', 'aria-label': short(scene.title)},
    el('h3', {className: 'scene-title'}, scene.title), el('p', {}, scene.summary),
    scene.studied === false && note('No study of this report runs this scene: it is shown, not compared.'),
    ends(scene.statuses),
    (scene.refusals ?? []).map(({solver, reason}) => el('p', {}, named(solver), ` cannot run this scene: ${reason}.`)),
    filmOf(scene),
    scene.material && material(scene.material),
    figures.length ? el('div', {className: 'grid'}, figures.map(figureOf)) : null,
    mapsOf(scene),
    priced && el('section', {className: 'part'}, el('h3', {}, `What accuracy costs on ${short(scene.title)}`),
      note(priced.noise, priced.noisy && el('b', {}, ' No difference here is called clear.')),
      el('div', {className: 'grid'}, costs.map(figureOf), all(priced.tables, tables).map((table) => tableNode(table)))),
    all(scene.tables, tables).map((table) => folded(table.title, note(table.caption),
      scrolling(`${table.title} (${table.name})`, tableHeads(table), table.rows.map((cells) => tableRow(table, cells))))),
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

/** The first error of every scene over its sweeps, on the same axes: which scenes differ, at one glance. */
function overview() {
  const error = model.charts?.find((chart) => chart.kind === 'convergence')?.y.metric;
  const shown = (model.charts ?? []).filter((chart) => chart.kind === 'convergence' && chart.y.metric === error);
  if (!shown.length) return null;
  const points = shown.flatMap((chart) => chart.series.flatMap((s) => s.points)), {x, y} = shown[0];
  const usable = (p) => !p.failed && p.y > 0;
  const [w, h] = [150, 92], good = points.filter(usable).map((p) => p.y * y.scale);
  const least = d3.max(good) / 1e4;  // rounding of a free fall would flatten the others
  const xs = scaleOf('log', points.map((p) => p.x * x.scale), [4, w - 4]);
  const ys = scaleOf('log', good.filter((v) => v >= least), [h - 4, 4]);
  const drawable = shown.filter((chart) => chart.series.some((s) => s.points.filter((p) => usable(p) && p.y * y.scale >= least).length > 1));
  if (drawable.length < 2) return null;
  const one = (chart) => {
    const svg = d3.create('svg').attr('viewBox', `0 0 ${w} ${h}`).attr('aria-hidden', 'true');
    for (const s of chart.series) {
      const group = svg.append('g').attr('data-s', solverOf(s.solver).order).style('color', solverColour(s.solver));
      const line = d3.line().defined((p) => usable(p) && p.y * y.scale >= least).x((p) => xs(p.x * x.scale)).y((p) => ys(p.y * y.scale));
      group.append('path').attr('class', 'line').style('stroke', 'currentColor').attr('stroke-dasharray', dashOf(s)).attr('d', line(s.points));
      for (const p of s.points.filter((point) => point.failed))
        group.append('text').attr('class', 'small').attr('x', xs(p.x * x.scale)).attr('y', 11).text(statusOf(p.status).glyph);
    }
    return choice({scene: chart.scene, at: 'scenes'}, {className: 'small-multiple'},
      el('span', {}, short(scenes.get(chart.scene)?.title ?? chart.scene, 24)), svg.node());
  };
  const ends = (scale, q) => scale.domain().map((v) => number(v, 2)).join(' to ') + (q.unit ? '\u00A0' + q.unit : '');
  return el('figure', {className: 'card overview'}, el('figcaption', {}, el('h3', {}, `${titled(y)} over ${x.title}`),
    note(`Each ${ends(ys, y)} upwards, ${ends(xs, x)} to the right, both logarithmic. A click shows the scene.`)),
    el('div', {className: 'multiples'}, drawable.map(one)));
}

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
  return section('scenes', model.scenes.length > 1 ? 'Scene by scene' : 'The scene', overview(), chips, sceneView.boxes);
}
