// Bullet's newer cloth: btSoftBody in a btDeformableMultiBodyDynamicsWorld, with Hooke springs as
// links and an implicit Euler step (by default one Newton step with conjugate gradients).
// bullet_ref/README.md explains statements that look odd.
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableMassSpringForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>

#include <cmath>
#include <optional>

#include "bullet_ref/bullet_solver.hpp"
#include "core/model/index.hpp"
#include "core/model/text.hpp"
#include "core/model/wind.hpp"

namespace taut::solver::bullet_deformable {

namespace {

constexpr ParamSpec kParams[] = {
    ParamSpec::real(
        "stiffness", "N/m", "1000", 1e-6, 1e9,
        "spring constant of every link if the scene's links are rigid; stiffer links stretch less"),
    ParamSpec::choice("implicit", "true", "true|false",
                      "true: backward Euler, which by default explodes on contact (in every "
                      "shipped scene with colliders except tunnel) and may explode with pins, bend "
                      "links or initial velocities. false: explicit springs, stable below k h^2/m "
                      "of about 0.3 (substeps=70 runs these scenes)"),
    ParamSpec::integer("newton", "1", 1, 1000,
                       "Newton steps at most per implicit substep (Bullet's default: 1)"),
    bullet_ref::kSubsteps,
    bullet_ref::kPrecision,
    ParamSpec::real("spring-damping", "N s/m", "0", 0, 1e6,
                    "damping along every link, on top of the scene's (Bullet's default: 0.05)"),
    bullet_ref::kMargin,
    bullet_ref::kVoxel,
    kMaterial,
};

/// Stiffness of every link [N/m]; empty if the scene's links differ, since Bullet has one for all.
std::optional<double> stiffness(const Scene& scene, const Params& params) {
  if (!takes_stiffness(scene, params)) return params.real("stiffness");
  std::optional<double> one;
  for (const Link& link : scene.links) {
    const double k = scene.stiffness[static_cast<std::size_t>(link.family)];
    if (one.value_or(k) != k || std::isinf(k)) return {};
    one = k;
  }
  return one;
}

/// Bullet's solver with a given number of Newton steps, for which it has no setter.
struct DeformableSolver : btDeformableBodySolver {
  explicit DeformableSolver(int newton_steps) { m_maxNewtonIterations = newton_steps; }
};

/// An empty world. Its members are in the order in which Bullet wants them built.
struct World {
  explicit World(int newton_steps) : deformables(newton_steps) {
    constraints.setDeformableSolver(&deformables);
  }
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  DeformableSolver deformables;
  btDeformableMultiBodyConstraintSolver constraints;
  bullet_ref::BoundedWorld<btDeformableMultiBodyDynamicsWorld> world{
      &dispatcher, &broadphase, &constraints, &configuration, &deformables};
};

int newton_steps(const Params& params) {
  return params.is("implicit", "true") ? params.integer("newton") : 1;
}

class BulletDeformable final : World, public BulletSolver {
 public:
  BulletDeformable(const Scene& scene, const Params& params)
      : World(newton_steps(params)),
        BulletSolver(scene, params, world, world.getWorldInfo(), {.margin = params.real("margin")}),
        newton_(newton_steps(params)),
        loss_(static_cast<btScalar>(-std::expm1(-scene.damping * static_cast<double>(h_)))),
        springs_(static_cast<btScalar>(stiffness(scene, params).value()),
                 static_cast<btScalar>(params.real("spring-damping"))),
        gravity_(to_bullet(scene.gravity)) {
    world.setImplicit(params.is("implicit", "true"));
    world.setUseProjection(true);  // without it pinned implicit bodies do not move
    body_->m_cfg.drag = 0;
    body_->m_cfg.kDF = 1;  // so that a collider's friction is what the scene says
    body_->m_cfg.collisions =
        scene.colliders.empty() ? 0
                                : btSoftBody::fCollision::SDF_RD | btSoftBody::fCollision::SDF_RDN;
    world.addSoftBody(body_.get());
    world.addForce(body_.get(), &springs_);
    world.addForce(body_.get(), &gravity_);
    load(scene.start);
  }
  ~BulletDeformable() override { world.removeSoftBody(body_.get()); }

