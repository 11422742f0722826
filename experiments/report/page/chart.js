'use strict';
// Charts of points over a setting or a cost: lines, error bars, failed cases above the plot, zeros on the axis.

/** A regular polygon; `first` is the direction of its first corner [rad]. */
const polygon = (corners, first) => ({draw(context, area) {
  const radius = Math.sqrt(2 * area / (corners * Math.sin(2 * Math.PI / corners)));
  for (const i of d3.range(corners)) {
    const angle = first + 2 * Math.PI * i / corners;
    context[i ? 'lineTo' : 'moveTo'](radius * Math.cos(angle), radius * Math.sin(angle));
  }
  context.closePath();
}});
const markers = {circle: d3.symbolCircle, square: d3.symbolSquare, triangle: d3.symbolTriangle,
                 'triangle-down': polygon(3, Math.PI / 2), diamond: d3.symbolDiamond, pentagon: polygon(5, -Math.PI / 2)};
const markerPath = (name, size) => d3.symbol().type(markers[name] ?? d3.symbolCircle).size(size)();
/** Dashes of a solver's further settings. */
const variantDashes = ['', '7 4', '2 3', '10 3 2 3', '16 4', '4 2', '10 3 2 3 2 3', '2 6'];
const dashOf = ({solver, variant}) => variant ? variantDashes[variant % variantDashes.length] : solverOf(solver).dash;

/** Pixels: of a chart, above and below its plot, and of a row of failed cases. */
const box = {height: 250, top: 10, bottom: 22, row: 13};

/** A scale over shown values: logarithmic over the positive ones or linear, with a little air. */
function scaleOf(kind, values, range) {
  const usable = values.filter((v) => Number.isFinite(v) && (kind !== 'log' || v > 0));
  let [low, high] = usable.length ? d3.extent(usable) : kind === 'log' ? [0.1, 1] : [0, 1];
  if (kind === 'log') {
    const air = Math.max((high / low) ** 0.05, 1.12);
    return d3.scaleLog().domain([low / air, high * air]).range(range);
  }
  if (low >= 0 && low < 0.5 * high) low = 0;
  if (low === 0 && high === 0) high = 1;
  const air = (high - low || Math.abs(high) || 1) * 0.05;
  return d3.scaleLinear().domain([low === 0 ? 0 : low - air, high + air]).range(range);
}

/** Ticks that can be read: the values of a study's setting, or 1, 2 and 5 of each power of ten as far as they fit; of many powers every second. */
function ticksOf(scale, axis, kind, wanted) {
  const [low, high] = scale.domain(), inside = (v) => v >= low && v <= high;
  if (axis.values) return axis.values.map((v) => v * axis.scale).filter(inside);
  if (kind !== 'log') return scale.ticks(wanted);
  const decades = Math.log10(high / low);
  if (decades < 0.7) return d3.ticks(low, high, wanted);
  const factors = decades > 0.7 * wanted ? [1] : decades > 1.6 ? [1, 3] : [1, 2, 5];
  const by = Math.ceil(decades / (2 * wanted)), first = by * Math.floor(Math.log10(low) / by);
  return d3.range(first, Math.ceil(Math.log10(high)) + 1, by)
      .flatMap((power) => factors.map((f) => f * 10 ** power)).filter(inside);
}

/** Takes away texts that would lie on one kept before them or on an obstacle; measured, not estimated. */
function thin(texts, obstacles = []) {
  const taken = obstacles.map((node) => node.getBoundingClientRect());
  for (const text of texts) {
    const box = text.getBoundingClientRect();
    if (taken.some((t) => box.left < t.right + 2 && box.right > t.left - 2 && box.top < t.bottom && box.bottom > t.top))
      text.remove();
    else taken.push(box);
  }
}

function pointLines(spec, series, point) {
  const {x, y} = spec, costs = interval(point.x_low, point.x_high, x);
  const value = point.y === null || point.y === undefined ? 'no value' : shown(point.y, y, 4);
  return [`${series.label}${point.name ? `, ${point.name}` : ''}`, `${y.title}: ${value}`,
          `${x.title}: ${shown(point.x, x, 4)}${costs && ` (95 %: ${costs})`}`,
          ...caseLines(point.status, undefined, point.case)];
}

