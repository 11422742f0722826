'use strict';
// Charts of points over a setting or a cost: lines, error bars, failed cases above the plot, zeros
// on the axis.

/** A regular polygon; `first` is the direction of its first corner [rad]. */
const polygon = (corners, first) => ({
  draw(context, area) {
    const radius = Math.sqrt(2 * area / (corners * Math.sin(2 * Math.PI / corners)));
    for (const i of d3.range(corners)) {
      const angle = first + 2 * Math.PI * i / corners;
      context[i ? 'lineTo' : 'moveTo'](radius * Math.cos(angle), radius * Math.sin(angle));
    }
    context.closePath();
  }
});
const bar = (ratio) => ({
  draw(context, area) {
    const height = Math.sqrt(area / ratio), width = ratio * height;
    context.rect(-width / 2, -height / 2, width, height);
  }
});
const markers = {
  circle: d3.symbolCircle,
  square: d3.symbolSquare,
  triangle: d3.symbolTriangle,
  'triangle-down': polygon(3, Math.PI / 2),
  'triangle-left': polygon(3, Math.PI),
  'triangle-right': polygon(3, 0),
  diamond: d3.symbolDiamond,
  pentagon: polygon(5, -Math.PI / 2),
  hexagon: polygon(6, 0),
  star: d3.symbolStar,
  plus: d3.symbolCross,
  bar: bar(2.5),
  post: bar(0.4)
};
const markerPath = (name, size) => d3.symbol().type(markers[name] ?? d3.symbolCircle).size(size)();
const dashOf = ({solver, dash}) => dash ?? solverOf(solver).dash;

/**
 * Sizes in pixels: height of a chart alone and beside others, room above and below its plot, height
 * of a row of failed cases in each, and size of one of their glyphs.
 */
const box = {
  height: 250,
  small: 190,
  top: 10,
  bottom: 22,
  row: 13,
  smallRow: 9,
  glyph: 8
};

/** Scale for an axis of the model, in pixels. */
const scaleOf = ({axis, low, high}, range) =>
    (axis === 'log' ? d3.scaleLog() : d3.scaleLinear()).domain([low, high]).range(range);

/**
 * Readable ticks: the values of a study's setting, or as many of 1, 2 and 5 (or 1 and 3, or 1) of
 * each power of ten as fit; if there are many powers, not all of them.
 */
function ticksOf(scale, axis, kind, wanted) {
  const [low, high] = scale.domain(), inside = (v) => v >= low && v <= high;
  if (axis.values) return axis.values.map((v) => v * axis.scale).filter(inside);
  if (kind !== 'log') return scale.ticks(wanted);
  const decades = Math.log10(high / low);
  if (decades < 0.7) return d3.ticks(low, high, wanted);
  const factors = decades > 0.7 * wanted ? [1] : decades > 1.6 ? [1, 3] : [1, 2, 5];
  const by = Math.ceil(decades / (2 * wanted)), first = by * Math.floor(Math.log10(low) / by);
  return d3.range(first, Math.ceil(Math.log10(high)) + 1, by)
      .flatMap((power) => factors.map((f) => f * 10 ** power))
      .filter(inside);
}

/**
 * Removes texts that would overlap one kept before them or an obstacle. Their places are measured,
 * not estimated.
 */
function thin(texts, obstacles = []) {
  const taken = obstacles.map((node) => node.getBoundingClientRect());
  for (const text of texts) {
    const box = text.getBoundingClientRect();
    if (taken.some(
            (t) => box.left < t.right + 2 && box.right > t.left - 2 && box.top < t.bottom &&
                box.bottom > t.top))
      text.remove();
    else
      taken.push(box);
  }
}

function pointLines(spec, series, point) {
  const {x, y} = spec, costs = interval(point.x_low, point.x_high, x);
  const value = point.y === null || point.y === undefined ? 'no value' : shown(point.y, y, 4);
  return [
    `${series.label}${point.name ? `, ${point.name}` : ''}`, `${y.title}: ${value}`,
    `${x.title}: ${shown(point.x, x, 4)}${costs && ` (95 %: ${costs})`}`,
    point.not_counted && `does not count: ${point.not_counted}`,
    ...caseLines(point.status, undefined, point.case)
  ].filter(Boolean);
}

