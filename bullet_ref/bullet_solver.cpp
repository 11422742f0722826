#include "bullet_ref/bullet_solver.hpp"

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"

namespace taut {

namespace {

/// Sets gravity, still air, no limit on displacements, and distance fields with this grid spacing
/// [m].
void configure_world_info(btSoftBodyWorldInfo& info, const Scene& scene, double voxel) {
  info.m_gravity = to_bullet(scene.gravity);
  info.air_density = 0;
  info.m_maxDisplacement = btScalar(1e9);
  info.m_sparsesdf.setDefaultVoxelsz(static_cast<btScalar>(voxel));
  info.m_sparsesdf.Reset();  // applies the voxel size
}

/// Reads mesh (without its grid), pins, links and gravity of the scene from the body. Links are in
/// the order in which they are solved.
void read_back_cloth(const btSoftBody& body, RestLength rest_length, Scene& scene) {
  for (int i = 0; i < body.m_nodes.size(); ++i) {
    scene.mesh.rest.push_back(from_bullet(body.m_X[i]));
    const double w = static_cast<double>(body.m_nodes[i].m_im);
    scene.mesh.mass.push_back(w > 0 ? 1 / w : 0);
    if (!(w > 0)) scene.pins.push_back(i);
  }
  const auto index = [&](const btSoftBody::Node* n) {
    return static_cast<int>(n - &body.m_nodes[0]);
  };
  for (int i = 0; i < body.m_faces.size(); ++i) {
    const auto& n = body.m_faces[i].m_n;
    scene.mesh.triangles.push_back({index(n[0]), index(n[1]), index(n[2])});
  }
  for (int i = 0; i < body.m_links.size(); ++i) {
    const btSoftBody::Link& link = body.m_links[i];
    const double rest = rest_length == RestLength::m_rl ? static_cast<double>(link.m_rl)
                                                        : std::sqrt(static_cast<double>(link.m_c1));
    const int family = body.m_materials.findLinearSearch(link.m_material);
    scene.links.push_back(
        {index(link.m_n[0]), index(link.m_n[1]), rest, static_cast<Family>(family)});
  }
  scene.gravity = from_bullet(body.m_worldInfo->m_gravity);
}

/// Bytes of the nodes and of the tree over them.
std::size_t node_bytes(const btSoftBody& body) {
  const auto n = static_cast<std::size_t>(body.m_nodes.size());
  return static_cast<std::size_t>(body.m_nodes.capacity()) * sizeof(btSoftBody::Node) +
         static_cast<std::size_t>(body.m_X.capacity()) * sizeof(btVector3) +
         (2 * n - 1) * sizeof(btDbvtNode);
}

/// Bytes of the colliders' distance fields, as far as they are built.
std::size_t distance_field_bytes(const btSoftBody& body) {
  const btSparseSdf<3>& sdf = body.m_worldInfo->m_sparsesdf;
  return static_cast<std::size_t>(sdf.cells.capacity()) * sizeof(sdf.cells[0]) +
         static_cast<std::size_t>(sdf.ncells) * sizeof(btSparseSdf<3>::Cell);
}

}  // namespace

std::unique_ptr<btSoftBody> build_cloth(btSoftBodyWorldInfo& info, const Scene& scene,
                                        const ClothOptions& options) {
  const Mesh& mesh = scene.mesh;
  std::vector<btVector3> x;
  for (const Vec3& rest : mesh.rest) x.push_back(to_bullet(rest));
  std::vector<btScalar> mass;
  for (const double m : mesh.mass) mass.push_back(static_cast<btScalar>(m));
  for (const int pin : scene.pins) mass[static_cast<std::size_t>(pin)] = 0;
  auto body = std::make_unique<btSoftBody>(&info, mesh.size(), x.data(), mass.data());

  while (body->m_materials.size() < static_cast<int>(kFamilies.size())) body->appendMaterial();
  for (int i = 0; i < body->m_materials.size(); ++i)
    body->m_materials[i]->m_kLST = static_cast<btScalar>(options.stiffness);
  for (const Link& link : scene.links)
    body->appendLink(link.a, link.b, body->m_materials[static_cast<int>(link.family)]);
  if (options.faces)
    for (const auto& [a, b, c] : mesh.triangles) body->appendFace(a, b, c);

  body->updateConstants();  // overwrites the rest lengths with the current ones
  for (int i = 0; i < body->m_links.size(); ++i) {
    btSoftBody::Link& link = body->m_links[i];
    link.m_rl = static_cast<btScalar>(scene.links[static_cast<std::size_t>(i)].rest);
    link.m_c1 = link.m_rl * link.m_rl;
  }
  body->m_bUpdateRtCst = false;  // otherwise the first step does it again
  // ReoptimizeLinkOrder reads the first link and the second node.
  if (options.reorder && body->m_links.size() > 1)
    btSoftBodyHelpers::ReoptimizeLinkOrder(body.get());

  body->getCollisionShape()->setMargin(static_cast<btScalar>(scene.thickness + options.margin));
  body->setActivationState(DISABLE_DEACTIVATION);
  return body;
}

int waiting_links(const btSoftBody& body) {
  int waiting = 0;
  for (int i = 1; i < body.m_links.size(); ++i) {
    const auto &before = body.m_links[i - 1].m_n, &now = body.m_links[i].m_n;
    waiting += std::ranges::find_first_of(now, before) != std::end(now);
  }
  return waiting;
}

BulletSolver::BulletSolver(const Scene& scene, const Params& params, btDiscreteDynamicsWorld& world,
                           btSoftBodyWorldInfo& info, const ClothOptions& options)
    : scene_(scene),
      margin_(options.margin),
      substeps_(params.integer("substeps")),
      h_(static_cast<btScalar>(bullet_ref::substep_length(scene, params))),
      colliders_(scene, world) {
  world.setGravity(to_bullet(scene.gravity));  // has no effect on soft bodies
  configure_world_info(info, scene, params.real("voxel"));
  body_ = build_cloth(info, scene, options);
  if (colliders_.deform())  // called between the search for contacts and their solution
    world.setInternalTickCallback(
        [](btDynamicsWorld* ticking, btScalar h) {
          auto& self = *static_cast<BulletSolver*>(ticking->getWorldUserInfo());
          self.colliders_.carry(*self.body_, static_cast<double>(h));
        },
        this);
}

/// Moves the colliders. A body that deforms drops the hulls of its triangles, and for each hull
/// Bullet walks over all cells of the distance fields. So all cells are dropped first; they are
/// made anew on use. That walk took two thirds of a step of `skirt`.
void BulletSolver::move_colliders(double from, double to) {
  if (colliders_.deform()) body_->getWorldInfo()->m_sparsesdf.Reset();
  colliders_.move(from, to);
}

void BulletSolver::step(double t, double dt) {
  const double h = dt / substeps_;
  if (!colliders_.empty()) {
    btVector3 least, most;
    body_->getAabb(least, most);
    colliders_.follow(t, from_bullet((least + most) / 2));
  }
  for (int s = 0; s < substeps_; ++s) {
    substep(t + s * h, t + (s + 1) * h);
    if (s + 1 < substeps_) substep_ended(t + (s + 1) * h);
  }
}

std::vector<PassCost> BulletSolver::step_cost() const {
  const auto per_step = static_cast<std::size_t>(substeps_);
  const auto n = static_cast<std::size_t>(body_->m_nodes.size());
  const std::size_t triangles = scene_.mesh.triangles.size();
  std::vector<PassCost> costs;
  if (scene_.wind)
    costs.push_back({.pass = "wind",
                     .items = triangles,
                     .repeats = per_step,
                     .bytes = triangles * sizeof(Triangle) + wind_bytes()});
  costs.push_back({.pass = "predict and update tree",
                   .items = n,
                   .repeats = per_step,
                   .bytes = node_bytes(*body_)});
  if (!scene_.colliders.empty())
    costs.push_back({.pass = "detect contacts",
                     .items = n * scene_.colliders.size(),
                     .repeats = per_step,
                     .bytes = distance_field_bytes(*body_) + colliders_.bytes()});
  for (PassCost& cost : solve_cost()) costs.push_back(std::move(cost));
  const auto& faces = body_->m_faces;
  if (faces.size() > 0)
    costs.push_back(
        {.pass = "normals",
         .items = static_cast<std::size_t>(faces.size()),
         .repeats = per_step,
         .bytes = static_cast<std::size_t>(faces.capacity()) * sizeof(btSoftBody::Face)});
  return costs;
}

Scene BulletSolver::held_scene(RestLength rest_length) const {
  Scene scene;
  read_back_cloth(*body_, rest_length, scene);
  store(scene.start);
  scene.colliders = colliders_.read_back(0);
  scene.thickness = static_cast<double>(body_->getCollisionShape()->getMargin()) - margin_;
  scene.dt = static_cast<double>(h_) * substeps_;
  scene.pin_motions = scene_.pin_motions;
  scene.wind = scene_.wind;
  scene.steps = scene_.steps;
  return scene;
}

namespace bullet_ref {

void require_cells(const btAlignedObjectArray<btSoftBody*>& bodies) {
  constexpr btScalar kFarthest = 1e6;  // m; 3e8 cells, which are three of the smallest voxels wide
  const auto near = [&](const btVector3& x) {
    return std::abs(x.x()) <= kFarthest && std::abs(x.y()) <= kFarthest &&
           std::abs(x.z()) <= kFarthest;
  };
  for (int b = 0; b < bodies.size(); ++b) {
    if (bodies[b]->m_cfg.collisions == 0) continue;
    const auto& nodes = bodies[b]->m_nodes;
    for (int i = 0; i < nodes.size(); ++i)
      if (!near(nodes[i].m_x) || !near(nodes[i].m_q))
        throw SolverFailure(Status::Kind::exploded, Reason::box);
  }
}

float substep_length(const Scene& scene, const Params& params) {
  return static_cast<float>(scene.dt / params.integer("substeps"));
}

std::string_view program(const Params& params) {
  return params.is("precision", "double") ? kProgram : kFloatProgram;
}

void require_program(const std::string& solver, const Params& params) {
  const std::string precision(params.choice("precision"));
  if (precision != kBulletPrecision)
    throw InputError(solver + ": precision=" + precision + " needs the program " +
                     std::string(program(params)));
}

std::vector<std::string> unsupported(const Scene& scene, const Params& params) {
  std::vector<std::string> reasons;
  if (static_cast<btScalar>(substep_length(scene, params)) <= SIMD_EPSILON)
    reasons.emplace_back("stepSimulation ignores a substep this short");
  if (scene.bending)
    reasons.emplace_back("bending: Bullet's cloth has links alone, and no bending stiffness");
  if (scene.membrane)
    reasons.emplace_back("a membrane: Bullet's cloth has links alone, whose stiffness has no unit");
  return reasons;
}

ResolvedSettings library_settings(const Scene& scene, const Params& params) {
  const std::string precision(params.choice("precision"));
  const std::string step = general(static_cast<double>(substep_length(scene, params)), 6) +
                           " s x " + std::string(params.value("substeps"));
  return {{"library", "Bullet " + std::to_string(BT_BULLET_VERSION / 100) + "." +
                          std::to_string(BT_BULLET_VERSION % 100) + ", " + precision},
          {"time step", step + ", as binary32", step},
          {"precision", precision}};
}

ResolvedSettings contact_settings(const Scene& scene, const Params& params,
                                  const std::string& default_voxel) {
  ResolvedSettings lines{
      {"margin", general(scene.thickness + params.real("margin"), 6) + " m (default 0.25)"},
      {"distance field", "trilinear, voxel " + general(params.real("voxel"), 6) + " m (default " +
                             default_voxel + ")"}};
  if (std::ranges::any_of(scene.colliders, is_met_by_triangles))
    lines.emplace_back("body of triangles",
                       "each triangle a hull " + as_typed(kTriangleExtrusion) +
                           " m thick on both of its sides (BT_SOFTBODY_TRIANGLE_EXTRUSION), and a "
                           "margin of " +
                           as_typed(kTriangleMargin) + " m around it: cloth rests " +
                           as_typed(kTriangleExtrusion) + " to " +
                           as_typed(kTriangleExtrusion + kTriangleMargin) + " m above");
  if (std::ranges::any_of(scene.colliders, deforms))
    lines.emplace_back("body that deforms",
                       "each contact gets the velocity of the surface where it touches");
  return lines;
}

}  // namespace bullet_ref

}  // namespace taut