  void load(const State& state) override {
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      btSoftBody::Node& n = node(i);
      n.m_x = n.m_q = to_bullet(state.x[i]);
      set_velocity(n, n.m_im > 0 ? to_bullet(state.v[i]) : btVector3(0, 0, 0));
      n.m_f.setZero();
      n.m_splitv.setZero();
    }
    pin_velocity_.clear();
    for (const int pin : scene_.pins)
      pin_velocity_.push_back(to_bullet(state.v[static_cast<std::size_t>(pin)]));
    body_->updateBounds();
  }

  void store(State& state) const override {
    state.x.resize(scene_.start.x.size());
    state.v.resize(state.x.size());
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      state.x[i] = from_bullet(node(i).m_x);
      state.v[i] = from_bullet(node(i).m_v);
    }
    for (std::size_t p = 0; p < scene_.pins.size(); ++p)
      state.v[static_cast<std::size_t>(scene_.pins[p])] = from_bullet(pin_velocity_[p]);
  }

  Scene read_back() const override {
    Scene scene = held_scene(RestLength::m_rl);
    scene.gravity = from_bullet(gravity_.m_gravity);
    scene.damping = -std::log1p(-static_cast<double>(loss_)) / static_cast<double>(h_);
    return scene;
  }

 private:
  std::vector<PassCost> solve_cost() const override;
  std::size_t wind_bytes() const override {
    return 3 * to_index(body_->m_nodes.size()) * sizeof(Vec3);
  }

  /// Sets both velocities of a node: the implicit scheme starts from m_vn, the explicit one from
  /// m_v.
  static void set_velocity(btSoftBody::Node& n, const btVector3& v) { n.m_v = n.m_vn = v; }

  void substep(double from, double to) override {
    if (scene_.wind) find_wind();
    if (scene_.damping > 0) damp();
    if (scene_.wind) blow();
    move_colliders(from, to);
    move_pins(to);
    world.stepSimulation(h_, 0);
  }

  /// Damps velocities here, because Bullet's drag is lost in the implicit scheme.
  void damp() {
    for (int i = 0; i < body_->m_nodes.size(); ++i)
      set_velocity(body_->m_nodes[i], body_->m_nodes[i].m_v * (1 - loss_));
  }

  /// Computes the wind's force on every node, from the velocities that store() would give.
  void find_wind() {
    wind_.assign(scene_.start.x.size(), Vec3::Zero());
    store(now_);
    for (const auto& [a, b, c] : scene_.mesh.triangles) {
      const auto ia = static_cast<std::size_t>(a), ib = static_cast<std::size_t>(b),
                 ic = static_cast<std::size_t>(c);
      const Vec3 force = wind_on_corner(*scene_.wind, now_.x[ia], now_.x[ib], now_.x[ic],
                                        (now_.v[ia] + now_.v[ib] + now_.v[ic]) / 3);
      for (const std::size_t corner : {ia, ib, ic}) wind_[corner] += force;
    }
  }

  /// Adds the wind's impulse to the velocity from which the step starts, because this world ignores
  /// addForce.
  void blow() {
    for (std::size_t i = 0; i < wind_.size(); ++i) {
      btSoftBody::Node& n = node(i);
      set_velocity(n, n.m_v + to_bullet(wind_[i]) * (n.m_im * h_));
    }
  }

  void move_pins(double to) {
    for (std::size_t p = 0; p < scene_.pins.size(); ++p) {
      btSoftBody::Node& n = node(static_cast<std::size_t>(scene_.pins[p]));
      const btVector3 there =
          scene_.pin_motions.empty() ? n.m_x : to_bullet(pin_position(scene_, scene_.pins[p], to));
      pin_velocity_[p] = (there - n.m_x) / h_;
      n.m_x = n.m_q = there;
    }
  }

  int newton_;
  btScalar loss_;  ///< share of a velocity that damping removes in one substep
  btDeformableMassSpringForce springs_;
  btDeformableGravityForce gravity_;
  std::vector<btVector3> pin_velocity_;  ///< [pins] m/s, for wind and store()
  std::vector<Vec3> wind_;               ///< [n] N
  State now_;
};

std::vector<PassCost> BulletDeformable::solve_cost() const {
  // Conjugate gradients visit every spring once per iteration, up to 300 times; Bullet does not
  // count them.
  const auto& links = body_->m_links;
  return {{.pass = "springs (Newton steps)",
           .items = static_cast<std::size_t>(links.size()),
           .repeats = static_cast<std::size_t>(substeps_) * static_cast<std::size_t>(newton_),
           .bytes = static_cast<std::size_t>(links.capacity()) * sizeof(btSoftBody::Link) +
                    9 * scene_.mesh.rest.size() * sizeof(btVector3)}};
}