/** Draws when a plot gets its width and whenever that changes, save for paper. */
function watchWidth(plot, draw) {
  new ResizeObserver(() => { if (!document.body.classList.contains('printing')) draw(); }).observe(plot);
}

/** Charts that are on the page: they are drawn again when the page is printed. */
const drawn = new Set();

/** A swatch of the key: a stretch of the line with its marker. */
function swatch(series) {
  const svg = d3.create('svg').attr('class', 'swatch').attr('viewBox', '0 0 30 12').attr('aria-hidden', 'true');
  svg.append('line').attr('x2', 30).attr('y1', 6).attr('y2', 6).attr('stroke-width', 2)
      .style('stroke', series.colour ?? solverColour(series.solver))
      .attr('stroke-dasharray', series.dash ?? dashOf(series)).attr('class', series.className);
  if (series.solver)
    svg.append('path').attr('transform', 'translate(15,6)').attr('d', markerPath(solverOf(series.solver).marker, 45))
        .style('fill', solverColour(series.solver));
  return svg.node();
}

/** Whether the reference's own error is drawn: unless it lies far below all points. */
const floorShown = ({floor, series}) => floor.y > d3.min(series.flatMap((s) => s.points)
    .map((p) => p.failed ? 0 : p.y).filter((v) => v > 0)) / 30;

/** The key, without what the solvers' switches say for the whole page: further settings of a solver, lines of theory, and what × above the plot, triangle and hollow marker mean where they occur. */
function chartKey(spec, kind) {
  const points = spec.series.flatMap((s) => s.points), grey = (dash) => swatch({colour: 'var(--muted)', dash});
  const statusesOf = (which) => [...new Set(points.filter(which).map((p) => p.status))].map(statusOf);
  const failed = statusesOf((p) => p.failed), unfinished = statusesOf((p) => !p.failed && p.status !== 'ok');
  const entry = (sign, text, order) => el('li', {'data-s': order}, sign, el('span', {}, text));
  const list = el('ul', {className: 'key'},
    spec.series.filter((s) => s.variant || s.label !== solverOf(s.solver).title)
        .map((s) => entry(swatch(s), short(s.label, 60), solverOf(s.solver).order)),
    (spec.same ?? []).map((text) => entry('', text)),
    spec.theory && entry(grey('4 3'), spec.theory.text),
    spec.floor && entry(floorShown(spec) ? grey('1 3') : '', spec.floor.text + (floorShown(spec) ? '' : ': below the plot')),
    spec.front && entry(swatch({className: 'front', colour: 'var(--stair)', dash: ''}), 'no setting is better in both'),
    failed.map((s) => entry(el('b', {}, s.glyph), `above the plot: ${s.title}`)),
    kind === 'log' && points.some((p) => p.zero) && entry(el('b', {}, '▲'), 'on the axis: exactly zero'),
    kind === 'log' && points.some((p) => p.y < 0) && entry(el('b', {}, '!'),
      `${points.filter((p) => p.y < 0).length} below zero: linear scale only`),
    unfinished.length > 0 && entry(el('b', {}, '○'), `hollow: ${unfinished.map((s) => s.title).join(', ')}`));
  return list.children.length ? list : '';
}

