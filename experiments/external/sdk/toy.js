#!/usr/bin/env node
// Jakobsen's algorithm (Advanced Character Physics, GDC 2001), link after link: a complete solver.
'use strict';

class Toy {
  static cannot(scene) {
    return scene.colliders.length > 0 || scene.wind || scene.self_collision || scene.pin_motions.length > 0 || scene.damping > 0
      ? ['gravity, links and pins at rest are all that it knows'] : [];
  }

  constructor(scene, params) {
    Object.assign(this, {w: scene.inverse_mass, links: scene.links, gravity: scene.gravity, dt: scene.dt, sweeps: params.iterations});
  }

  load(x, v) {
    this.x = x;
    this.before = x.map((a, k) => a - this.dt * v[k]);
  }

  step(t, dt) {
    const {x, before, w, gravity} = this;
    for (let k = 0; k < x.length; ++k) {  // Verlet; a pin has the inverse mass 0
      const now = x[k];
      if (w[Math.floor(k / 3)] > 0) x[k] += now - before[k] + dt * dt * gravity[k % 3];
      before[k] = now;
    }
    for (let sweep = 0; sweep < this.sweeps; ++sweep)
      for (const [a, b, rest] of this.links) {  // each gets its rest length in turn
        const i = 3 * a, j = 3 * b, both = w[a] + w[b];
        const d = [x[j] - x[i], x[j + 1] - x[i + 1], x[j + 2] - x[i + 2]];
        const length = Math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        if (both === 0 || length === 0) continue;
        const share = (length - rest) / (length * both);
        for (let k = 0; k < 3; ++k) {
          x[i + k] += w[a] * share * d[k];
          x[j + k] -= w[b] * share * d[k];
        }
      }
  }

  store() { return [this.x, this.x.map((a, k) => (a - this.before[k]) / this.dt)]; }
  plan() { return [{pass: 'links', items: this.links.length, repeats: this.sweeps, projections: true}]; }
  settings() { return {projection: 'exact', precision: 'double'}; }
}
Toy.about = {
  name: 'toy-node', version: '1', summary: "Jakobsen's algorithm in JavaScript",
  source: 'Jakobsen, Advanced Character Physics, GDC 2001',
  params: {iterations: {type: 'integer', min: 0, max: 1000000, default: 8, doc: 'Sweeps over all links in a step'}},
};

require('./taut_solver').serve(Toy);
