#pragma once

#include <memory>

#include "core/model/params.hpp"
#include "core/model/scene.hpp"

class btSoftBody;
struct btSoftBodyWorldInfo;

namespace taut {

/// One substep [s]: dt / substeps rounded to binary32, for btSoftRigidDynamicsWorld casts its time
/// step to float even in the double build. Reads the parameter "substeps".
float substep_length(const Scene&, const Params&);

/// Throws InputError if the parameter "precision" is not that of the Bullet in this program.
void require_program(const std::string& solver, const Params&);

/// Gravity, still air, no limit on displacements, and distance fields with this grid spacing [m].
void configure_world_info(btSoftBodyWorldInfo&, const Scene&, double voxel);

/// The scene's cloth, node by node and link by link in the scene's order, at rest in its rest
/// shape; material i is that of family i. Faces, if wanted, in the mesh's order. The margin is the
/// scene's thickness + margin [m]; deactivation is off. stiffness: kLST of every link.
std::unique_ptr<btSoftBody> build_cloth(btSoftBodyWorldInfo&, const Scene&, double stiffness,
                                        double margin, bool faces);

/// Which of a link's two fields its solver reads for the rest length.
enum class RestLength { m_rl, m_c1 };

/// Mesh (without its grid), pins, links and gravity of the scene, as the body holds them.
void read_back_cloth(const btSoftBody&, RestLength, Scene&);

/// Bytes of the nodes and of the tree over them.
std::size_t node_bytes(const btSoftBody&);
/// Bytes of the colliders' distance fields, as far as they are built.
std::size_t distance_field_bytes(const btSoftBody&);

/// "%.6g"
std::string short_text(double);

/// Lines of the fairness panel that hold for every solver of Bullet.
std::pair<std::string, std::string> library_line(const Params&);
std::pair<std::string, std::string> time_step_line(const Scene&, const Params&);

}  // namespace taut
