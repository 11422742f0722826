'use strict';
// The page as a whole: its contents, the solvers' switches, and printing.

const name = (part) =>
    part.id === 'answer' && !model.differences ? 'Answer' : part.querySelector('h2').textContent;

/**
 * Ids of the sections to print. By default all scenes and all cases are left out, since they take
 * many pages.
 */
const toPaper = () => state.get('print') ? state.params().getAll('print') :
                                           ['differences', 'answer', 'charts', 'cost'];
function printChooser(sections) {
  const boxes =
      sections.map(({id}) => el('input', {
                     type: 'checkbox',
                     onchange: () => {
                       const chosen =
                           sections.filter((_, i) => boxes[i].checked).map((part) => part.id);
                       state.set({print: chosen.length ? chosen : ['none']}, false);
                     }
                   }));
  state.watch(() => sections.forEach((part, i) => {
    boxes[i].checked = toPaper().includes(part.id);
    part.classList.toggle('unprinted', !boxes[i].checked);
  }));
  return el(
      'details', {className: 'to-paper'}, el('summary', {}, 'Print'),
      sections.map((part, i) => el('label', {}, boxes[i], ' ', name(part))),
      el('button', {type: 'button', onclick: () => print()}, 'print these'));
}

/** The contents, which stay visible, and the solvers' switches. */
function contents(sections) {
  const links = sections.map((part) => choice({at: part.id}, {}, name(part)));
  const seen = new IntersectionObserver(() => {
    const now = sections.findLastIndex((part) => part.getBoundingClientRect().top < 140);
    links.forEach((link, i) => link.classList.toggle('here', i === Math.max(0, now)));
  }, {rootMargin: '-130px 0px -50% 0px', threshold: d3.range(0, 1.01, 0.05)});
  for (const part of sections) seen.observe(part);
  const flip = (id) => {
    const off = state.params().getAll('off');
    state.set({off: off.includes(id) ? off.filter((other) => other !== id) : [...off, id]}, false);
  };
  const ids = [...solvers.keys()];
  const switches = ids.map(
      (id) =>
          el('button', {type: 'button', className: 'switch', onclick: () => flip(id)},
             swatch({solver: id}), ' ', short(solverOf(id).title, 40)));
  state.watch(() => ids.forEach((id, i) => switches[i].setAttribute('aria-pressed', !isOff(id))));
  const group =
      el('div', {className: 'switches', role: 'group', 'aria-label': 'Solvers shown'}, switches);
  document.getElementById('contents')
      .append(
          el('ul', {}, links.map((link) => item(link))), ids.length > 1 ? group : '',
          printChooser(sections));
}

/**
 * Before printing, shows all scenes and folded parts of the printed sections; restores them
 * afterwards.
 */
function watchPrinting() {
  let closed = [];
  const begin = () => {
    if (document.body.classList.contains('printing')) return;
    document.body.classList.add('printing');
    for (const {showAll, isPrinted} of oneOf.views)
      if (isPrinted()) showAll();
    closed = [...document.querySelectorAll('main section:not(.unprinted) details:not([open])')];
    for (const part of closed) part.open = true;
    for (const {draw} of drawn) draw(330);
  };
  const end = () => {
    document.body.classList.remove('printing');
    for (const part of closed) part.open = false;
    for (const {showOne} of oneOf.views) showOne();
    for (const {draw, plot} of drawn) draw(plot.clientWidth);
  };
  addEventListener('beforeprint', begin);
  addEventListener('afterprint', end);
  matchMedia('print').addEventListener('change', (event) => (event.matches ? begin : end)());
}

/**
 * The element with this id (a section, a table or a chart), or the visible part with that name of
 * the shown scene ("film").
 */
const placeOf = (id) => document.getElementById(id) ??
    [...document.querySelectorAll(`[data-at="${CSS.escape(id)}"]`)].find(
        (node) => node.checkVisibility());

function start() {
  paint();
  const sections = [
    differencesSection(), answerSection(), chartsSection(), sceneSection(), costSection(),
    stepsSection(), limitsSection(), truthsSection(), historySection(), regressionSection(),
    casesSection(), methodSection()
  ].filter(Boolean);
  document.getElementById('main').append(...sections);
  contents(sections);
  watchCase();
  watchPrinting();
  let at = null, scene = null;
  state.watch(() => {
    const wanted = state.section(), now = state.get('scene');
    // Wait until charts and films have their heights, so that the target does not move away after
    // scrolling.
    if (wanted && (wanted !== at || now !== scene))
      requestAnimationFrame(() => requestAnimationFrame(() => placeOf(wanted)?.scrollIntoView()));
    [at, scene] = [wanted, now];
  });
  state.tell();
}
start();