/** Calls `draw` when a plot gets its width and whenever the width changes, except for printing. */
function watchWidth(plot, draw) {
  new ResizeObserver(() => {
    if (!document.body.classList.contains('printing')) draw();
  }).observe(plot);
}

/** Charts on the page, which are drawn again for printing. */
const drawn = new Set();

/** A swatch for a key: a piece of the line with its marker. */
function swatch(series) {
  const svg = d3.create('svg')
                  .attr('class', 'swatch')
                  .attr('viewBox', '0 0 30 12')
                  .attr('aria-hidden', 'true');
  svg.append('line')
      .attr('x2', 30)
      .attr('y1', 6)
      .attr('y2', 6)
      .attr('stroke-width', 2)
      .style('stroke', series.colour ?? solverColour(series.solver))
      .attr('stroke-dasharray', series.dash ?? dashOf(series))
      .attr('class', series.className);
  if (series.solver)
    svg.append('path')
        .attr('transform', 'translate(15,6)')
        .attr('d', markerPath(solverOf(series.solver).marker, 45))
        .style('fill', solverColour(series.solver));
  return svg.node();
}

/**
 * The key of all panels. It omits what the solvers' switches of the page show; it has further
 * settings of a solver, lines of theory and, if they occur, the meanings of × above the plot, the
 * triangle and the hollow marker.
 */
function chartKey(specs, {kind, frame}) {
  const points = specs.flatMap(pointsOf), grey = (dash) => swatch({colour: 'var(--muted)', dash});
  const statusesOf =
      (which) => [...new Set(points.filter(which).map((p) => p.status))].map(statusOf);
  const failed = statusesOf((p) => p.failed),
        unfinished = statusesOf((p) => !p.failed && p.status !== 'ok');
  const entry = (sign, text, order) => el('li', {'data-s': order}, sign, el('span', {}, text));
  const once = (list, textOf) =>
      [...index(list.filter(Boolean).map((one) => ({...one, text: textOf(one)})), 'text').values()];
  const floored = points.filter((p) => onFloor(p, specs[0], frame));
  const list =
      el('ul', {className: 'key'},
         once(specs.flatMap((spec) => spec.series), (s) => s.label)
             .filter((s) => s.label !== solverOf(s.solver).title)
             .map((s) => entry(swatch(s), short(s.label, 60), solverOf(s.solver).order)),
         once(specs.map((spec) => spec.theory), ({text}) => text)
             .map(({text}) => entry(grey('4 3'), text)),
         once(specs.map((spec) => spec.floor), ({text}) => text)
             .map(({text}) => entry(grey('1 3'), text)),
         specs.some((spec) => spec.front) &&
             entry(
                 swatch({className: 'front', colour: 'var(--stair)', dash: ''}),
                 'no setting is better in both'),
         failed.map((s) => entry(el('b', {}, s.glyph), `above the plot: ${s.title}`)),
         floored.length > 0 &&
             entry(
                 el('b', {}, '▲'),
                 'on the axis: ' +
                     [
                       floored.some((p) => p.zero) && 'exactly zero',
                       floored.some((p) => !p.zero) &&
                           `below ${shown(frame.least / specs[0].y.scale, specs[0].y, 1)}`
                     ].filter(Boolean)
                         .join(', or ')),
         kind === 'log' && points.some((p) => p.y < 0) &&
             entry(
                 el('b', {}, '!'),
                 `${points.filter((p) => p.y < 0).length} below zero: linear scale only`),
         unfinished.length > 0 &&
             entry(el('b', {}, '○'), `hollow: ${unfinished.map((s) => s.title).join(', ')}`),
         points.some((p) => p.not_counted) &&
             entry(
                 el('b', {}, '○'),
                 'hollow: on no line, since it cannot be the cheapest ' +
                     '(is not where it should be, or does what its scene does not accept)'));
  return list.children.length ? list : '';
}

const pointsOf = (spec) => spec.series.flatMap((s) => s.points);
/**
 * Place of each failed case among those that failed near its x: [row, index from the left, number
 * in the row].
 */
