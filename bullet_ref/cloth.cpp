#include "bullet_ref/cloth.hpp"

#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>

#include <cmath>

#include "bullet_ref/convert.hpp"

namespace taut {

void configure_world_info(btSoftBodyWorldInfo& info, const Scene& scene, double voxel) {
  info.m_gravity = to_bullet(scene.gravity);
  info.air_density = 0;
  info.m_maxDisplacement = btScalar(1e9);
  info.m_sparsesdf.setDefaultVoxelsz(static_cast<btScalar>(voxel));
  info.m_sparsesdf.Reset();  // takes the voxel size over
}

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
  body->m_bUpdateRtCst = false;                     // or the first step does it again
  if (options.reorder && body->m_links.size() > 1)  // it reads the first link and the second node
    btSoftBodyHelpers::ReoptimizeLinkOrder(body.get());

  body->getCollisionShape()->setMargin(static_cast<btScalar>(scene.thickness + options.margin));
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

int waiting_links(const btSoftBody& body) {
  int waiting = 0;
  for (int i = 1; i < body.m_links.size(); ++i) {
    const auto &before = body.m_links[i - 1].m_n, &now = body.m_links[i].m_n;
    waiting +=
        now[0] == before[0] || now[0] == before[1] || now[1] == before[0] || now[1] == before[1];
  }
  return waiting;
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

}  // namespace taut
