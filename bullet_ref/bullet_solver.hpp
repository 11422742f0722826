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

/// Settings of the cloth that no scene has.
struct ClothOptions {
  double stiffness = 1;  ///< kLST of every link
  double margin = 0;     ///< m, on top of the scene's thickness
  bool faces = true;     ///< the mesh's, in its order; without faces Bullet computes no normals
  /// Order links by ReoptimizeLinkOrder; otherwise they are in the scene's order.
  bool reorder = false;
};

/// Builds the scene's cloth, node by node and link by link, at rest in its rest shape. Material i
/// belongs to family i; deactivation is off.
std::unique_ptr<btSoftBody> build_cloth(btSoftBodyWorldInfo&, const Scene&, const ClothOptions&);

/// The field of a link from which its solver reads the rest length.
enum class RestLength { m_rl, m_c1 };

/// Number of links that share a vertex with the link before them in the order of solution. Each of
/// them waits for the result of the link before it.
int waiting_links(const btSoftBody&);

/// Base of both of Bullet's cloths: the scene's cloth and colliders in a Bullet world that the
/// derived class owns, advanced by substeps. Only the .cpp files of this folder include this.
class BulletSolver : public Solver, public HoldsScene {
 public:
  void step(double t, double dt) final;
  std::vector<PassCost> step_cost() const final;

 protected:
  /// Builds colliders and cloth, which the derived class adds to its world. Reads the parameters
  /// "substeps" and "voxel".
  BulletSolver(const Scene&, const Params&, btDiscreteDynamicsWorld&, btSoftBodyWorldInfo&,
               const ClothOptions&);

  /// Moves the colliders to their positions at the end of a substep.
  void move_colliders(double from, double to);
  /// Advances from `from` to `to` by stepSimulation(h_, 0): with its default arguments it steps by
  /// 1/60 s.
  virtual void substep(double from, double to) = 0;
  /// Costs of solving links and contacts in one step.
  virtual std::vector<PassCost> solve_cost() const = 0;
  /// Bytes of the wind's data besides the scene's triangles.
  virtual std::size_t wind_bytes() const { return 0; }

  /// The scene as held: by the body and the colliders, and by the adapter, which applies motions of
  /// pins and wind at each substep because Bullet has no place for them. Damping is left to the
  /// derived class.
  Scene held_scene(RestLength) const;

  btSoftBody::Node& node(std::size_t i) { return body_->m_nodes[static_cast<int>(i)]; }
  const btSoftBody::Node& node(std::size_t i) const { return body_->m_nodes[static_cast<int>(i)]; }

  Scene scene_;
  double margin_;
  int substeps_;
  btScalar h_;  ///< s, length of a substep
  RigidColliders colliders_;
  std::unique_ptr<btSoftBody> body_;
};

/// Functions that the entries of both solvers share.
namespace bullet_ref {

/// Throws SolverFailure "exploded (box)" if a vertex is so far out that its cell number in the
/// colliders' distance fields overflows an int: Bullet would then read foreign memory.
void require_cells(const btAlignedObjectArray<btSoftBody*>&);

/// A Bullet world that checks the predicted positions of vertices before it searches for contacts
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
inline constexpr ParamSpec kPrecision =
    ParamSpec::choice("precision", "double", "float|double",
                      "which build of Bullet; float runs in taut-f32")
        .as(ParamSpec::Role::precision);
inline constexpr ParamSpec kMargin =
    ParamSpec::real("margin", "m", "0", 0, 1,
                    "collision margin on top of the scene's thickness (Bullet's default: 0.25)");
inline constexpr ParamSpec kVoxel =
    ParamSpec::real("voxel", "m", "0.05", 1e-3, 10,
                    "grid spacing of the colliders' distance fields (Bullet's default: 0.25, in "
                    "the deformable world 0.005)");

/// Length of a substep [s]: dt / substeps rounded to binary32, because btSoftRigidDynamicsWorld
/// casts its time step to float even in the double build.
float substep_length(const Scene&, const Params&);

/// The program that runs the precision of parameter "precision".
std::string_view program(const Params&);
/// Throws InputError if this is not that program.
void require_program(const std::string& solver, const Params&);

/// Reasons and resolved settings that both solvers share.
std::vector<std::string> unsupported(const Scene&, const Params&);
ResolvedSettings library_settings(const Scene&, const Params&);
ResolvedSettings contact_settings(const Scene&, const Params&, const std::string& default_voxel);

/// "%.6g"
std::string short_text(double);

}  // namespace bullet_ref

}  // namespace taut
