#!/usr/bin/env node
// The soft body of Jolt Physics (npm jolt-physics, MIT) as a solver in float32. It uses the scene's vertices, edges,
// rest lengths and inverse masses, with compliance 0. experiments/external/README.md says how to register it.
//
// Colliders at rest are static bodies of the same shape (but a plane is a large box, and a body of triangles a
// MeshShape, which has no inside). All have the same friction coefficient.
//
// Jolt's "iterations" are substeps of one sweep each, without multipliers. Optimize() is obligatory and reorders the
// edges; pins have to be set before it is called.
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
  layers.EnableCollision(0, 0);
  broad.MapObjectToBroadPhaseLayer(0, new Jolt.BroadPhaseLayer(0));
  settings.mObjectLayerPairFilter = layers;
  settings.mBroadPhaseLayerInterface = broad;
  settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(broad, 1, layers, 1);
  const system = new Jolt.JoltInterface(settings).GetPhysicsSystem();
  const bodies = system.GetBodyInterface();

  const vector = ([x, y, z]) => new Jolt.Vec3(x, y, z);

  function surface(vertices, triangles) {
    const list = new Jolt.TriangleList();
    for (const corners of triangles) {
      const [a, b, c] = corners.map((corner) => vector(vertices[corner])), triangle = new Jolt.Triangle(a, b, c);
      list.push_back(triangle);
      for (const made of [a, b, c, triangle]) Jolt.destroy(made);
    }
    const settings = new Jolt.MeshShapeSettings(list), made = settings.Create();
    if (made.HasError()) throw new Error(made.GetError().c_str());
    Jolt.destroy(list);
    return made.Get();
  }

  /// A static body for a collider, not yet added to the system.
  function still({type, normal, offset, center, radius, half_extents: half, rotation, vertices, triangles, friction}) {
    let shape, at, turned = Jolt.Quat.prototype.sIdentity();
    if (type === 'ball') {
      shape = new Jolt.SphereShape(radius);
      at = center;
    } else if (type === 'box' || type === 'mesh') {
      shape = type === 'box' ? new Jolt.BoxShape(vector(half), 0, null) : surface(vertices, triangles);
      at = center;
      turned = new Jolt.Quat(rotation[1], rotation[2], rotation[3], rotation[0]);
    } else {  // a box whose upper side is the plane
      const kDeep = 50;
      shape = new Jolt.BoxShape(new Jolt.Vec3(kDeep, kDeep, kDeep), 0, null);
      at = normal.map((n) => n * (offset - kDeep));
      turned = Jolt.Quat.prototype.sFromTo(new Jolt.Vec3(0, 1, 0), vector(normal));
    }
    const settings = new Jolt.BodyCreationSettings(shape, new Jolt.RVec3(...at), turned, Jolt.EMotionType_Static, 0);
    settings.mFriction = friction;
    settings.mRestitution = 0;
    return bodies.CreateBody(settings).GetID();
  }

  class Cloth {
    static cannot(scene) {
      const mapped = (c) => !c.motion && !c.frames && ['plane', 'ball', 'box', 'mesh'].includes(c.type);
      const effects = {
        'colliders that move or deform, capsules': !scene.colliders.every(mapped),
        'several frictions': new Set(scene.colliders.map((c) => c.friction)).size > 1,
        wind: scene.wind,
        'self-collision': scene.self_collision,
        'moving pins': scene.pin_motions.length > 0,
        damping: scene.damping > 0,
        'elastic links': scene.stiffness,
        bending: scene.bending,
      };
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
      const touches = scene.colliders.length > 0;
      if (touches) shared.mVertexRadius = scene.thickness;  // up to Jolt 0.36; since 0.37 it belongs to the creation settings
      shared.Optimize();
      const origin = new Jolt.RVec3(0, 0, 0), upright = Jolt.Quat.prototype.sIdentity();
      const creation = new Jolt.SoftBodyCreationSettings(shared, origin, upright, 0);
      Object.assign(creation, {
        mNumIterations: params.substeps,
        mUpdatePosition: false,
        mLinearDamping: 0,
        mVertexRadius: touches ? scene.thickness : 0,
        mAllowSleeping: false,
        mMaxLinearVelocity: 1e6,
      });
      if (touches) creation.mFriction = scene.colliders[0].friction;
      for (const id of live.splice(0)) {
        bodies.RemoveBody(id);
        bodies.DestroyBody(id);
      }
      this.body = bodies.CreateSoftBody(creation);
      live.push(this.body.GetID());
      for (const collider of scene.colliders) live.push(still(collider));
      for (const id of live) bodies.AddBody(id, Jolt.EActivation_Activate);
      system.SetGravity(new Jolt.Vec3(...scene.gravity));
      this.motion = Jolt.castObject(this.body.GetMotionProperties(), Jolt.SoftBodyMotionProperties);
      this.n = scene.vertices;
      this.links = scene.links.length;
      this.substeps = params.substeps;
    }

    /// Index of vertex 0 in HEAPF32. Not cached, since the memory may have grown since the last call.
    at() { return Jolt.getPointer(this.motion.GetVertex(0)) / 4; }

    load(x, v) {
      for (let i = 0, at = this.at(); i < this.n; ++i, at += kStride)
        for (let k = 0; k < 3; ++k) {
          Jolt.HEAPF32[at + kPosition + k] = x[3 * i + k];
          Jolt.HEAPF32[at + k] = x[3 * i + k];  // the previous position
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
    settings() {
      return {
        precision: 'float32',
        order: 'as Optimize() sorts the edges',
        projection: 'exact, compliance 0',
      };
    }
  }
  const {version} = JSON.parse(fs.readFileSync(path.join(kPackage, 'package.json')));
  Cloth.about = {
    protocol: 'taut-solver/3',
    name: 'jolt',
    version: `jolt-physics ${version}`,
    summary: "Jolt Physics' soft body: XPBD edges without compliance",
    source: 'J. Rouwe, Jolt Physics; npm jolt-physics',
    params: {
      substeps: {
        type: 'integer',
        min: 1,
        max: 10000,
        default: 5,
        doc: "Jolt's mNumIterations: substeps of one sweep each",
      },
    },
  };
  const live = [];  // ids of bodies
  serve(Cloth);
}

import(pathToFileURL(path.join(kPackage, 'dist', 'jolt-physics.wasm-compat.js')).href)
  .then((module) => module.default()).then(start)
  .catch((error) => {
    console.error(`${error.stack}`);
    process.exit(1);
  });
