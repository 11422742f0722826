'use strict';
// Films of a scene, with quantities over time beside them. Times are seconds of simulated time.

/**
 * Converts a data URI to a blob, which can be played even though the page may not load anything.
 */
function blobUrl(uri) {
  const [head, body] = uri.split(',', 2);
  const bytes = Uint8Array.from(atob(body), (letter) => letter.charCodeAt(0));
  return URL.createObjectURL(new Blob([bytes], {type: head.slice(5).split(';')[0]}));
}

/** Ids of the answer's columns. */
const compared =
    Object.values(model.answer?.tables ?? {})[0]?.columns.slice(1).map(({name}) => name) ?? [];

const seconds = (t) => t.toFixed(2) + '\u00A0s';

/** Lines over time with a cursor and the values there. Calls `seek` with the time pointed at. */
function timeChart(track, seek, until) {
  const quantity = metric(track.metric), key = el('ul', {className: 'key'}),
        plot = el('div', {className: 'plot time'});
  const outputs = track.series.map((s) => {
    const output = el('output', {});
    key.append(
        el('li', {'data-s': solverOf(s.solver).order}, swatch(s),
           el('span', {}, short(s.label, 60)), output));
    return output;
  });
  const svg = d3.select(plot)
                  .append('svg')
                  .attr('role', 'img')
                  .attr('aria-label', short(`${track.title} over time`, 160));
  const span = until ?? d3.max(track.series, (s) => s.t[s.t.length - 1]), h = 132, foot = 26;
  let xs = null, cursor = null, time = 0;
  const draw = (width) => {
    if (!width) return;
    svg.attr('viewBox', `0 0 ${width} ${h}`)
        .attr('width', width)
        .attr('height', h)
        .selectAll('*')
        .remove();
    const ys = scaleOf(track.range, [h - foot, 8]);
    const axis = svg.append('g')
                     .attr('class', 'axis y')
                     .call(d3.axisLeft(ys)
                               .tickValues(ys.ticks(3))
                               .tickFormat((v) => number(v))
                               .tickSize(0)
                               .tickPadding(6));
    const left = Math.ceil(axis.node().getBBox().width) + 4;
    axis.attr('transform', `translate(${left},0)`)
        .selectAll('.tick line')
        .attr('x2', width - left - 12);
    xs = d3.scaleLinear([0, span], [left, width - 12]);
    svg.append('g')
        .attr('class', 'axis x')
        .attr('transform', `translate(0,${h - foot})`)
        .call(d3.axisBottom(xs)
                  .ticks(width / 80)
                  .tickSize(4)
                  .tickPadding(7)
                  .tickFormat((v) => number(v) + ' s'));
    thin(svg.selectAll('.axis.x text').nodes());
    for (const s of track.series)
      svg.append('path')
          .attr('class', 'line')
          .attr('data-s', solverOf(s.solver).order)
          .attr('stroke-dasharray', dashOf(s))
          .style('stroke', solverColour(s.solver))
          .attr(
              'd',
              d3.line()
                  .defined((v, i) => v !== null && s.t[i] <= span)
                  .x((v, i) => xs(s.t[i]))
                  .y((v) => ys(v * quantity.scale))(s.y));
    cursor = svg.append('path').attr('class', 'cursor');
    show(time);
  };
  const show = (t) => {
    time = t;
    if (cursor) cursor.attr('d', `M${xs(Math.min(t, span))},6V${h - foot}`);
    track.series.forEach((s, i) => {
      const at = Math.max(0, d3.bisectRight(s.t, t + 1e-9) - 1);
      // A run that ended early has no value here; the text says how it ended.
      const over = t > s.t[s.t.length - 1] + 0.1 && cases.get(s.case)?.status;
      outputs[i].textContent = over ? statusOf(over).title : shown(s.y[at], quantity);
    });
  };
  const point = (event) => {
    if (event.buttons & 1)
      seek(Math.max(0, Math.min(span, xs.invert(d3.clientPoint(svg.node(), event)[0]))));
  };
  svg.node().addEventListener('pointerdown', point);
  svg.node().addEventListener('pointermove', point);
  watchWidth(plot, () => draw(plot.clientWidth));
  drawn.add({plot, draw});
  show(0);
  const heading = el('h4', {}, titled({...quantity, title: track.title || quantity.title}));
  const node = el('figure', {className: 'track'}, el('figcaption', {}, heading), key, plot);
  return {node, show, span};
}

/** A chart over time for a scene without a film; a slider moves its cursor. */
function seriesFigure(spec) {
  const track = {metric: spec.y.metric, title: spec.title, range: spec.range, series: spec.series};
  const seek = (t) => {
    slider.value = t;
    line.show(t);
  };
  const slider = el('input', {
    type: 'range',
    min: 0,
    step: 'any',
    'aria-label': `Time in ${short(spec.title, 60)} [s]`,
    oninput: () => line.show(Number(slider.value))
  });
  const line = timeChart(track, seek);
  slider.max = line.span;
  seek(line.span);
  return el(
      'div', {className: 'card chart', id: `chart-${spec.id}`}, line.node, slider,
      note(spec.caption));
}

