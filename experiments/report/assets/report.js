'use strict';
// The theme: the system's until the button is pressed.
const root = document.documentElement;
const dark = matchMedia('(prefers-color-scheme: dark)');
const theme = document.getElementById('theme');
const shown = () => root.dataset.theme || (dark.matches ? 'dark' : 'light');
const tell = () => theme.setAttribute('aria-pressed', shown() === 'dark');
theme.addEventListener('click', () => {
  root.dataset.theme = shown() === 'dark' ? 'light' : 'dark';
  tell();
});
tell();

// A player: films of one scene that run together, the first one leads; the playhead of the chart below
// follows and scrubs them. Times are seconds of simulated time. It opens at the moment of its poster.
const players = [];
let current = null;  // the one that keys move

const makePlayer = (box) => {
  const videos = [...box.querySelectorAll('video')];
  if (!videos.length) return;
  const leader = videos[0];
  const speed = Number(leader.dataset.speed) || 1;
  const frame = (Number(leader.dataset.frame) || 1 / 30) / speed;  // seconds of video
  const poster = Number(leader.dataset.poster) || 0;
  const play = box.querySelector('.play');
  const label = play.querySelector('span');
  const clock = box.querySelector('.clock');
  const line = box.querySelector('.timeline');
  const scrub = line && line.querySelector('.scrub');
  // The chart as pages and phones show it; one of them is seen.
  const plots = line ? [...line.querySelectorAll('.plot')].map((box) => ({
    box, head: box.querySelector('.playhead'),
    left: Number(box.dataset.left), right: Number(box.dataset.right)
  })) : [];
  const low = line && Number(line.dataset.low), high = line && Number(line.dataset.high);
  let untouched = true;  // still at its poster: playing starts at the beginning
  let wanted = poster;   // what is shown before the film has arrived, and sought once it has
  box.querySelector('.controls').hidden = false;
  if (line) scrub.hidden = false;
  for (const plot of plots) plot.head.hidden = false;

  const show = (time) => {
    clock.textContent = time.toFixed(2) + ' s';
    if (!line) return;
    const share = Math.min(1, Math.max(0, (time - low) / (high - low)));
    for (const {head, left, right} of plots)
      head.style.left = 100 * (left + share * (right - left)) + '%';
    scrub.value = time;
    scrub.setAttribute('aria-valuetext', time.toFixed(2) + ' seconds');
  };
  const here = () => leader.readyState ? leader.currentTime * speed : wanted;
  // A frame is sought a little after its beginning: rounding must not show the one before.
  const put = (video) => {
    if (video.readyState)
      video.currentTime = Math.min(video.duration, wanted / speed + (wanted > 0 ? frame / 8 : 0));
  };
  const load = () => {
    if (leader.src) return;
    for (const video of videos) {
      video.addEventListener('loadedmetadata', () => { if (wanted > 0) put(video); });
      video.src = video.dataset.src;
      video.removeAttribute('data-src');
    }
  };
  const seek = (time) => {
    load();
    current = player;
    untouched = false;
    const end = leader.readyState ? leader.duration * speed : Infinity;
    wanted = Math.min(end, Math.max(0, time));
    for (const video of videos) put(video);
    show(wanted);
  };
  const pause = () => {
    for (const video of videos) video.pause();
    label.textContent = 'play';
  };
  const start = () => {
    for (const other of players) if (other !== player) other.pause();
    if (untouched) seek(0);
    current = player;
    for (const video of videos) {
      if (video !== leader && video.readyState) video.currentTime = leader.currentTime;
      video.play().catch(pause);
    }
    label.textContent = 'pause';
  };
  const toggle = () => leader.paused ? start() : pause();
  const step = (by) => {
    pause();
    seek((Math.floor(here() / speed / frame + 0.01) + by) * frame * speed);
  };
  const follow = () => {
    if (leader.paused) return;
    show(leader.currentTime * speed);
    for (const video of videos)
      if (Math.abs(video.currentTime - leader.currentTime) > 2 * frame)
        video.currentTime = leader.currentTime;
    requestAnimationFrame(follow);
  };
  leader.addEventListener('play', () => requestAnimationFrame(follow));
  leader.addEventListener('ended', () => { seek(0); start(); });
  for (const video of videos) video.addEventListener('click', toggle);
  play.addEventListener('click', toggle);
  box.querySelector('.back').addEventListener('click', () => step(-1));
  box.querySelector('.forward').addEventListener('click', () => step(1));
  if (line) {
    scrub.addEventListener('input', () => { pause(); seek(Number(scrub.value)); });
  }
  for (const {box: plot, left, right} of plots) {
    const drag = (event) => {
      if (!(event.buttons & 1)) return;
      const edge = plot.getBoundingClientRect();
      const share = ((event.clientX - edge.left) / edge.width - left) / (right - left);
      pause();
      seek(low + Math.min(1, Math.max(0, share)) * (high - low));
    };
    plot.addEventListener('pointerdown', drag);
    plot.addEventListener('pointermove', drag);
  }
  const player = {box, load, toggle, step, start, pause};
  players.push(player);
  show(poster);
};
for (const box of document.querySelectorAll('.player')) makePlayer(box);
// Films are decoded when they come near.
const near = new IntersectionObserver((entries) => {
  for (const entry of entries) {
    if (!entry.isIntersecting) continue;
    near.unobserve(entry.target);
    players.find((player) => player.box === entry.target).load();
  }
}, {rootMargin: '600px 0px'});
for (const player of players) near.observe(player.box);

document.addEventListener('keydown', (event) => {
  if (!current || event.ctrlKey || event.metaKey || event.altKey ||
      event.target.closest('input, button, a, summary, [tabindex]')) return;
  const act = {' ': current.toggle, ArrowLeft: () => current.step(-1),
               ArrowRight: () => current.step(1)}[event.key];
  if (!act) return;
  event.preventDefault();
  act();
});
if (players.length) {
  current = players[0];
  if (players[0].box.matches('.leads') && !matchMedia('(prefers-reduced-motion: reduce)').matches)
    players[0].start();
}
