// Bullet's btSoftBody with its Positions solver, which is Jakobsen's algorithm under another name.
// bullet_ref/README.md explains statements that look odd.
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <algorithm>
#include <cmath>

#include "bullet_ref/bullet_solver.hpp"
#include "core/model/text.hpp"
#include "core/model/wind.hpp"

namespace taut::solver::bullet_soft_body {

namespace {

constexpr ParamSpec kParams[] = {
    ParamSpec::integer(
        "iterations", "3", 0, 1e6,
        "m_cfg.piterations: sweeps over contacts and links per substep (Bullet's default: 1)"),
    bullet_ref::kSubsteps,
    bullet_ref::kPrecision,
    ParamSpec::choice("order", "contacts-first", "contacts-first|links-first",
                      "passes of one sweep: Bullet's own order, or ours (m_psequence)"),
    ParamSpec::real(
        "stiffness", "", "1", 1e-6, 2,
        "kLST: share of a link's error that one projection removes; above 1 over-relaxes"),
    ParamSpec::real(
        "hardness", "", "0.1", 0, 1,
        "kKHR: share of the penetration that one contact pass removes; 0.1 is Bullet's own")
        .as(ParamSpec::Role::contact_share),
    bullet_ref::kMargin,
    bullet_ref::kVoxel,
    ParamSpec::choice(
        "friction", "own", "refuse|own",
        "in scenes with friction: refuse them, or use Bullet's own law, which is not Coulomb's"),
    ParamSpec::choice(
        "faces", "on", "on|off",
        "off: no faces, so that Bullet computes no normals; our solvers compute none, either"),
    ParamSpec::choice(
        "reorder", "off", "off|on",
        "on: links in the order of Bullet's ReoptimizeLinkOrder, the same at every vertex"),
};

/// An empty world. Its members are in the order in which Bullet wants them built.
struct World {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  bullet_ref::BoundedWorld<btSoftRigidDynamicsWorld> world{&dispatcher, &broadphase, &solver,
                                                           &configuration};
};

void configure_body(btSoftBody& body, const Scene& scene, const Params& params) {
  btSoftBody::Config& c = body.m_cfg;
  c.piterations = params.integer("iterations");
  c.viterations = c.diterations = c.citerations = 0;
  const double h = static_cast<double>(bullet_ref::substep_length(scene, params));
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

ClothOptions options(const Params& params) {
  return {.stiffness = params.real("stiffness"),
          .margin = params.real("margin"),
          .faces = params.is("faces", "on"),
          .reorder = params.is("reorder", "on")};
}

class BulletSoftBody final : World, public BulletSolver {
 public:
  BulletSoftBody(const Scene& scene, const Params& params)
      : BulletSolver(scene, params, world, world.getWorldInfo(), options(params)),
        iterations_(params.integer("iterations")),
        reordered_(params.is("reorder", "on")) {
    configure_body(*body_, scene, params);
    world.addSoftBody(body_.get());
    load(scene.start);
  }
  ~BulletSoftBody() override { world.removeSoftBody(body_.get()); }

  void load(const State& state) override {
    // Bullet damps a velocity when it makes one, taut when it uses it; store() undoes this.
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

  void store(State& state) const override {
    state.x.resize(scene_.start.x.size());
    state.v.resize(state.x.size());
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      const btSoftBody::Node& n = node(i);
      state.x[i] = from_bullet(n.m_x);
      state.v[i] = from_bullet((n.m_x - n.m_q) / h_);
    }
  }

  Scene read_back() const override {
    Scene scene = held_scene(RestLength::m_c1);
    scene.damping = -std::log1p(-static_cast<double>(body_->m_cfg.kDP)) / static_cast<double>(h_);
    return scene;
  }

 private:
  std::vector<PassCost> solve_cost() const override;

  void substep(double from, double to) override {
    if (scene_.wind) blow();
    move_colliders(from, to);
    if (scene_.pin_motions.empty()) {
      world.stepSimulation(h_, 0);
      return;
    }
    std::vector<btVector3> before;
    for (const int pin : scene_.pins) {
      btSoftBody::Node& n = node(static_cast<std::size_t>(pin));
      before.push_back(n.m_x);
      n.m_x = to_bullet(pin_position(scene_, pin, to));
    }
    world.stepSimulation(h_, 0);
    for (std::size_t p = 0; p < scene_.pins.size(); ++p)  // their velocity, for wind and store()
      node(static_cast<std::size_t>(scene_.pins[p])).m_q = before[p];
  }

  /// Applies the wind to each node, because Bullet's own wind gives no force on a cloth at rest.
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

  int iterations_;
  bool reordered_;
};

template <class T>
std::size_t held(const btAlignedObjectArray<T>& array) {
  return static_cast<std::size_t>(array.capacity()) * sizeof(T);
}

std::vector<PassCost> BulletSoftBody::solve_cost() const {
  const btSoftBody& b = *body_;
  const std::size_t sweeps =
      static_cast<std::size_t>(substeps_) * static_cast<std::size_t>(iterations_);
  std::size_t links = 0;
  for (int i = 0; i < b.m_links.size(); ++i) links += b.m_links[i].m_c0 > 0;
  std::vector<PassCost> costs;
  if (!scene_.colliders.empty())
    costs.push_back({.pass = "contacts",
                     .items = static_cast<std::size_t>(b.m_rcontacts.size()),
                     .repeats = sweeps,
                     .bytes = held(b.m_rcontacts)});
  if (links > 0)
    costs.push_back({.pass = reordered_ ? "links, reordered" : "links",
                     .items = links,
                     .repeats = sweeps,
                     .bytes = held(b.m_links),
                     .projections = true});
  return costs;
}

/// The order of the links. For Bullet's own order also the number of links that wait for the one
/// before them, in the given order and in the order in which Bullet solves them.
ResolvedSettings link_order(const Scene& scene, const Params& params) {
  if (!params.is("reorder", "on")) return {{kLinkOrder, "the scene's", "mesh order"}};
  btSoftBodyWorldInfo info;
  const auto waiting = [&](bool reorder) {
    const auto body = build_cloth(info, scene, {.faces = false, .reorder = reorder});
    return std::to_string(waiting_links(*body));
  };
  return {{kLinkOrder, "ReoptimizeLinkOrder, the same links at every vertex", "reordered"},
          {"links that wait", waiting(true) + " of " + std::to_string(scene.links.size()) +
                                  " share a vertex with the one before them (" + waiting(false) +
                                  " in the scene's order)"}};
}

std::unique_ptr<Solver> make(const Scene& scene, const Params& params) {
  bullet_ref::require_program("bullet", params);
  return std::make_unique<BulletSoftBody>(scene, params);
}

std::vector<std::string> unsupported(const Scene& scene, const Params& params) {
  std::vector<std::string> reasons = bullet_ref::unsupported(scene, params);
  for (std::string& reason : elastic_links(scene)) reasons.push_back(std::move(reason));
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
  return reasons;
}

ResolvedSettings resolved_settings(const Scene& scene, const Params& params) {
  const double h = static_cast<double>(bullet_ref::substep_length(scene, params));
  ResolvedSettings lines = bullet_ref::library_settings(scene, params);
  lines.insert(lines.end(), {{"integration", "symplectic Euler; the same positions as Verlet"},
                             {"projection", "sqrt-free, weighted by inverse mass, kLST " +
                                                general(params.real("stiffness"), 6)}});
  for (ResolvedSetting& line : link_order(scene, params)) lines.push_back(std::move(line));
  lines.insert(
      lines.end(),
      {{"gravity", "the scene's (soft bodies' own default: -10 m/s^2 in y)", "the scene's"},
       {"damping", "kDP " + general(-std::expm1(-scene.damping * h), 6) + " per substep"},
       {"normals", params.is("faces", "on") ? "computed every substep" : "off"}});
  if (scene.wind)
    lines.emplace_back("wind", "our face law through addForce; Bullet's own medium is empty");
  if (scene.colliders.empty()) return lines;
  lines.emplace_back("order of passes", params.is("order", "links-first")
                                            ? "links, then contacts"
                                            : "contacts, then links (Bullet's own)");
  lines.emplace_back("contacts", "vertices only, found once per substep at the predicted place");
  for (auto& line : bullet_ref::contact_settings(scene, params, "0.25")) lines.push_back(line);
  lines.emplace_back("contact hardness", "kKHR " + general(params.real("hardness"), 6));
  lines.emplace_back("friction",
                     params.is("friction", "own")
                         ? "holds if the predicted way along the surface in a substep is "
                           "less than mu times the way into it; else each contact pass "
                           "takes the share mu of it, whatever the load"
                         : "none");
  if (std::ranges::any_of(scene.colliders, [](const Collider& collider) {
        return std::holds_alternative<Plane>(collider.shape);
      }))
    lines.emplace_back("plane", "the top of a box of at least 100 m x 10 m x 100 m");
  return lines;
}

/// Alternatives like Jakobsen's omega and order, and ways of keeping cloth outside.
constexpr AccuracyParameters::Ladder kAlternatives[] = {
    {{"precision"}, {"float", "double"}},
    {{"reorder"}, {"off", "on"}},
    {{"faces"}, {"on", "off"}},
    {{"stiffness"}, {"1.2", "1.4", "1.6"}},
    {{"order"}, {"contacts-first", "links-first"}},
    {{"hardness"}, {"0.1", "0.4", "1"}}};

constexpr OptionalEffect kOptionalEffects[] = {{"normals", "faces", {"on", "off"}, true}};

LinearModel linear_model(const Scene& scene, const Params& params) {
  if (scene.damping != 0 || params.is("reorder", "on"))
    return {};  // linear theory assumes the scene's order
  return LinearSweeps{.omega = params.real("stiffness"),
                      .sweeps = params.integer("iterations"),
                      .substeps = params.integer("substeps")};
}

}  // namespace
}  // namespace taut::solver::bullet_soft_body

TAUT_SOLVER(bullet) = {
    .name = "bullet",
    .summary = "Bullet's btSoftBody, Positions solver",
    .source = "Bullet Physics 3.24, btSoftRigidDynamicsWorld",
    .params = taut::solver::bullet_soft_body::kParams,
    .make = taut::solver::bullet_soft_body::make,
    .unsupported = taut::solver::bullet_soft_body::unsupported,
    .resolved_settings = taut::solver::bullet_soft_body::resolved_settings,
    .declared_step = [](const taut::Scene&, const taut::Params&) -> taut::DeclaredStep {
      return {.none = "Bullet's step is another"};
    },
    .program = taut::bullet_ref::program,
    .accuracy = {.substeps = "substeps",
                 .sweeps = "iterations",
                 .link_order = "reorder",
                 .alternatives = taut::solver::bullet_soft_body::kAlternatives,
                 .labelled = {"substeps", "iterations", "stiffness", "order", "hardness",
                              "precision"},
                 .accelerators = {"stiffness"}},
    .optional_effects = taut::solver::bullet_soft_body::kOptionalEffects,
    .linear_model = taut::solver::bullet_soft_body::linear_model};