function failedPlaces(spec, px) {
  const places = new Map(),
        columns = d3.nest()
                      .key(([p]) => Math.round(px(p.x) / (2 * box.glyph)))
                      .entries(spec.series.flatMap(
                          (s) => s.points.filter((p) => p.failed && Number.isFinite(px(p.x)))
                                     .map((p) => [p])));
  const xs = columns.map(({values}) => d3.mean(values, ([p]) => px(p.x))).sort(d3.ascending);
  const gap = d3.min(d3.pairs(xs), ([a, b]) => b - a) ?? 1e3,
        most = Math.max(1, Math.floor(gap / box.glyph));
  for (const {values} of columns)
    values.forEach(([p], i) => places.set(p, [
      Math.floor(i / most), i % most, Math.min(most, values.length - most * Math.floor(i / most))
    ]));
  return {places, rows: d3.max(columns, ({values}) => Math.ceil(values.length / most)) ?? 0};
}
const onFloor = (p, {y}, {y: {axis}, least}) =>
    axis === 'log' && !p.failed && (p.zero || (p.y > 0 && p.y * y.scale < least));

/**
 * A figure of the model: a panel for each chart, all on the same axes, with `nameOf` above each.
 * `inTurn`: one panel is shown at a time, as large as a chart alone.
 */
function chartFigure(figure, nameOf, inTurn = false) {
  const specs = all(figure.charts, charts), {x, y} = specs[0],
        common = (get) => specs.every((spec) => get(spec) === get(specs[0]));
  const held = (spec) => spec.held && spec.held[0].toUpperCase() + spec.held.slice(1) + '.',
        caption = (spec) => spec.caption;
  const remarks = (spec, shared) => [held, caption]
                                        .filter((get) => common(get) === shared)
                                        .map((get) => get(spec))
                                        .filter(Boolean);
  const height = specs.length > 1 && !inTurn ? box.small : box.height;
  const view = {kind: figure.axis, height, draws: []};
  const useFrame = () => {
    view.frame = figure[view.kind];
    view.failed = specs.some((spec) => pointsOf(spec).some((p) => p.failed));
    view.floored = specs.some((spec) => pointsOf(spec).some((p) => onFloor(p, spec, view.frame)));
  };
  useFrame();
  const key = el('div'), bar = el('div', {className: 'tools'});
  const keyOf = () => key.replaceChildren(chartKey(specs, view));
  if (figure.log) {
    const other = () => view.kind === 'log' ? 'linear' : 'log';
    const flip =
        el('button', {
          type: 'button',
          title: 'other vertical scale',
          onclick: () => {
            view.kind = other();
            useFrame();
            flip.textContent = other();
            keyOf();
            for (const draw of view.draws) draw();
          }
        },
           other());
    bar.append(flip);
  }
  keyOf();
  return el(
      'figure', {className: 'card chart'},
      el('figcaption', {}, el('h3', {}, short(figure.title, 120)), bar,
         note(remarks(specs[0], true).join(' '))),
      key, el('div', {className: 'y-title'}, titled(y)),
      el('div', {className: specs.length > 1 ? 'multiples' : ''},
         specs.map(
             (spec) => chartPanel(
                 spec, view, nameOf?.(spec),
                 [...remarks(spec, false), spec.thinned, ...(spec.same ?? [])]))),
      el('div', {className: 'x-title'}, titled(x)));
}

/** One panel of a figure. It is drawn when it gets a width, and again when the width changes. */
function chartPanel(spec, view, name, remarks) {
  const points = pointsOf(spec), said = remarks.filter(Boolean).map((text) => el('div', {}, text));
  const panel = (...content) =>
      el('div', {className: 'panel', id: `chart-${spec.id}`}, name && el('h4', {}, name), content,
         said.length ? el('small', {}, said) : null);
  if (points.length && points.every((p) => p.zero))
    return panel(el('p', {}, `Every value is exactly zero (${count(points.length, 'case')}).`));
  const plot = el('div', {className: 'plot', style: `min-height:${view.height}px`}),
        clip = `clip-${drawn.size}`;
  const svg = d3.select(plot)
                  .append('svg')
                  .attr('role', 'group')
                  .attr('aria-label', short(`${spec.title}, ${spec.scene}: points`, 160));
  const reset = rove(plot, '.point');
  const draw = (width) => {
    if (!width) return;
    const active = document.activeElement?.dataset?.place;
    drawChart(svg, spec, {...view, clip}, width);
    if (svg.node().contains(document.activeElement) || active !== undefined)
      svg.node().querySelector(`[data-place="${active}"]`)?.focus();
    reset();
  };
  const again = () => draw(plot.clientWidth);
  view.draws.push(again);
  watchWidth(plot, again);
  drawn.add({plot, draw});
  return panel(plot);
}

