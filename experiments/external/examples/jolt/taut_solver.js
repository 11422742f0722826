// The protocol taut-solver/1 for node 12 and later, without packages.
//
//     class Mine {
//       constructor(scene, params) {}  // scene: the scene file; params.iterations
//       load(x, v) {}                  // start here: Float64Array of 3n [m] and 3n [m/s]
//       step(t, dt) {}                 // advance from t to t + dt [s]
//       store() { return [x, v]; }     // 3n numbers each
//     }
//     Mine.about = {name: 'mine', version: '1.0',  // change the version with every change that alters results
//       params: {iterations: {type: 'integer', min: 1, max: 1000, default: 8, doc: 'Sweeps'}}};
//     require('./taut_solver').serve(Mine);
//
// Optional in about: summary, source; unmeasurable: 'it computes on a GPU' (then no cost is published). Optional static
// cannot(scene, params): reasons why the scene would be misread. Optional plan(): [{pass, items, repeats, bytes,
// projections}]; settings(): an object of texts. Standard output belongs to the protocol: console.log() goes to
// standard error here. MIT licence, as taut.
'use strict';
const fs = require('fs');

function serve(Solver) {
  console.log = console.info = console.error;
  let live = null, waiting = Buffer.alloc(0), bytes = Buffer.alloc(0);
  const piece = Buffer.alloc(1 << 16);
  const more = () => {  // false at the end of the input
    const got = fs.readSync(0, piece, 0, piece.length, null);
    waiting = Buffer.concat([waiting, piece.subarray(0, got)]);
    return got > 0;
  };
  const take = (count) => {
    while (waiting.length < count) if (!more()) process.exit(0);
    const taken = waiting.subarray(0, count);
    waiting = waiting.subarray(count);
    return taken;
  };
  const say = (buffer) => {
    for (let at = 0; at < buffer.length;) at += fs.writeSync(1, buffer, at);
  };
  const doubles = (buffer) => {  // a copy: a Float64Array has to be aligned
    const copy = new Uint8Array(buffer);
    return new Float64Array(copy.buffer, copy.byteOffset, copy.length / 8);
  };
  const cpu = () => {
    const {user, system} = process.cpuUsage();
    return 1000 * (user + system);
  };

  const known = {
    hello: () => ({protocol: 'taut-solver/1', params: {}, ...Solver.about}),
    scene: ({file, params}) => {
      const scene = JSON.parse(fs.readFileSync(file, 'utf8'));
      const cannot = Solver.cannot ? Solver.cannot(scene, params) : [];
      if (cannot.length > 0) return {cannot};
      live = new Solver(scene, params);
      return {
        vertices: scene.vertices,
        ...(live.plan && {plan: live.plan()}),
        ...(live.settings && {settings: live.settings()}),
      };
    },
    load: (request) => {
      const all = doubles(take(request.bytes)), half = all.length / 2;
      live.load(all.slice(0, half), all.slice(half));
      return {};
    },
    step: ({t, dt, count}) => {
      const before = cpu();
      for (let k = 0; k < count; ++k) live.step(t + k * dt, dt);
      return {cpu_ns: cpu() - before};
    },
    store: () => {
      bytes = Buffer.concat(live.store().map((values) => Buffer.from(Float64Array.from(values).buffer)));
      return {bytes: bytes.length};
    },
  };
  for (;;) {
    let end;
    while ((end = waiting.indexOf(10)) < 0) if (!more()) process.exit(0);
    const line = take(end + 1).toString();
    bytes = Buffer.alloc(0);
    let answer;
    try {
      const request = JSON.parse(line);
      if (!Object.hasOwnProperty.call(known, request.op)) throw new Error(`unknown op ${request.op}`);
      answer = known[request.op](request);
    } catch (error) {
      answer = {error: `${error.name}: ${error.message}`};
    }
    say(Buffer.concat([Buffer.from(JSON.stringify(answer) + '\n'), bytes]));
  }
}

module.exports = {serve};
