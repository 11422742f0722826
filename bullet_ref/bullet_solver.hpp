#pragma once

#include <BulletSoftBody/btSoftBody.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "bullet_ref/read_back.hpp"
#include "bullet_ref/rigid_colliders.hpp"
#include "core/model/solver.hpp"

class btDiscreteDynamicsWorld;

namespace taut {

/// The scalar type of the Bullet library that this copy of the code is compiled for.
inline constexpr std::string_view kBulletPrecision = sizeof(btScalar) == 8 ? "double" : "float";

inline btVector3 to_bullet(const Vec3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}
inline Vec3 from_bullet(const btVector3& v) {
  return Eigen::Matrix<btScalar, 3, 1>(v.x(), v.y(), v.z()).cast<double>();
}

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

/// Links that share a vertex with the link before them in the order in which they are solved: each
/// waits for what the one before it writes.
int waiting_links(const btSoftBody&);

/// What both of Bullet's cloths are: the scene's cloth and colliders in a world of Bullet's, which
/// the derived class owns, advanced by substeps. Only the .cpp files of this folder include this.
class BulletSolver : public Solver, public HoldsScene {
 public:
  void step(double t, double dt) final;
  std::vector<PassCost> step_cost() const final;

 protected:
  /// Builds colliders and cloth, which the derived class adds to its world. Reads the parameters
  /// "substeps" and "voxel".
  BulletSolver(const Scene&, const Params&, btDiscreteDynamicsWorld&, btSoftBodyWorldInfo&,
               const ClothOptions&);

  /// To where they are at the end of a substep.
  void move_colliders(double from, double to);
  /// Advances [from, to] by stepSimulation(h_, 0): with its default arguments it steps by 1/60 s.
  virtual void substep(double from, double to) = 0;
  /// What solves the links and contacts in one step.
  virtual std::vector<PassCost> solve_cost() const = 0;
  /// Bytes that exist for the wind besides the scene's triangles.
  virtual std::size_t wind_bytes() const { return 0; }

  /// What the body and the colliders hold, and what Bullet has no place for, so that the adapter
  /// applies it at each substep: motions of pins and wind. Damping is the derived class's.
  Scene held_scene(RestLength) const;

  btSoftBody::Node& node(std::size_t i) { return body_->m_nodes[static_cast<int>(i)]; }
  const btSoftBody::Node& node(std::size_t i) const { return body_->m_nodes[static_cast<int>(i)]; }

  Scene scene_;
  double margin_;
  int substeps_;
  btScalar h_;  ///< s, of a substep
  RigidColliders colliders_;
  std::unique_ptr<btSoftBody> body_;
};

/// What the entries of both solvers share.
namespace bullet_ref {

/// Throws SolverFailure "exploded (box)" if a vertex is so far out that the number of its cell in
/// the colliders' distance fields overflows an int: Bullet would then read memory that is not its
/// own.
void require_cells(const btAlignedObjectArray<btSoftBody*>&);

/// A world of Bullet's that checks where it moves vertices before it looks for their contacts
/// there.
template <class World>
class BoundedWorld final : public World {
 public:
  using World::World;

 private:
  void predictUnconstraintMotion(btScalar h) override {
    World::predictUnconstraintMotion(h);
    require_cells(this->getSoftBodyArray());
  }
};

inline constexpr ParamSpec kSubsteps = ParamSpec::integer(
    "substeps", "1", 1, 1e6, "each step is this many calls of stepSimulation(dt / substeps)");
inline constexpr ParamSpec kPrecision = ParamSpec::choice(
    "precision", "double", "float|double", "which build of Bullet; float runs in taut-f32");
inline constexpr ParamSpec kMargin =
    ParamSpec::real("margin", "m", "0", 0, 1,
                    "collision margin on top of the scene's thickness (Bullet's default: 0.25)");
inline constexpr ParamSpec kVoxel =
    ParamSpec::real("voxel", "m", "0.05", 1e-3, 10,
                    "grid spacing of the colliders' distance fields (Bullet's default: 0.25, in "
                    "the deformable world 0.005)");

/// One substep [s]: dt / substeps rounded to binary32, for btSoftRigidDynamicsWorld casts its time
/// step to float even in the double build.
float substep_length(const Scene&, const Params&);

/// The program that runs the parameter "precision".
std::string_view program(const Params&);
/// Throws InputError if that is not this one.
void require_program(const std::string& solver, const Params&);

/// Reasons and lines of the resolved settings that hold for both.
std::vector<std::string> unsupported(const Scene&, const Params&);
ResolvedSettings library_settings(const Scene&, const Params&);
ResolvedSettings contact_settings(const Scene&, const Params&, const std::string& default_voxel);

/// "%.6g"
std::string short_text(double);

}  // namespace bullet_ref

}  // namespace taut