std::unique_ptr<Solver> make(const Scene& scene, const Params& params) {
  bullet_ref::require_program("bullet-deformable", params);
  return std::make_unique<BulletDeformable>(scene, params);
}

std::vector<std::string> unsupported(const Scene& scene, const Params& params) {
  std::vector<std::string> reasons = bullet_ref::unsupported(scene, params);
  if (!stiffness(scene, params))
    reasons.push_back("links of different stiffness: btDeformableMassSpringForce has one for all");
  if (scene.link_damping > 0)
    reasons.push_back(
        "damping of links in proportion to their stiffness: spring-damping is a number of N s/m");
  if (scene.self_collision)
    reasons.push_back(
        "self-collision: Bullet shuffles its contacts by a generator that the whole process "
        "shares, "
        "so that a case could not be repeated");
  return reasons;
}

ResolvedSettings resolved_settings(const Scene& scene, const Params& params) {
  const bool implicit = params.is("implicit", "true");
  ResolvedSettings lines = bullet_ref::library_settings(scene, params);
  lines.insert(
      lines.end(),
      {{"integration", implicit ? "backward Euler, " + std::string(params.value("newton")) +
                                      " Newton step(s), conjugate gradients"
                                : "symplectic Euler, explicit springs"},
       {kLinksSetting,
        "springs of " + general(stiffness(scene, params).value_or(0), 6) + " N/m, all families" +
            (scene.stiffness == kRigid ? "; the scene's are rigid" : ""),
        "", stiffness(scene, params).value_or(std::nan(""))},
       {"spring damping", general(params.real("spring-damping"), 6) + " N s/m (default 0.05)"},
       {"gravity", "the scene's, by btDeformableGravityForce (default: none)"},
       {"damping", "velocities x exp(-damping h) before each substep"},
       {"NaN", "Bullet turns velocity changes that are not numbers into zero"}});
  if (!implicit) lines.emplace_back("speed limit", "the cloth's bounding box per substep");
  if (scene.wind) lines.emplace_back("wind", "our face law, as an impulse before each substep");
  if (scene.colliders.empty()) return lines;
  lines.emplace_back("contacts", "vertices only, found once per substep");
  for (auto& line : bullet_ref::contact_settings(scene, params, "0.005")) lines.push_back(line);
  lines.emplace_back("friction", "Coulomb, kDF 1");
  if (implicit)
    lines.emplace_back("stability",
                       "backward Euler may explode on contact; implicit=false,substeps=70 does "
                       "not on the shipped scenes");
  if (implicit && !scene.pins.empty())
    lines.emplace_back("contact prediction",
                       "Bullet assigns forces past a pin to the wrong vertex when it predicts "
                       "contact velocities");
  return lines;
}

constexpr AccuracyParameters::Ladder kAlternatives[] = {{{"precision"}, {"float", "double"}},
                                                        {{"newton"}, {"2", "4"}}};

}  // namespace
}  // namespace taut::solver::bullet_deformable

TAUT_SOLVER(bullet_deformable) = {
    .name = "bullet-deformable",
    .summary = "Bullet's deformable body: Hooke springs, implicit Euler",
    .source =
        "Bullet Physics 3.24, btDeformableMultiBodyDynamicsWorld, btDeformableMassSpringForce",
    .params = taut::solver::bullet_deformable::kParams,
    .make = taut::solver::bullet_deformable::make,
    .unsupported = taut::solver::bullet_deformable::unsupported,
    .resolved_settings = taut::solver::bullet_deformable::resolved_settings,
    .declared_step = [](const taut::Scene&, const taut::Params&) -> taut::DeclaredStep {
      return {.none = "Bullet's step is another"};
    },
    .program = taut::bullet_ref::program,
    .accuracy = {
        .substeps = "substeps",
        .stiffness = {{"stiffness"}, {"1000", "4000", "16000", "64000", "256000", "1024000"}},
        .alternatives = taut::solver::bullet_deformable::kAlternatives,
        .labelled = {"substeps", "newton", "stiffness", "precision"}}};
