'use strict';
// Stability maps: how cases end over two settings, as a table with a glyph in every cell.

/** Key of the statuses in `used`, with their glyphs. */
function statusKey(used) {
  const entry = ({id, title, help}) =>
      item(glyphBox(id), el('span', {}, [title, help].filter(Boolean).join(': ')));
  return el('ul', {className: 'key'}, model.statuses.filter(({id}) => used.has(id)).map(entry));
}

/** A glyph on the colour of its status. */
function glyphBox(id) {
  const i = statusIndex(id);
  return el(
      'span', {className: 'glyph-box', style: `background:var(--c${i});color:var(--i${i})`},
      statusOf(id).glyph);
}

const shadeOf = (value) => model.shades.find(({end}) => end === null || value <= end);
const shaded = ({share}) =>
    `background:color-mix(in srgb, var(--c${statusIndex('ok')}) ${100 * share}%, var(--card));` +
    (share < 1 ? 'color:var(--ink)' : '');
/** Key of the shades, if any cell has one. */
function shadeKey(cells) {
  if (cells.every(({value}) => value === undefined)) return null;
  const box = (shade) =>
      el('span', {className: 'glyph-box', style: shaded(shade) + ';border:1px solid var(--line)'});
  const entry = (shade) => item(box(shade), el('span', {}, shade.text));
  return el('ul', {className: 'key'}, model.shades.map(entry));
}

function mapCell(map, cell, row, column) {
  if (!cell)
    return el(
        'td', {}, el('span', {className: 'absent', 'aria-label': 'left out by the study'}, '·'));
  const i = statusIndex(cell.status), known = cases.has(cell.case);
  const button =
      el('button', {
        type: 'button',
        className: 'cell',
        tabIndex: -1,
        'data-group': row,
        style: `--c:var(--c${i});--i:var(--i${i});` +
            (cell.value === undefined ? '' : shaded(shadeOf(cell.value)))
      },
         statusOf(cell.status).glyph);
  if (known)
    button.onclick = () => state.set({case: cell.case});
  else
    button.setAttribute('aria-disabled', true);
  const at = (axis, place) => `${axis.title} ${shown(axis.values[place], axis, 4)}`;
  const settings = `${at(map.x, column)}, ${at(map.y, row)}`;
  const error = cell.value === undefined ? [] : [`RMS stretch ${number(100 * cell.value)}\u00A0%`];
  describe(
      button,
      [`${map.label}: ${settings}`, ...error, ...caseLines(cell.status, cell.reason, cell.case)]);
  return el('td', {}, button);
}

function mapFigure(map) {
  const at = new Map(map.cells.map((cell) => [`${cell.row} ${cell.column}`, cell]));
  const texts = (axis) => axis.texts ?? axis.values.map((v) => number(v * axis.scale));
  const rows = d3.range(map.y.values.length).reverse();
  const table =
      el('table', {className: 'map'}, el('caption', {}, count(map.cells.length, 'case')),
         el('thead', {},
            el('tr', {}, el('th', {scope: 'col', className: 'corner'}, `${titled(map.y)} ↑`),
               texts(map.x).map((text) => el('th', {scope: 'col'}, text)))),
         el('tbody', {},
            rows.map(
                (row) => el(
                    'tr', {}, el('th', {scope: 'row'}, texts(map.y)[row]),
                    map.x.values.map(
                        (_, column) => mapCell(map, at.get(`${row} ${column}`), row, column))))));
  const box = el('div', {className: 'scroll'}, table);
  rove(table, '.cell');
  return el(
      'figure',
      {className: 'card chart', id: `map-${map.id}`, 'data-s': solverOf(map.solver).order},
      el('figcaption', {}, el('h4', {}, named(map.solver)),
         el('p', {className: 'note'}, solverOf(map.solver).title === map.label ? '' : map.label)),
      box, el('div', {className: 'x-title'}, `${titled(map.x)} →`));
}

/** All maps of a scene. Those of one study are side by side under their question. */
function mapsOf(scene) {
  const shown = all(scene.maps, maps);
  if (!shown.length) return null;
  const used = new Set(shown.flatMap((map) => map.cells.map((cell) => cell.status)));
  return el(
      'section', {className: 'part'}, el('h3', {}, 'Stability'), statusKey(used),
      shadeKey(shown.flatMap((map) => map.cells)),
      d3.nest()
          .key((map) => map.study + '\n' + map.title)
          .entries(shown)
          .map(
              ({values}) =>
                  [el('h4', {}, short(values[0].title, 140), ' ',
                      el('small', {}, `study ${short(values[0].study, 40)}`,
                         values[0].scene_settings && `: ${short(values[0].scene_settings, 100)}`)),
                   el('div', {className: 'grid three'}, values.map(mapFigure))]));
}