/** The figure of a chart. It is drawn when it gets a width, and again when that changes. */
function chartFigure(spec) {
  const points = spec.series.flatMap((s) => s.points);
  const heading = el('h4', {}, short(spec.title, 120));
  const held = spec.held && spec.held[0].toUpperCase() + spec.held.slice(1) + '.';
  const note = el('p', {className: 'note'}, [held, spec.caption, spec.thinned].filter(Boolean).join(' '));
  if (points.length && points.every((p) => p.zero))
    return el('figure', {className: 'card chart flat', id: `chart-${spec.id}`}, el('figcaption', {}, heading, note),
              el('p', {}, `Every value is exactly zero (${count(points.length, 'case')}).`));
  const view = {kind: spec.y.axis, clip: `clip-${drawn.size}`};
  const plot = el('div', {className: 'plot'}), key = el('div'), bar = el('div', {className: 'tools'});
  const svg = d3.select(plot).append('svg').attr('role', 'group')
      .attr('aria-label', short(`${spec.title}: points`, 160));
  const reset = rove(plot, '.point');
  const draw = (width) => {
    if (!width) return;
    const active = document.activeElement?.dataset?.place;
    drawChart(svg, spec, view, width);
    if (svg.node().contains(document.activeElement) || active !== undefined)
      svg.node().querySelector(`[data-place="${active}"]`)?.focus();
    reset();
  };
  const again = () => draw(plot.clientWidth);
  const keyOf = () => key.replaceChildren(chartKey(spec, view.kind));
  if (points.some((p) => p.y > 0)) {
    const other = () => view.kind === 'log' ? 'linear' : 'log';
    const flip = el('button', {type: 'button', title: 'other vertical scale', onclick: () => {
      view.kind = other();
      flip.textContent = other();
      keyOf();
      again();
    }}, other());
    bar.append(flip);
  }
  keyOf();
  watchWidth(plot, again);
  drawn.add({plot, draw});
  return el('figure', {className: 'card chart', id: `chart-${spec.id}`}, el('figcaption', {}, heading, bar, note), key,
            el('div', {className: 'y-title'}, titled(spec.y)), plot, el('div', {className: 'x-title'}, titled(spec.x)));
}

