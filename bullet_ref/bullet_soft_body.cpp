// Bullet's btSoftBody with its Positions solver, which is Jakobsen's algorithm under another name.
// Statements that look odd answer traps that bullet_ref/README.md describes.
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <algorithm>
#include <cmath>

#include "bullet_ref/cloth_builder.hpp"
#include "bullet_ref/common_params.hpp"
#include "bullet_ref/convert.hpp"
#include "bullet_ref/read_back.hpp"
#include "bullet_ref/rigid_colliders.hpp"
#include "core/model/solver.hpp"
#include "core/model/wind.hpp"

namespace taut::solver::bullet_soft_body {

namespace {

using Kind = ParamSpec::Kind;
constexpr ParamSpec kParams[] = {
    {.name = "iterations",
     .kind = Kind::integer,
     .default_value = "3",
     .min = 0,
     .max = 1e6,
     .help = "m_cfg.piterations: sweeps over contacts and links per substep (Bullet's default: 1)"},
    bullet_param::substeps,
    bullet_param::precision,
    {.name = "order",
     .kind = Kind::choice,
     .default_value = "contacts-first",
     .choices = "contacts-first|links-first",
     .help = "passes of one sweep: Bullet's own order, or ours (m_psequence)"},
    {.name = "stiffness",
     .kind = Kind::real,
     .default_value = "1",
     .min = 1e-6,
     .max = 2,
     .help = "kLST: share of a link's error that one projection removes; above 1 over-relaxes"},
    {.name = "hardness",
     .kind = Kind::real,
     .default_value = "0.1",
     .min = 0,
     .max = 1,
     .help = "kKHR: share of the penetration that one contact pass removes; 0.1 is Bullet's own"},
    bullet_param::margin,
    {.name = "voxel",
     .kind = Kind::real,
     .unit = "m",
     .default_value = "0.05",
     .min = 1e-3,
     .max = 10,
     .help = "grid spacing of the colliders' distance fields (Bullet's default: 0.25)"},
    {.name = "friction",
     .kind = Kind::choice,
     .default_value = "own",
     .choices = "refuse|own",
     .help = "a scene with friction: refuse it, or use Bullet's own law, which is not Coulomb's"},
    {.name = "faces",
     .kind = Kind::choice,
     .default_value = "on",
     .choices = "on|off",
     .help = "off: no faces, so that Bullet does not compute normals, which we do not either"},
};

/// A world with nothing in it; the order of members is the order in which Bullet wants them built.
struct World {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btSoftRigidDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
};

void configure_body(btSoftBody& body, const Scene& scene, const Params& params) {
  btSoftBody::Config& c = body.m_cfg;
  c.piterations = params.integer("iterations");
  c.viterations = c.diterations = c.citerations = 0;
  const double h = static_cast<double>(substep_length(scene, params));
  c.kDP = static_cast<btScalar>(-std::expm1(-scene.damping * h));
  c.kDG = c.kLF = c.kPR = c.kVC = c.kMT = 0;
  c.timescale = 1;
  c.kDF = 1;  // so that a collider's friction is what the scene says
  c.kKHR = c.kCHR = static_cast<btScalar>(params.real("hardness"));
  c.collisions = scene.colliders.empty() ? 0 : btSoftBody::fCollision::SDF_RS;
  if (params.is("order", "links-first")) {
    c.m_psequence.clear();
    c.m_psequence.push_back(btSoftBody::ePSolver::Linear);
    c.m_psequence.push_back(btSoftBody::ePSolver::RContacts);
  }
}

class BulletSoftBody final : public Solver, public HoldsScene {
 public:
  BulletSoftBody(const Scene& scene, const Params& params)
      : scene_(scene),
        margin_(params.real("margin")),
        iterations_(params.integer("iterations")),
        substeps_(params.integer("substeps")),
        h_(static_cast<btScalar>(substep_length(scene, params))),
        colliders_(scene, world_.world) {
    world_.world.setGravity(to_bullet(scene.gravity));  // does not reach soft bodies
    configure_world_info(world_.world.getWorldInfo(), scene, params.real("voxel"));
    body_ = build_cloth(world_.world.getWorldInfo(), scene, params.real("stiffness"), margin_,
                        params.is("faces", "on"));
    configure_body(*body_, scene, params);
    world_.world.addSoftBody(body_.get());
    load(scene.start);
  }
  ~BulletSoftBody() override { world_.world.removeSoftBody(body_.get()); }

  void load(const State& state) override {
    // Bullet damps a velocity when it makes one, we when we use it; store() undoes this.
    const btScalar keep = 1 - body_->m_cfg.kDP;
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      btSoftBody::Node& n = node(i);
      const btVector3 v = to_bullet(state.v[i]);
      n.m_x = to_bullet(state.x[i]);
      n.m_q = n.m_x - v * h_;
      n.m_v = n.m_im > 0 ? v * keep : btVector3(0, 0, 0);  // a pin with a velocity drifts
      n.m_f.setZero();
    }
    body_->updateBounds();
  }

