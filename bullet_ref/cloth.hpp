#pragma once

#include <memory>

#include "core/model/scene.hpp"

class btSoftBody;
struct btSoftBodyWorldInfo;

namespace taut {

/// Gravity, still air, no limit on displacements, and distance fields with this grid spacing [m].
void configure_world_info(btSoftBodyWorldInfo&, const Scene&, double voxel);

/// What a scene leaves open about its cloth.
struct ClothOptions {
  double stiffness = 1;  ///< kLST of every link
  double margin = 0;     ///< m, on top of the scene's thickness
  bool faces = true;     ///< the mesh's, in its order; without them Bullet computes no normals
  bool reorder = false;  ///< links by ReoptimizeLinkOrder; else in the scene's order
};

/// The scene's cloth, node by node and link by link, at rest in its rest shape; material i is that
/// of family i; deactivation is off.
std::unique_ptr<btSoftBody> build_cloth(btSoftBodyWorldInfo&, const Scene&, const ClothOptions&);

/// Which of a link's two fields its solver reads for the rest length.
enum class RestLength { m_rl, m_c1 };

/// Mesh (without its grid), pins, links and gravity of the scene, as the body holds them: the links
/// in the order in which they are solved.
void read_back_cloth(const btSoftBody&, RestLength, Scene&);

/// Links that share a vertex with the link before them in the order in which they are solved: each
/// waits for what the one before it writes.
int waiting_links(const btSoftBody&);

/// Bytes of the nodes and of the tree over them.
std::size_t node_bytes(const btSoftBody&);
/// Bytes of the colliders' distance fields, as far as they are built.
std::size_t distance_field_bytes(const btSoftBody&);

}  // namespace taut
