#include "bullet_ref/cloth_builder.hpp"

#include <BulletSoftBody/btSoftBody.h>

#include <cmath>
#include <cstdio>

#include "bullet_ref/convert.hpp"
#include "core/model/input_error.hpp"

namespace taut {

float substep_length(const Scene& scene, const Params& params) {
  return static_cast<float>(scene.dt / params.integer("substeps"));
}

void require_program(const std::string& solver, const Params& params) {
  const std::string precision(params.choice("precision"));
  if (precision != kBulletPrecision)
    throw InputError(solver + ": precision=" + precision + " needs the program " +
                     std::string(bullet_program(precision)));
}

void configure_world_info(btSoftBodyWorldInfo& info, const Scene& scene, double voxel) {
  info.m_gravity = to_bullet(scene.gravity);
  info.air_density = 0;
  info.m_maxDisplacement = btScalar(1e9);
  info.m_sparsesdf.setDefaultVoxelsz(static_cast<btScalar>(voxel));
  info.m_sparsesdf.Reset();  // takes the voxel size over
}

std::unique_ptr<btSoftBody> build_cloth(btSoftBodyWorldInfo& info, const Scene& scene,
                                        double stiffness, double margin, bool faces) {
  const Mesh& mesh = scene.mesh;
  std::vector<btVector3> x;
  for (const Vec3& rest : mesh.rest) x.push_back(to_bullet(rest));
  std::vector<btScalar> mass;
  for (const double m : mesh.mass) mass.push_back(static_cast<btScalar>(m));
  for (const int pin : scene.pins) mass[static_cast<std::size_t>(pin)] = 0;
  auto body = std::make_unique<btSoftBody>(&info, mesh.size(), x.data(), mass.data());

  while (body->m_materials.size() < static_cast<int>(kFamilies.size())) body->appendMaterial();
  for (int i = 0; i < body->m_materials.size(); ++i)
    body->m_materials[i]->m_kLST = static_cast<btScalar>(stiffness);
  for (const Link& link : scene.links)
    body->appendLink(link.a, link.b, body->m_materials[static_cast<int>(link.family)]);
  if (faces)
    for (const auto& [a, b, c] : mesh.triangles) body->appendFace(a, b, c);

  body->updateConstants();  // overwrites the rest lengths with the current ones
  for (int i = 0; i < body->m_links.size(); ++i) {
    btSoftBody::Link& link = body->m_links[i];
    link.m_rl = static_cast<btScalar>(scene.links[static_cast<std::size_t>(i)].rest);
    link.m_c1 = link.m_rl * link.m_rl;
  }
  body->m_bUpdateRtCst = false;  // or the first step does it again

  body->getCollisionShape()->setMargin(static_cast<btScalar>(scene.thickness + margin));
  body->setActivationState(DISABLE_DEACTIVATION);
  return body;
}

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

std::size_t node_bytes(const btSoftBody& body) {
  const auto n = static_cast<std::size_t>(body.m_nodes.size());
  return static_cast<std::size_t>(body.m_nodes.capacity()) * sizeof(btSoftBody::Node) +
         static_cast<std::size_t>(body.m_X.capacity()) * sizeof(btVector3) +
         (2 * n - 1) * sizeof(btDbvtNode);
}

std::size_t distance_field_bytes(const btSoftBody& body) {
  const btSparseSdf<3>& sdf = body.m_worldInfo->m_sparsesdf;
  return static_cast<std::size_t>(sdf.cells.capacity()) * sizeof(sdf.cells[0]) +
         static_cast<std::size_t>(sdf.ncells) * sizeof(btSparseSdf<3>::Cell);
}

std::string short_text(double value) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.6g", value);
  return digits;
}

std::pair<std::string, std::string> library_line(const Params& params) {
  return {"library", "Bullet " + std::to_string(BT_BULLET_VERSION / 100) + "." +
                         std::to_string(BT_BULLET_VERSION % 100) + ", " +
                         std::string(params.choice("precision"))};
}

std::pair<std::string, std::string> time_step_line(const Scene& scene, const Params& params) {
  return {"time step", short_text(static_cast<double>(substep_length(scene, params))) + " s x " +
                           std::string(params.value("substeps")) + ", as binary32"};
}

}  // namespace taut
