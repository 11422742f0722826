#!/usr/bin/env node
// Jolt Physics' soft body (npm jolt-physics 1.1.0, MIT) as a solver: vertices, edges, rest lengths and inverse masses of
// the scene, compliance 0, float32. experiments/external/README.md says how to register it.
//
// Jolt's "iterations" are substeps of one sweep each, without multipliers. Its Optimize() is obligatory and reorders
// the edges; pins have to be set before it.
'use strict';
const fs = require('fs');
const path = require('path');
const {pathToFileURL} = require('url');
const {serve} = require('./taut_solver');

const kStride = 80 / 4, kPosition = 16 / 4, kVelocity = 32 / 4;  // of a vertex in HEAPF32, in floats
const kPackage = path.join(__dirname, 'node_modules', 'jolt-physics');

function start(Jolt) {
  const settings = new Jolt.JoltSettings();
  const layers = new Jolt.ObjectLayerPairFilterTable(1), broad = new Jolt.BroadPhaseLayerInterfaceTable(1, 1);
  broad.MapObjectToBroadPhaseLayer(0, new Jolt.BroadPhaseLayer(0));
  settings.mObjectLayerPairFilter = layers;
  settings.mBroadPhaseLayerInterface = broad;
  settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(broad, 1, layers, 1);
  const engine = new Jolt.JoltInterface(settings), system = engine.GetPhysicsSystem(), bodies = system.GetBodyInterface();

  class Cloth {
    static cannot(scene) {
      const effects = {colliders: scene.colliders.length > 0, wind: scene.wind, 'self-collision': scene.self_collision,
        'moving pins': scene.pin_motions.length > 0, damping: scene.damping > 0};
      const present = Object.keys(effects).filter((name) => effects[name]);
      return present.length > 0 ? [`${present.join(', ')}: not mapped to Jolt`] : [];
    }

    constructor(scene, params) {
      const shared = new Jolt.SoftBodySharedSettings(), vertex = new Jolt.SoftBodySharedSettingsVertex();
      scene.x.forEach(([x, y, z], i) => {
        vertex.mPosition = new Jolt.Float3(x, y, z);
        vertex.mInvMass = scene.inverse_mass[i];
        shared.mVertices.push_back(vertex);
      });
      for (const [a, b, rest] of scene.links) {
        const edge = new Jolt.SoftBodySharedSettingsEdge(a, b, 0);
        edge.mRestLength = rest;
        shared.mEdgeConstraints.push_back(edge);
        Jolt.destroy(edge);
      }
      shared.Optimize();
      const creation = new Jolt.SoftBodyCreationSettings(shared, new Jolt.RVec3(0, 0, 0), Jolt.Quat.prototype.sIdentity(), 0);
      Object.assign(creation, {mNumIterations: params.substeps, mUpdatePosition: false, mLinearDamping: 0, mVertexRadius: 0,
        mAllowSleeping: false, mMaxLinearVelocity: 1e6});
      if (live) bodies.RemoveBody(live), bodies.DestroyBody(live);
      this.body = bodies.CreateSoftBody(creation);
      live = this.body.GetID();
      bodies.AddBody(live, Jolt.EActivation_Activate);
      system.SetGravity(new Jolt.Vec3(...scene.gravity));
      this.motion = Jolt.castObject(this.body.GetMotionProperties(), Jolt.SoftBodyMotionProperties);
      this.n = scene.vertices, this.links = scene.links.length, this.substeps = params.substeps;
    }

    /// Where vertex 0 lies; memory may have grown since the last call.
    at() { return Jolt.getPointer(this.motion.GetVertex(0)) / 4; }

    load(x, v) {
      for (let i = 0, at = this.at(); i < this.n; ++i, at += kStride)
        for (let k = 0; k < 3; ++k) {
          Jolt.HEAPF32[at + kPosition + k] = Jolt.HEAPF32[at + k] = x[3 * i + k];  // and the position before
          Jolt.HEAPF32[at + kVelocity + k] = v[3 * i + k];
        }
    }

    step(t, dt) { this.motion.CustomUpdate(dt, this.body, system); }

    store() {
      const x = new Float64Array(3 * this.n), v = new Float64Array(3 * this.n);
      for (let i = 0, at = this.at(); i < this.n; ++i, at += kStride)
        for (let k = 0; k < 3; ++k) {
          x[3 * i + k] = Jolt.HEAPF32[at + kPosition + k];
          v[3 * i + k] = Jolt.HEAPF32[at + kVelocity + k];
        }
      return [x, v];
    }

    plan() { return [{pass: 'edges', items: this.links, repeats: this.substeps, projections: true}]; }
    settings() { return {precision: 'float32', order: 'as Optimize() sorts the edges', projection: 'exact, compliance 0'}; }
  }
  Cloth.about = {
    name: 'jolt', version: `jolt-physics ${JSON.parse(fs.readFileSync(path.join(kPackage, 'package.json'))).version}`,
    summary: "Jolt Physics' soft body: XPBD edges without compliance", source: 'J. Rouwe, Jolt Physics; npm jolt-physics 1.1.0',
    params: {substeps: {type: 'integer', min: 1, max: 10000, default: 5, doc: "Jolt's mNumIterations: substeps of one sweep each"}},
  };
  let live = null;
  serve(Cloth);
}

import(pathToFileURL(path.join(kPackage, 'dist', 'jolt-physics.wasm-compat.js')).href)
  .then((module) => module.default()).then(start)
  .catch((error) => { console.error(`${error.stack}`); process.exit(1); });
