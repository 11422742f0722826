#pragma once

#include <memory>
#include <vector>

#include "core/model/scene.hpp"

class btDiscreteDynamicsWorld;
class btRigidBody;
class btSoftBody;
class btVector3;

namespace taut {

/// Thickness of the hull that Bullet makes of a triangle, on each of its sides, and the hull's
/// margin [m]. No caller can set them; the former is Bullet's BT_SOFTBODY_TRIANGLE_EXTRUSION.
inline constexpr double kTriangleExtrusion = 0.06, kTriangleMargin = 0.04;

/// Whether the collider has frames that do not move it as a rigid body, to a thousandth of its size
/// at frames and between them. A body whose frames only move it is rigid.
bool deforms(const Collider&);

/// Whether Bullet collides with the body triangle by triangle. It does so unless the body is
/// convex, "out" and does not deform. Each triangle is then a hull of kTriangleExtrusion and
/// kTriangleMargin, whatever the body's sides are, and cloth rests above it by at least the former
/// and at most the sum of both.
bool is_met_by_triangles(const Collider&);

/// A scene's colliders as Bullet's rigid bodies, in the scene's order. A ball is a btSphereShape, a
/// capsule a btCapsuleShape (along its own y) and a box a btBoxShape. A plane is the top of a
/// btBoxShape slab, because btStaticPlaneShape tunnels and lets the cloth rest 0.10 m too high.
/// Boxes have shape margin 0; a sphere's and a capsule's is its radius. A body of triangles is the
/// btConvexHullShape of its corners if it is convex, otherwise a btBvhTriangleMeshShape, which is
/// refitted if it deforms. Bodies that move are kinematic.
class RigidColliders {
 public:
  /// Adds the bodies to the world, which must outlive this object. Slabs are centred below the
  /// middle of the scene's start, 100 m wide or twice as wide as the cloth.
  RigidColliders(const Scene&, btDiscreteDynamicsWorld&);
  ~RigidColliders();
  RigidColliders(const RigidColliders&) = delete;
  RigidColliders& operator=(const RigidColliders&) = delete;

  /// Keeps slabs below the cloth's middle, which is at `cloth` [m] at time t [s].
  void follow(double t, const Vec3& cloth);

  /// Moves the moving bodies to where they are at time `to` [s]. Bullet derives their velocity from
  /// where they were at time `from`.
  void move(double from, double to);

  /// Whether any body deforms.
  bool deform() const;
  /// Gives contacts with deforming bodies the velocity of the surface. Bullet asks the body of a
  /// contact for its velocity, and a rigid body has no velocity of its surface. Each such contact
  /// that is found and not solved yet is given a body of its own instead, which moves as the
  /// surface does there in this substep of h [s].
  void carry(btSoftBody& cloth, double h);

  bool empty() const { return bodies_.empty(); }
  /// Bytes of bodies and shapes.
  std::size_t bytes() const;

  /// The colliders that Bullet holds: shapes and friction are read from the bodies at time t [s],
  /// with their motion up to then undone. The motions are this object's own, because Bullet has
  /// none.
  std::vector<Collider> read_back(double t) const;

 private:
  struct Body;
  void deform(Body&, double from, double to);
  Body* deforming(const void* rigid) const;  ///< null: not a deforming body
  btRigidBody& moving_at(const btVector3& velocity, std::size_t contact);

  btDiscreteDynamicsWorld& world_;
  std::vector<std::unique_ptr<Body>> bodies_;
  std::vector<std::unique_ptr<btRigidBody>> carriers_;  ///< for contacts; not in any world
};

}  // namespace taut