function drawChart(svg, spec, {kind, height, frame, failed, floored, clip}, width) {
  const {x, y} = spec, row = height === box.height ? box.row : box.smallRow;
  const rough = scaleOf(frame.x, [40, width - 12]);  // before the axes have their widths
  const failures = failedPlaces(spec, (v) => rough(v * x.scale));
  const strip = failed ? Math.max(1, failures.rows) * row + 6 : 0, base = height - box.bottom,
        floor = floored ? 12 : 0;
  const [yLow, yHigh] = [base - floor, box.top + strip];
  const ys = scaleOf(frame.y, [yLow, yHigh]);
  svg.attr('viewBox', `0 0 ${width} ${height}`).attr('width', width).attr('height', height);
  svg.selectAll('*').remove();
  const axisY = svg.append('g').attr('class', 'axis y');
  axisY.call(d3.axisLeft(ys)
                 .tickValues(ticksOf(ys, {...y, values: undefined}, kind, height / 50))
                 .tickFormat((v) => number(v))
                 .tickSize(0)
                 .tickPadding(6));
  const left = Math.ceil(axisY.node().getBBox().width) + 4;
  axisY.attr('transform', `translate(${left},0)`);
  const axisX = svg.append('g').attr('class', 'axis x').attr('transform', `translate(0,${base})`);
  const drawX = (margin) => {
    const scale = scaleOf(frame.x, [left + 8, width - margin]);
    axisX.call(d3.axisBottom(scale)
                   .tickValues(ticksOf(scale, x, frame.x.axis, width / 90))
                   .tickFormat((v) => number(v))
                   .tickSize(4)
                   .tickPadding(4));
    return scale;
  };
  let right = 12, xs = drawX(right);
  const end = (node) => node.getBoundingClientRect().right;
  const over = d3.max(axisX.selectAll('text').nodes(), end) - end(svg.node());
  if (over > 0) {
    right += Math.ceil(over);
    xs = drawX(right);
  }
  axisY.selectAll('.tick line').attr('x2', width - left - right);
  axisX.select('.domain').attr('d', `M${left},0H${width - right}`);
  thin(axisX.selectAll('text').nodes());
  svg.append('clipPath')
      .attr('id', clip)
      .append('rect')
      .attr('x', left)
      .attr('y', yHigh - 4)
      .attr('width', Math.max(0, width - left - right + 6))
      .attr('height', Math.max(0, yLow - yHigh + 8));
  const area = svg.append('g').attr('clip-path', `url(#${clip})`);
  const px = (v) => xs(v * x.scale), py = (v) => ys(v * y.scale);
  const usable = (p) => !p.failed && typeof p.y === 'number' &&
      (kind !== 'log' || p.y * y.scale >= frame.least && p.y > 0);
  const line = d3.line().defined(usable).x((p) => px(p.x)).y((p) => py(p.y));
  if (spec.front)
    area.append('path')
        .attr('class', 'front')
        .attr('d', line.curve(d3.curveStepAfter)(spec.front.filter(usable)));
  line.curve(d3.curveLinear);
  if (spec.theory && kind === frame.x.axis) {
    const ends = xs.domain().map((v) => v / x.scale);
    area.append('path')
        .attr('class', 'theory')
        .attr(
            'd',
            d3.line()(ends.map((v) => [px(v), py(spec.theory.factor * v ** spec.theory.slope)])));
  }
  if (spec.floor)
    area.append('path')
        .attr('class', 'floor')
        .attr('d', `M${left},${py(spec.floor.y)}H${width - right}`);
  spec.series.forEach((s, order) => {
    const solver = solverOf(s.solver), colour = solverColour(s.solver);
    const dodge = (order - (spec.series.length - 1) / 2) * Math.min(7, 30 / spec.series.length);
    const lines =
        area.append('g').attr('data-s', solver.order).style('stroke', colour).style('fill', 'none');
    if (s.join)
      lines.append('path')
          .attr('class', 'line')
          .attr('stroke-dasharray', dashOf(s))
          .attr('d', line(s.points));
    lines.append('path')
        .attr('class', 'error')
        .attr('d', s.points.filter(usable).map((p) => errorBar(p, px, py)).join(''));
    const group = svg.append('g').attr('data-s', solver.order).style('color', colour);
    s.points.forEach((p, i) => {
      const floored = onFloor(p, spec, frame), [line, at, of] = failures.places.get(p) ?? [0, 0, 1];
      const cx = px(p.x) + (floored ? dodge : p.failed ? (at - (of - 1) / 2) * box.glyph : 0);
      if (!Number.isFinite(cx) || (!p.failed && !floored && !usable(p))) return;
      const cy = p.failed ? box.top + 4 + line * row : floored ? base - 5 : py(p.y);
      drawPoint(group, {
        spec,
        series: s,
        point: p,
        place: `${order}-${i}`,
        order,
        cx,
        cy,
        floored,
        size: height === box.height ? 52 : 34
      });
    });
  });
  nameBest(svg, spec);
}

