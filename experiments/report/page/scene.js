'use strict';
// Everything about one scene, and the choice of the scene that is shown.

/** How the cases of a scene ended, solver by solver. */
function ends(counts) {
  const part = ([status, n]) =>
      el('span', {}, ' ', glyphBox(status), ` ${n} ${short(statusOf(status).title, 30)}`);
  return counts &&
      el('ul', {className: 'key'},
         bySolver(counts).map(
             ([solver, byStatus]) =>
                 el('li', {'data-s': solverOf(solver).order}, named(solver),
                    Object.entries(byStatus).map(part))));
}

/**
 * The film of a scene or its picture. Without a film, also a note with the command that makes one.
 */
function filmOf(scene) {
  const film = films.get(scene.film), moves = film?.type?.startsWith('video/');
  const what = film ? 'The moment at which they differ most; this renders a film: ' :
                      `No film of ${short(scene.title)} was rendered; this renders one: `;
  return [
    film && player(scene, film),
    !moves && note(what, el('code', {}, `taut render ${scene.id} --video`))
  ];
}

function scenePart(scene) {
  const priced = model.cost?.scenes.find((entry) => entry.scene === scene.id);
  const series = all(scene.charts, charts).filter((chart) => chart.kind === 'series');
  const refusal = ({solver, reason}) =>
      el('p', {}, named(solver), ` cannot run this scene: ${reason}.`);
  return el(
      'article', {className: 'scene', 'aria-label': short(scene.title)},
      el('h3', {className: 'scene-title'}, scene.title), el('p', {}, scene.summary), filmOf(scene),
      scene.studied === false &&
          note('No study of this report runs this scene: it is shown, not compared.'),
      ends(scene.statuses), scene.refusals?.map(refusal),
      series.length ? el('div', {className: 'grid'}, series.map(seriesFigure)) : null,
      mapsOf(scene),
      priced &&
          el('section', {className: 'part'},
             el('h3', {}, `What accuracy costs on ${short(scene.title)}`),
             all(priced.tables, tables).map((table) => tableNode(table))),
      all(scene.tables, tables).map(foldedTable),
      scene.facts?.length ? folded('The scene in numbers', factList(scene.facts)) : null);
}

/**
 * Shows one of several parts, chosen by `key` in the address or by an element within the part that
 * the address requests. Each part is built when it is first shown; all are built for printing.
 */
function oneOf(key, parts, label) {
  const boxes = parts.map(() => el('div', {hidden: true})), built = new Set();
  const build = (i) => {
    if (!built.has(i)) boxes[i].append(...[parts[i].build()].flat());
    built.add(i);
  };
  const links = parts.map(({id, title}) => choice({[key]: id}, {title}, short(title, 60)));
  const showOne = () => {
    if (document.body.classList.contains('printing')) return;
    const chosen = parts.findIndex((part) => part.id === state.get(key));
    const now = Math.max(
        0, chosen < 0 ? parts.findIndex((part) => part.holds?.includes(state.get('at'))) : chosen);
    boxes.forEach((box, i) => {
      box.hidden = i !== now;
    });
    build(now);
    links.forEach((link, i) => {
      if (i === now)
        link.setAttribute('aria-current', 'true');
      else
        link.removeAttribute('aria-current');
    });
    for (const video of document.querySelectorAll('[hidden] video')) video.pause();
  };
  const showAll = () => boxes.forEach((box, i) => {
    box.hidden = false;
    build(i);
  });
  state.watch(showOne);
  oneOf.views.push({showOne, showAll, isPrinted: () => !boxes[0].closest('.unprinted')});
  const chips =
      el('nav', {
        className: 'chips',
        'aria-label': label,
        onkeydown: (event) => {
          const by = {ArrowLeft: -1, ArrowRight: 1}[event.key];
          const next = by && links[links.indexOf(document.activeElement) + by];
          if (next) {
            next.focus();
            next.click();
          }
        }
      },
         links);
  return [parts.length > 1 ? chips : '', boxes];
}
oneOf.views = [];

/**
 * Charts of all scenes together: for each quantity and what it is drawn over, a panel for each
 * scene on the same axes.
 */
function chartsSection() {
  const nameOf = (spec) => choice(
      {scene: spec.scene, at: 'scenes'}, {},
      short(scenes.get(spec.scene)?.title ?? spec.scene, 30));
  const shown = [...figuresOf('scenes'), ...model.winners ? [] : figuresOf('cost')];
  const quantityOf = (figure) => charts.get(figure.charts[0]).y;
  const parts =
      d3.nest()
          .key((figure) => quantityOf(figure).metric)
          .entries(shown)
          .map(({key, values}) => ({
                 id: key,
                 title: quantityOf(values[0]).title,
                 holds: values.flatMap((figure) => figure.charts.map((id) => `chart-${id}`)),
                 build: () => values.map((figure) => chartFigure(figure, nameOf))
               }));
  if (!parts.length) return null;
  return section(
      'charts', model.scenes?.length > 1 ? 'All scenes' : 'Charts',
      oneOf('chart', parts, 'Quantities'));
}

function sceneSection() {
  if (!model.scenes?.length) return null;
  return section(
      'scenes', model.scenes.length > 1 ? 'Scene by scene' : 'The scene',
      oneOf(
          'scene',
          model.scenes.map(
              (scene) => ({id: scene.id, title: scene.title, build: () => scenePart(scene)})),
          'Scenes'));
}