  void step(double t, double dt) override {
    const double h = dt / substeps_;
    for (int s = 0; s < substeps_; ++s) substep(t + s * h, t + (s + 1) * h);
  }

  void store(State& state) const override {
    state.x.resize(scene_.start.x.size()), state.v.resize(state.x.size());
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      const btSoftBody::Node& n = node(i);
      state.x[i] = from_bullet(n.m_x);
      state.v[i] = from_bullet((n.m_x - n.m_q) / h_);
    }
  }

  std::vector<PassCost> step_cost() const override;
  Scene read_back() const override;

 private:
  void substep(double from, double to) {
    if (scene_.wind) blow();
    colliders_.move(from, to);
    if (scene_.pin_motions.empty()) {
      world_.world.stepSimulation(h_, 0);  // with its default arguments it would step by 1/60 s
      return;
    }
    std::vector<btVector3> before;
    for (const int pin : scene_.pins) {
      btSoftBody::Node& n = node(static_cast<std::size_t>(pin));
      before.push_back(n.m_x);
      n.m_x = to_bullet(pin_position(scene_, pin, to));
    }
    world_.world.stepSimulation(h_, 0);
    for (std::size_t p = 0; p < scene_.pins.size(); ++p)  // their velocity, for wind and store()
      node(static_cast<std::size_t>(scene_.pins[p])).m_q = before[p];
  }

  /// Bullet's own wind gives no force on a cloth at rest, so each node gets its share of ours.
  void blow() {
    for (const auto& [a, b, c] : scene_.mesh.triangles) {
      const btSoftBody::Node &na = body_->m_nodes[a], &nb = body_->m_nodes[b],
                             &nc = body_->m_nodes[c];
      const btVector3 moved = na.m_x - na.m_q + nb.m_x - nb.m_q + nc.m_x - nc.m_q;
      const btVector3 force = to_bullet(
          wind_on_corner(*scene_.wind, from_bullet(na.m_x), from_bullet(nb.m_x),
                         from_bullet(nc.m_x), from_bullet(moved) / static_cast<double>(3 * h_)));
      for (const int corner : {a, b, c}) body_->addForce(force, corner);
    }
  }

  btSoftBody::Node& node(std::size_t i) { return body_->m_nodes[static_cast<int>(i)]; }
  const btSoftBody::Node& node(std::size_t i) const { return body_->m_nodes[static_cast<int>(i)]; }

  Scene scene_;
  double margin_;
  int iterations_;
  int substeps_;
  btScalar h_;
  World world_;
  RigidColliders colliders_;
  std::unique_ptr<btSoftBody> body_;
};

template <class T>
std::size_t held(const btAlignedObjectArray<T>& array) {
  return static_cast<std::size_t>(array.capacity()) * sizeof(T);
}

std::vector<PassCost> BulletSoftBody::step_cost() const {
  const btSoftBody& b = *body_;
  const auto n = static_cast<std::size_t>(b.m_nodes.size());
  const auto per_step = static_cast<std::size_t>(substeps_);
  const std::size_t sweeps = per_step * static_cast<std::size_t>(iterations_);
  std::size_t links = 0;
  for (int i = 0; i < b.m_links.size(); ++i) links += b.m_links[i].m_c0 > 0;

  std::vector<PassCost> costs;
  if (scene_.wind)
    costs.push_back({.pass = "wind",
                     .items = scene_.mesh.triangles.size(),
                     .repeats = per_step,
                     .bytes = scene_.mesh.triangles.size() * sizeof(Triangle)});
  costs.push_back(
      {.pass = "predict and update tree", .items = n, .repeats = per_step, .bytes = node_bytes(b)});
  if (!scene_.colliders.empty()) {
    costs.push_back({.pass = "detect contacts",
                     .items = n * scene_.colliders.size(),
                     .repeats = per_step,
                     .bytes = distance_field_bytes(b) + colliders_.bytes()});
    costs.push_back({.pass = "contacts",
                     .items = static_cast<std::size_t>(b.m_rcontacts.size()),
                     .repeats = sweeps,
                     .bytes = held(b.m_rcontacts)});
  }
  if (links > 0)
    costs.push_back({.pass = "links",
                     .items = links,
                     .repeats = sweeps,
                     .bytes = held(b.m_links),
                     .projections = true});
  if (b.m_faces.size() > 0)
    costs.push_back({.pass = "normals",
                     .items = static_cast<std::size_t>(b.m_faces.size()),
                     .repeats = per_step,
                     .bytes = held(b.m_faces)});
  return costs;
}