function colourBar(bar) {
  const stops = bar.stops.filter((stop) => /^#[0-9a-f]{6}$/i.test(stop)).join(',');
  const label = `Colours: ${bar.title}, ${bar.ticks.map((t) => t.text).join(', ')}`;
  return el(
      'div', {className: 'colour-bar', role: 'img', 'aria-label': label}, el('span', {}, bar.title),
      el('i', {style: `background:linear-gradient(90deg,${stops})`}),
      el('div', {className: 'ticks'},
         bar.ticks.map((t) => el('span', {style: `left:${100 * t.at}%`}, t.text))));
}

function panels(film) {
  const failure = (status) =>
      status && status !== 'ok' && [' ', glyphBox(status), ' ', statusOf(status).title];
  const panel = ({solver, settings, case: key}) =>
      el('div', {}, named(solver),
         el('small', {}, caseLink(key, short(settings, 60)), failure(cases.get(key)?.status)));
  const columns = `repeat(${film.columns},minmax(0,1fr))`;
  return el(
      'div', {className: 'panels', style: `grid-template-columns:${columns}`},
      film.panels.map(panel));
}

/** A note on the compared solvers that the film does not show. */
function notFilmed(film) {
  const seen = film.panels.map(({solver}) => solver),
        others = compared.filter((id) => !seen.includes(id));
  if (!others.length) return null;
  return note(
      `${film.panels.length} of ${compared.length} solvers compared; `,
      `not shown: ${others.map((id) => solverOf(id).title).join(', ')}.`);
}

/** The film of a scene with its controls, and its tracks beside it. */
function player(scene, film) {
  const moves = film.src && film.type.startsWith('video/');
  const video = moves && el('video', {
                  className: 'picture',
                  poster: film.poster,
                  muted: true,
                  playsInline: true,
                  preload: 'none',
                  'aria-label': film.alt
                });
  const still = () => film.src ? el('img', {alt: film.alt, className: 'picture', src: film.src}) :
                                 note(film.left_out);
  const picture = video || still();
  const tracks =
      (film.tracks ?? []).map((track) => timeChart(track, (t) => seek(t), film.duration));
  let time = film.poster_t ?? 0, touched = false;
  const label = el('span', {}, 'play'), clock = el('output', {className: 'clock'}, seconds(time));
  const slider = el('input', {
    type: 'range',
    min: 0,
    'aria-label': `Time of the film of ${short(scene.title)} [s]`,
    oninput: () => seek(Number(slider.value))
  });
  const show = () => {
    clock.textContent = seconds(time);
    slider.value = time;
    for (const track of tracks) track.show(time);
  };
  const load = () => {
    if (video.src) return;
    video.addEventListener('loadedmetadata', place);
    video.src = blobUrl(film.src);
  };
  /**
   * Seeks slightly past the start of a frame, since rounding could otherwise show the previous one.
   */
  const place = () => {
    const into = (time + (time > 0 ? film.frame / 8 : 0)) / film.speed;
    if (video.readyState) video.currentTime = Math.min(video.duration, into);
  };
  const pause = () => {
    video.pause();
    label.textContent = 'play';
    box.classList.remove('playing');
  };
  const seek = (t) => {
    time = Math.max(0, Math.min(film.duration, t));
    if (video) {
      load();
      pause();
      touched = true;
      place();
    }
    show();
  };
  const follow = () => {
    if (video.paused) return;
    time = video.currentTime * film.speed;
    show();
    requestAnimationFrame(follow);
  };
  const toggle = () => {
    if (!video.paused) return pause();
    if (!touched || time >= film.duration - film.frame) seek(0);
    load();
    touched = true;
    video.play().then(() => requestAnimationFrame(follow)).catch(pause);
    label.textContent = 'pause';
    box.classList.add('playing');
  };
  const step = (by) => seek((Math.round(time / film.frame) + by) * film.frame);
  const button = (text, name, act) =>
      el('button', {type: 'button', 'aria-label': name, onclick: act}, text);
  const box =
      el('div', {
        className: 'card player',
        'data-at': 'film',
        tabIndex: video ? 0 : undefined,
        role: 'group',
        'aria-label': `Film of ${short(scene.title)}`
      },
         el('div', {className: 'stage'}, panels(film), picture, film.bar && colourBar(film.bar),
            video &&
                el('div', {className: 'controls'},
                   el('button', {type: 'button', className: 'play', onclick: toggle}, label),
                   button('◂', 'One frame back', () => step(-1)),
                   button('▸', 'One frame forward', () => step(1)), slider, clock,
                   el('span', {className: 'hint'},
                      film.speed < 1 && `${number(film.speed, 2)} of real time · `, 'space, ← →'))),
         el('div', {className: 'beside'}, notFilmed(film), tracks.map((track) => track.node)));
  if (video) {
    slider.max = film.duration;
    slider.step = film.frame;
    video.onclick = () => {
      box.focus({preventScroll: true});
      toggle();
    };
    video.addEventListener('ended', pause);
    box.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey ||
          event.target.closest('button, a, input'))
        return;
      const act = {' ': toggle, ArrowLeft: () => step(-1), ArrowRight: () => step(1)}[event.key];
      if (!act) return;
      event.preventDefault();
      act();
    });
  }
  show();
  return box;
}
