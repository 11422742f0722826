// Bullet's btSoftBody with its Positions solver, which is Jakobsen's algorithm under another name.
// Each statement of the builder that looks odd answers a trap that bullet_ref/README.md describes.
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <algorithm>
#include <cmath>

#include "bullet_ref/convert.hpp"
#include "bullet_ref/read_back.hpp"
#include "bullet_ref/rigid_colliders.hpp"
#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "core/model/wind.hpp"

namespace taut {

namespace {

using Kind = ParamSpec::Kind;
constexpr ParamSpec kParams[] = {
    {.name = "iterations",
     .kind = Kind::integer,
     .default_value = "3",
     .min = 0,
     .max = 1e6,
     .help = "m_cfg.piterations: sweeps over contacts and links per substep (Bullet's default: 1)"},
    {.name = "substeps",
     .kind = Kind::integer,
     .default_value = "1",
     .min = 1,
     .max = 1e6,
     .help = "each step is this many calls of stepSimulation(dt / substeps)"},
    {.name = "precision",
     .kind = Kind::choice,
     .default_value = "double",
     .choices = "float|double",
     .help = "which build of Bullet; float runs in taut-f32"},
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
    {.name = "margin",
     .kind = Kind::real,
     .unit = "m",
     .default_value = "0",
     .min = 0,
     .max = 1,
     .help = "collision margin on top of the scene's thickness (Bullet's default: 0.25)"},
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

/// One substep [s]. Bullet casts the time step to float even in its double build.
btScalar substep_length(const Scene& scene, const Params& params) {
  return static_cast<float>(scene.dt / params.integer("substeps"));
}

/// A world with nothing in it; the order of members is the order in which Bullet wants them built.
struct World {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btSoftRigidDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
};

void configure_world(btSoftRigidDynamicsWorld& world, const Scene& scene, const Params& params) {
  world.setGravity(to_bullet(scene.gravity));  // does not reach soft bodies
  btSoftBodyWorldInfo& info = world.getWorldInfo();
  info.m_gravity = to_bullet(scene.gravity);
  info.air_density = 0;
  info.m_maxDisplacement = btScalar(1e9);
  info.m_sparsesdf.setDefaultVoxelsz(static_cast<btScalar>(params.real("voxel")));
  info.m_sparsesdf.Reset();  // takes the voxel size over
}

std::unique_ptr<btSoftBody> make_body(btSoftBodyWorldInfo& info, const Scene& scene,
                                      const Params& params) {
  const Mesh& mesh = scene.mesh;
  std::vector<btVector3> x;
  for (const Vec3& rest : mesh.rest) x.push_back(to_bullet(rest));
  std::vector<btScalar> mass;
  for (const double m : mesh.mass) mass.push_back(static_cast<btScalar>(m));
  for (const int pin : scene.pins) mass[static_cast<std::size_t>(pin)] = 0;
  auto body = std::make_unique<btSoftBody>(&info, mesh.size(), x.data(), mass.data());

  while (body->m_materials.size() < static_cast<int>(kFamilies.size())) body->appendMaterial();
  for (int i = 0; i < body->m_materials.size(); ++i)
    body->m_materials[i]->m_kLST = static_cast<btScalar>(params.real("stiffness"));
  for (const Link& link : scene.links)
    body->appendLink(link.a, link.b, body->m_materials[static_cast<int>(link.family)]);
  if (params.is("faces", "on"))
    for (const auto& [a, b, c] : mesh.triangles) body->appendFace(a, b, c);

  body->updateConstants();  // overwrites the rest lengths with the current ones
  for (int i = 0; i < body->m_links.size(); ++i) {
    btSoftBody::Link& link = body->m_links[i];
    link.m_rl = static_cast<btScalar>(scene.links[static_cast<std::size_t>(i)].rest);
    link.m_c1 = link.m_rl * link.m_rl;  // what the solver reads
  }
  body->m_bUpdateRtCst = false;  // or the first step does it again
  return body;
}

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
  body.getCollisionShape()->setMargin(
      static_cast<btScalar>(scene.thickness + params.real("margin")));
  body.setActivationState(DISABLE_DEACTIVATION);
}

class BulletSoftBody final : public Solver, public HoldsScene {
 public:
  BulletSoftBody(const Scene& scene, const Params& params)
      : scene_(scene),
        margin_(params.real("margin")),
        iterations_(params.integer("iterations")),
        substeps_(params.integer("substeps")),
        h_(substep_length(scene, params)),
        colliders_(scene, world_.world) {
    configure_world(world_.world, scene, params);
    body_ = make_body(world_.world.getWorldInfo(), scene, params);
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

  std::vector<PassCost> plan() const override;
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

std::vector<PassCost> BulletSoftBody::plan() const {
  const btSoftBody& b = *body_;
  const auto n = static_cast<std::size_t>(b.m_nodes.size());
  const auto per_step = static_cast<std::size_t>(substeps_);
  const std::size_t sweeps = per_step * static_cast<std::size_t>(iterations_);
  std::size_t links = 0;
  for (int i = 0; i < b.m_links.size(); ++i) links += b.m_links[i].m_c0 > 0;
  const std::size_t tree = (2 * n - 1) * sizeof(btDbvtNode);

  std::vector<PassCost> costs;
  if (scene_.wind)
    costs.push_back({.pass = "wind",
                     .items = scene_.mesh.triangles.size(),
                     .repeats = per_step,
                     .bytes = scene_.mesh.triangles.size() * sizeof(Triangle)});
  costs.push_back({.pass = "predict and update tree",
                   .items = n,
                   .repeats = per_step,
                   .bytes = held(b.m_nodes) + held(b.m_X) + tree});
  if (!scene_.colliders.empty()) {
    const btSparseSdf<3>& sdf = b.m_worldInfo->m_sparsesdf;
    const std::size_t cells = static_cast<std::size_t>(sdf.ncells) * sizeof(btSparseSdf<3>::Cell);
    costs.push_back({.pass = "detect contacts",
                     .items = n * scene_.colliders.size(),
                     .repeats = per_step,
                     .bytes = held(sdf.cells) + cells + colliders_.bytes()});
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
  for (int i = 0; i < b.m_nodes.size(); ++i) {
    scene.mesh.rest.push_back(from_bullet(b.m_X[i]));
    const double w = static_cast<double>(b.m_nodes[i].m_im);
    scene.mesh.mass.push_back(w > 0 ? 1 / w : 0);
    if (!(w > 0)) scene.pins.push_back(i);
  }
  const auto index = [&](const btSoftBody::Node* n) { return static_cast<int>(n - &b.m_nodes[0]); };
  for (int i = 0; i < b.m_faces.size(); ++i) {
    const auto& n = b.m_faces[i].m_n;
    scene.mesh.triangles.push_back({index(n[0]), index(n[1]), index(n[2])});
  }
  for (int i = 0; i < b.m_links.size(); ++i) {
    const btSoftBody::Link& link = b.m_links[i];
    const auto family = b.m_materials.findLinearSearch(link.m_material);
    scene.links.push_back({index(link.m_n[0]), index(link.m_n[1]),
                           std::sqrt(static_cast<double>(link.m_c1)), static_cast<Family>(family)});
  }
  store(scene.start);
  scene.colliders = colliders_.read_back(0);
  scene.gravity = from_bullet(b.m_worldInfo->m_gravity);
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
  if (!params.is("precision", kBulletPrecision))
    throw InputError("bullet: precision=" + std::string(params.choice("precision")) +
                     " needs the program " +
                     std::string(bullet_program(params.choice("precision"))));
  return std::make_unique<BulletSoftBody>(scene, params);
}

std::vector<std::string> cannot(const Scene& scene, const Params& params) {
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
  if (substep_length(scene, params) <= SIMD_EPSILON)
    reasons.push_back("stepSimulation ignores a substep this short");
  return reasons;
}

std::string text(double value) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.6g", value);
  return digits;
}

Effective effective(const Scene& scene, const Params& params) {
  const double h = static_cast<double>(substep_length(scene, params));
  Effective lines = {
      {"library", "Bullet " + std::to_string(BT_BULLET_VERSION / 100) + "." +
                      std::to_string(BT_BULLET_VERSION % 100) + ", " +
                      std::string(params.choice("precision"))},
      {"time step", text(h) + " s x " + std::string(params.value("substeps")) + ", as binary32"},
      {"integration", "symplectic Euler; the same positions as Verlet"},
      {"projection", "sqrt-free, weighted by inverse mass, kLST " + text(params.real("stiffness"))},
      {"link order", "the scene's"},
      {"gravity", "the scene's (soft bodies' own default: -10 m/s^2 in y)"},
      {"damping", "kDP " + text(-std::expm1(-scene.damping * h)) + " per substep"},
      {"normals", params.is("faces", "on") ? "computed every substep" : "off"},
  };
  if (scene.wind)
    lines.emplace_back("wind", "our face law through addForce; Bullet's own medium is empty");
  if (scene.colliders.empty()) return lines;
  lines.emplace_back("order of passes", params.is("order", "links-first")
                                            ? "links, then contacts"
                                            : "contacts, then links (Bullet's own)");
  lines.emplace_back("contacts", "vertices only, found once per substep at the predicted place");
  lines.emplace_back("margin", text(scene.thickness + params.real("margin")) + " m (default 0.25)");
  lines.emplace_back("distance field",
                     "trilinear, voxel " + text(params.real("voxel")) + " m (default 0.25)");
  lines.emplace_back("contact hardness", "kKHR " + text(params.real("hardness")));
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

}  // namespace
}  // namespace taut

TAUT_SOLVER(bullet) = {.name = "bullet",
                       .summary = "Bullet's btSoftBody, Positions solver",
                       .source = "Bullet Physics 3.24, btSoftRigidDynamicsWorld",
                       .params = taut::kParams,
                       .make = taut::make,
                       .cannot = taut::cannot,
                       .effective = taut::effective,
                       .program = taut::program};