Scene BulletSoftBody::read_back() const {
  const btSoftBody& b = *body_;
  Scene scene;
  read_back_cloth(b, RestLength::m_c1, scene);
  store(scene.start);
  scene.colliders = colliders_.read_back(0);
  scene.damping = -std::log1p(-static_cast<double>(b.m_cfg.kDP)) / static_cast<double>(h_);
  scene.thickness = static_cast<double>(b.getCollisionShape()->getMargin()) - margin_;
  scene.dt = static_cast<double>(h_) * substeps_;
  // Bullet has no place for these; the adapter applies them at each substep.
  scene.pin_motions = scene_.pin_motions;
  scene.wind = scene_.wind;
  scene.steps = scene_.steps;
  return scene;
}

std::unique_ptr<Solver> make(const Scene& scene, const Params& params) {
  require_program("bullet", params);
  return std::make_unique<BulletSoftBody>(scene, params);
}

std::vector<std::string> unsupported(const Scene& scene, const Params& params) {
  std::vector<std::string> reasons;
  if (scene.self_collision)
    reasons.push_back(
        "self-collision: btSoftBody leaves itself out of its vertex-face test (VF_SS)");
  const auto rubs = [](const Collider& c) { return c.friction > 0; };
  if (params.is("friction", "refuse") &&
      std::any_of(scene.colliders.begin(), scene.colliders.end(), rubs))
    reasons.push_back(
        "friction: btSoftBody's does not depend on the load (friction=own accepts that)");
  const auto beyond = [](const Collider& c) { return c.friction > 1; };
  if (params.is("friction", "own") &&
      std::any_of(scene.colliders.begin(), scene.colliders.end(), beyond))
    reasons.push_back("friction above 1 turns btSoftBody's tangential motion around");
  if (params.integer("iterations") == 0 && scene.damping > 0)
    reasons.push_back("damping: without iterations btSoftBody skips it");
  if (static_cast<btScalar>(substep_length(scene, params)) <= SIMD_EPSILON)
    reasons.push_back("stepSimulation ignores a substep this short");
  return reasons;
}

ResolvedSettings resolved_settings(const Scene& scene, const Params& params) {
  const double h = static_cast<double>(substep_length(scene, params));
  ResolvedSettings lines = {
      library_line(params),
      time_step_line(scene, params),
      {"precision", std::string(params.choice("precision"))},
      {"integration", "symplectic Euler; the same positions as Verlet"},
      {"projection",
       "sqrt-free, weighted by inverse mass, kLST " + short_text(params.real("stiffness"))},
      {"link order", "the scene's"},
      {"gravity", "the scene's (soft bodies' own default: -10 m/s^2 in y)"},
      {"damping", "kDP " + short_text(-std::expm1(-scene.damping * h)) + " per substep"},
      {"normals", params.is("faces", "on") ? "computed every substep" : "off"},
  };
  if (scene.wind)
    lines.emplace_back("wind", "our face law through addForce; Bullet's own medium is empty");
  if (scene.colliders.empty()) return lines;
  lines.emplace_back("order of passes", params.is("order", "links-first")
                                            ? "links, then contacts"
                                            : "contacts, then links (Bullet's own)");
  lines.emplace_back("contacts", "vertices only, found once per substep at the predicted place");
  lines.emplace_back("margin",
                     short_text(scene.thickness + params.real("margin")) + " m (default 0.25)");
  lines.emplace_back("distance field",
                     "trilinear, voxel " + short_text(params.real("voxel")) + " m (default 0.25)");
  lines.emplace_back("contact hardness", "kKHR " + short_text(params.real("hardness")));
  lines.emplace_back("friction", params.is("friction", "own")
                                     ? "tangential motion x (1 - mu) per contact pass"
                                     : "none");
  for (const Collider& collider : scene.colliders)
    if (std::holds_alternative<Plane>(collider.shape))
      lines.emplace_back("plane", "the top of a box of 100 m x 10 m x 100 m");
  return lines;
}

std::string_view program(const Params& params) {
  return bullet_program(params.choice("precision"));
}

constexpr AccuracyKnobs::Ladder kAlternatives[] = {{"precision", "float|double"}};

LinearModel linear_model(const Scene& scene, const Params& params) {
  if (scene.damping != 0) return {};
  return LinearSweeps{.omega = params.real("stiffness"),
                      .sweeps = params.integer("iterations"),
                      .substeps = params.integer("substeps")};
}

}  // namespace
}  // namespace taut::solver::bullet_soft_body

TAUT_SOLVER(bullet) = {.name = "bullet",
                       .summary = "Bullet's btSoftBody, Positions solver",
                       .source = "Bullet Physics 3.24, btSoftRigidDynamicsWorld",
                       .params = taut::solver::bullet_soft_body::kParams,
                       .make = taut::solver::bullet_soft_body::make,
                       .unsupported = taut::solver::bullet_soft_body::unsupported,
                       .resolved_settings = taut::solver::bullet_soft_body::resolved_settings,
                       .program = taut::solver::bullet_soft_body::program,
                       .knobs = {.substeps = "substeps",
                                 .sweeps = "iterations",
                                 .alternatives = taut::solver::bullet_soft_body::kAlternatives},
                       .linear_model = taut::solver::bullet_soft_body::linear_model};
