#include "bullet_ref/bullet_solver.hpp"

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <cmath>
#include <cstdio>

#include "bullet_ref/convert.hpp"
#include "core/model/input_error.hpp"

namespace taut {

BulletSolver::BulletSolver(const Scene& scene, const Params& params, btDiscreteDynamicsWorld& world,
                           btSoftBodyWorldInfo& info, const ClothOptions& options)
    : scene_(scene),
      margin_(options.margin),
      substeps_(params.integer("substeps")),
      h_(static_cast<btScalar>(bullet_ref::substep_length(scene, params))),
      colliders_(scene, world) {
  world.setGravity(to_bullet(scene.gravity));  // does not reach soft bodies
  configure_world_info(info, scene, params.real("voxel"));
  body_ = build_cloth(info, scene, options);
}

void BulletSolver::step(double t, double dt) {
  const double h = dt / substeps_;
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
  constexpr btScalar kFarthest = 1e6;  // m: with the least voxel 3e8 cells of three voxels
  const auto near = [&](const btVector3& x) {
    return std::abs(x.x()) <= kFarthest && std::abs(x.y()) <= kFarthest &&
           std::abs(x.z()) <= kFarthest;
  };
  for (int b = 0; b < bodies.size(); ++b) {
    if (bodies[b]->m_cfg.collisions == 0) continue;
    const auto& nodes = bodies[b]->m_nodes;
    for (int i = 0; i < nodes.size(); ++i)
      if (!near(nodes[i].m_x) || !near(nodes[i].m_q)) throw SolverFailure("exploded", "box");
  }
}

float substep_length(const Scene& scene, const Params& params) {
  return static_cast<float>(scene.dt / params.integer("substeps"));
}

std::string_view program(const Params& params) {
  return params.is("precision", "double") ? "taut" : "taut-f32";
}

void require_program(const std::string& solver, const Params& params) {
  const std::string precision(params.choice("precision"));
  if (precision != kBulletPrecision)
    throw InputError(solver + ": precision=" + precision + " needs the program " +
                     std::string(program(params)));
}

std::vector<std::string> unsupported(const Scene& scene, const Params& params) {
  if (static_cast<btScalar>(substep_length(scene, params)) > SIMD_EPSILON) return {};
  return {"stepSimulation ignores a substep this short"};
}

ResolvedSettings library_settings(const Scene& scene, const Params& params) {
  const std::string precision(params.choice("precision"));
  return {{"library", "Bullet " + std::to_string(BT_BULLET_VERSION / 100) + "." +
                          std::to_string(BT_BULLET_VERSION % 100) + ", " + precision},
          {"time step", short_text(static_cast<double>(substep_length(scene, params))) + " s x " +
                            std::string(params.value("substeps")) + ", as binary32"},
          {"precision", precision}};
}

ResolvedSettings contact_settings(const Scene& scene, const Params& params,
                                  const std::string& default_voxel) {
  return {{"margin", short_text(scene.thickness + params.real("margin")) + " m (default 0.25)"},
          {"distance field", "trilinear, voxel " + short_text(params.real("voxel")) +
                                 " m (default " + default_voxel + ")"}};
}

std::string short_text(double value) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.6g", value);
  return digits;
}

}  // namespace bullet_ref
}  // namespace taut