/** A bar for the 95 % interval of x, with caps. */
function errorBar(p, px, py) {
  const cy = py(p.y), cap = 3;
  if (typeof p.x_low !== 'number' || typeof p.x_high !== 'number') return '';
  return `M${px(p.x_low)},${cy}H${px(p.x_high)}` +
      [p.x_low, p.x_high].map((v) => `M${px(v)},${cy - cap}v${2 * cap}`).join('');
}

function drawPoint(group, {spec, series, point, place, order, cx, cy, floored, size}) {
  const known = cases.has(point.case);
  const g = group.append('g')
                .attr('class', 'point')
                .attr('transform', `translate(${cx},${cy})`)
                .attr('role', known ? 'button' : 'img')
                .attr('tabindex', -1)
                .attr('data-group', order)
                .attr('data-place', place);
  g.append('circle').attr('class', 'reach').attr('r', 9);
  if (point.failed) {
    g.append('text').attr('class', 'glyph').attr('dy', '0.35em').text(statusOf(point.status).glyph);
  } else {
    g.append('path')
        .attr('class', floored ? 'zero' : 'dot')
        .attr(
            'd',
            floored ? markerPath('triangle', 50) : markerPath(solverOf(series.solver).marker, size))
        .classed('hollow', point.status !== 'ok' || !!point.not_counted);
    if (point.name && !floored)
      g.append('text').attr('class', 'name').attr('x', 7).attr('y', -6).text(point.name);
  }
  describe(g.node(), pointLines(spec, series, point));
  if (!known) return;
  const open = () => state.set({case: point.case});
  g.on('click', open).on('keydown', () => {
    if (d3.event.key !== 'Enter' && d3.event.key !== ' ') return;
    d3.event.preventDefault();
    open();
  });
}

/**
 * Keeps the names of points on the front as far as there is room; others are shown at the pointer.
 */
function nameBest(svg, spec) {
  const texts = svg.selectAll('.point .name').nodes();
  if (!spec.front) return texts.forEach((text) => text.remove());
  const best = new Set(spec.front.map((p) => p.case));
  const owner = (text) => {
    const [s, i] = text.parentNode.dataset.place.split('-');
    return spec.series[s].points[i].case;
  };
  const frame = svg.node().getBoundingClientRect();
  const fits = (text) => best.has(owner(text)) && text.getBoundingClientRect().right <= frame.right;
  for (const text of texts.filter((text) => !fits(text))) text.remove();
  thin(texts.filter((text) => text.isConnected), svg.selectAll('.dot, .axis text').nodes());
}