function drawChart(svg, spec, view, width) {
  const flat = spec.series.flatMap((s) => s.points), {x, y} = spec;
  const failing = spec.series.filter((s) => s.points.some((p) => p.failed));
  const strip = failing.length ? failing.length * box.row + 6 : 0;
  const floor = view.kind === 'log' && flat.some((p) => p.zero) ? 12 : 0;
  const [yLow, yHigh] = [box.height - box.bottom - floor, box.top + strip];
  const numbers = (list, scale) => list.filter((v) => typeof v === 'number').map((v) => v * scale);
  const measured = flat.filter((p) => !p.failed).map((p) => p.y);
  if (spec.floor && floorShown(spec)) measured.push(spec.floor.y);
  const up = numbers(measured, y.scale);
  const across = numbers(flat.flatMap((p) => [p.x, p.x_low, p.x_high]), x.scale);
  const ys = scaleOf(view.kind, up, [yLow, yHigh]);
  svg.attr('viewBox', `0 0 ${width} ${box.height}`).attr('width', width).attr('height', box.height);
  svg.selectAll('*').remove();
  const axisY = svg.append('g').attr('class', 'axis y');
  axisY.call(d3.axisLeft(ys).tickValues(ticksOf(ys, {...y, values: undefined}, view.kind, 5))
      .tickFormat((v) => number(v)).tickSize(0).tickPadding(6));
  const left = Math.ceil(axisY.node().getBBox().width) + 4;
  axisY.attr('transform', `translate(${left},0)`);
  const axisX = svg.append('g').attr('class', 'axis x').attr('transform', `translate(0,${box.height - box.bottom})`);
  const drawX = (margin) => {
    const scale = scaleOf(x.axis, across, [left + 8, width - margin]);
    axisX.call(d3.axisBottom(scale).tickValues(ticksOf(scale, x, x.axis, width / 90))
        .tickFormat((v) => number(v)).tickSize(4).tickPadding(4));
    return scale;
  };
  let right = 12, xs = drawX(right);
  const end = (node) => node.getBoundingClientRect().right;
  const over = d3.max(axisX.selectAll('text').nodes(), end) - end(svg.node());
  if (over > 0) xs = drawX(right += Math.ceil(over));
  axisY.selectAll('.tick line').attr('x2', width - left - right);
  axisX.select('.domain').attr('d', `M${left},0H${width - right}`);
  thin(axisX.selectAll('text').nodes());
  svg.append('clipPath').attr('id', view.clip).append('rect').attr('x', left).attr('y', yHigh - 4)
      .attr('width', Math.max(0, width - left - right + 6)).attr('height', Math.max(0, yLow - yHigh + 8));
  const area = svg.append('g').attr('clip-path', `url(#${view.clip})`);
  const px = (v) => xs(v * x.scale), py = (v) => ys(v * y.scale);
  const usable = (p) => !p.failed && typeof p.y === 'number' && (view.kind !== 'log' || p.y > 0);
  const line = d3.line().defined(usable).x((p) => px(p.x)).y((p) => py(p.y));
  if (spec.front)
    area.append('path').attr('class', 'front').attr('d', line.curve(d3.curveStepAfter)(spec.front.filter(usable)));
  line.curve(d3.curveLinear);
  if (spec.theory && (view.kind === 'log') === (x.axis === 'log')) {
    const ends = xs.domain().map((v) => v / x.scale);
    area.append('path').attr('class', 'theory')
        .attr('d', d3.line()(ends.map((v) => [px(v), py(spec.theory.factor * v ** spec.theory.slope)])));
  }
  if (spec.floor && floorShown(spec)) area.append('path').attr('class', 'floor').attr('d', `M${left},${py(spec.floor.y)}H${width - right}`);
  spec.series.forEach((s, order) => {
    const solver = solverOf(s.solver), colour = solverColour(s.solver);
    const dodge = (order - (spec.series.length - 1) / 2) * 7;
    const lines = area.append('g').attr('data-s', solver.order).style('stroke', colour).style('fill', 'none');
    if (s.join) lines.append('path').attr('class', 'line').attr('stroke-dasharray', dashOf(s)).attr('d', line(s.points));
    lines.append('path').attr('class', 'error')
        .attr('d', s.points.filter(usable).map((p) => errorBar(p, px, py)).join(''));
    const group = svg.append('g').attr('data-s', solver.order).style('color', colour);
    s.points.forEach((p, i) => {
      const floored = p.zero && view.kind === 'log';
      if (!p.failed && !floored && !usable(p)) return;
      const cx = px(p.x) + (floored ? dodge : 0);
      const cy = p.failed ? box.top + 4 + failing.indexOf(s) * box.row
                          : floored ? box.height - box.bottom - 5 : py(p.y);
      drawPoint(group, {spec, series: s, point: p, place: `${order}-${i}`, order, cx, cy, floored});
    });
  });
  nameBest(svg, spec);
}

/** A bar over the 95 % interval of x, with caps. */
function errorBar(p, px, py) {
  const cy = py(p.y), cap = 3;
  if (typeof p.x_low !== 'number' || typeof p.x_high !== 'number') return '';
  return `M${px(p.x_low)},${cy}H${px(p.x_high)}` +
         [p.x_low, p.x_high].map((v) => `M${px(v)},${cy - cap}v${2 * cap}`).join('');
}

function drawPoint(group, {spec, series, point, place, order, cx, cy, floored}) {
  const known = cases.has(point.case);
  const g = group.append('g').attr('class', 'point').attr('transform', `translate(${cx},${cy})`)
      .attr('role', known ? 'button' : 'img').attr('tabindex', -1).attr('data-group', order).attr('data-place', place);
  g.append('circle').attr('class', 'reach').attr('r', 9);
  if (point.failed) {
    g.append('text').attr('class', 'glyph').attr('dy', '0.35em').text(statusOf(point.status).glyph);
  } else {
    g.append('path').attr('class', floored ? 'zero' : 'dot')
        .attr('d', floored ? markerPath('triangle', 50) : markerPath(solverOf(series.solver).marker, 52))
        .classed('hollow', point.status !== 'ok');
    if (point.name && !floored) g.append('text').attr('class', 'name').attr('x', 7).attr('y', -6).text(point.name);
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

/** The names of the points on the front, as many as find room; the others say theirs at the pointer. */
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
