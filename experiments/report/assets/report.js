'use strict';
// The theme: the system's until the button is pressed.
const root = document.documentElement;
const dark = matchMedia('(prefers-color-scheme: dark)');
document.getElementById('theme').addEventListener('click', () => {
  const now = root.dataset.theme || (dark.matches ? 'dark' : 'light');
  root.dataset.theme = now === 'dark' ? 'light' : 'dark';
});

// Videos of one scene run together; the first one leads. Times are seconds of simulated time.
const videos = [...document.querySelectorAll('.stage video')];
const line = document.querySelector('.timeline');
if (videos.length) {
  const leader = videos[0];
  const speed = Number(leader.dataset.speed) || 1;
  const play = document.getElementById('play');
  const clock = document.getElementById('clock');
  const scrub = line && line.querySelector('.scrub');
  const head = line && line.querySelector('.playhead');
  const place = line && {
    left: Number(line.dataset.left), right: Number(line.dataset.right),
    low: Number(line.dataset.low), high: Number(line.dataset.high)
  };
  const frame = 1 / 30;
  document.querySelector('.controls').hidden = false;
  if (line) scrub.hidden = head.hidden = false;

  const show = (time) => {
    clock.textContent = time.toFixed(2) + ' s';
    if (!line) return;
    const share = Math.min(1, Math.max(0, (time - place.low) / (place.high - place.low)));
    head.style.left = 100 * (place.left + share * (place.right - place.left)) + '%';
    scrub.value = time;
  };
  const seek = (time) => {
    const end = leader.duration || 0;
    const at = Math.min(end, Math.max(0, time / speed));
    for (const video of videos) video.currentTime = at;
    show(at * speed);
  };
  const pause = () => {
    for (const video of videos) video.pause();
    play.textContent = 'play';
  };
  const start = () => {
    for (const video of videos) {
      video.currentTime = leader.currentTime;
      video.play().catch(pause);
    }
    play.textContent = 'pause';
  };
  const toggle = () => leader.paused ? start() : pause();
  const step = (by) => { pause(); seek((leader.currentTime + by * frame) * speed); };

  const follow = () => {
    show(leader.currentTime * speed);
    for (const video of videos)
      if (Math.abs(video.currentTime - leader.currentTime) > 2 * frame)
        video.currentTime = leader.currentTime;
    if (!leader.paused) requestAnimationFrame(follow);
  };
  leader.addEventListener('play', () => requestAnimationFrame(follow));
  leader.addEventListener('ended', () => { seek(0); start(); });
  play.addEventListener('click', toggle);
  document.getElementById('back').addEventListener('click', () => step(-1));
  document.getElementById('forward').addEventListener('click', () => step(1));
  document.addEventListener('keydown', (event) => {
    if (event.target.closest('input, button, a, summary, [tabindex]') || event.ctrlKey ||
        event.metaKey || event.altKey) return;
    const act = {' ': toggle, ArrowLeft: () => step(-1), ArrowRight: () => step(1)}[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
  if (line) {
    scrub.addEventListener('input', () => { pause(); seek(Number(scrub.value)); });
    const plot = line.querySelector('.plot');
    const drag = (event) => {
      if (!(event.buttons & 1)) return;
      const box = plot.getBoundingClientRect();
      const share = ((event.clientX - box.left) / box.width - place.left) / (place.right - place.left);
      pause();
      seek(place.low + Math.min(1, Math.max(0, share)) * (place.high - place.low));
    };
    plot.addEventListener('pointerdown', drag);
    plot.addEventListener('pointermove', drag);
  }
  show(0);
  if (!matchMedia('(prefers-reduced-motion: reduce)').matches) start();
}
