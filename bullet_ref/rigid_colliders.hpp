#pragma once

#include <memory>
#include <vector>

#include "core/model/scene.hpp"

class btDiscreteDynamicsWorld;
class btRigidBody;
class btSoftBody;
class btVector3;

namespace taut {

/// A body whose triangles Bullet meets one by one, as hulls that are 0.06 m thick on both sides
/// (BT_SOFTBODY_TRIANGLE_EXTRUSION) and have a margin of 0.04 m, whatever the body's sides are:
/// cloth rests 0.06 to 0.1 m above it. It is that unless it is convex, "out" and does not deform.
bool is_met_by_triangles(const Collider&);

/// A scene's colliders as Bullet's rigid bodies, in the scene's order: a ball as btSphereShape, a
/// capsule as btCapsuleShape (along its own y), a box as btBoxShape, a plane as the top of a
/// btBoxShape slab (btStaticPlaneShape tunnels and lets the cloth rest 0.10 m too high). Boxes have
/// shape margin 0; a sphere's and a capsule's is its radius. A body of triangles is the
/// btConvexHullShape of its corners if it is convex, else a btBvhTriangleMeshShape, which is
/// refitted where it deforms. Bodies that move are kinematic.
class RigidColliders {
 public:
  /// Adds the bodies to the world, which must outlive this object. Slabs are centred below the
  /// middle of the scene's start, 100 m wide or twice as wide as the cloth.
  RigidColliders(const Scene&, btDiscreteDynamicsWorld&);
  ~RigidColliders();
  RigidColliders(const RigidColliders&) = delete;
  RigidColliders& operator=(const RigidColliders&) = delete;

  /// Keeps slabs below the middle of the cloth [m], which is there at time t [s].
  void follow(double t, const Vec3& cloth);

  /// Places the moving bodies where they are at time to [s]; Bullet takes their velocity from where
  /// they were at time from.
  void move(double from, double to);

  /// Whether any body deforms.
  bool deform() const;
  /// Bullet asks the body of a contact for its velocity, and a rigid body has none of its surface.
  /// So each contact with a body that deforms, found and not solved yet, gets a body of its own in
  /// its place, which moves as the surface does there in this substep [s].
  void carry(btSoftBody& cloth, double h);

  bool empty() const { return bodies_.empty(); }
  /// Bytes of bodies and shapes.
  std::size_t bytes() const;

  /// What Bullet holds: shapes and friction from the bodies as they stand at time t [s] with the
  /// motion up to then taken back; the motions themselves are this object's, for Bullet knows none.
  std::vector<Collider> read_back(double t) const;

 private:
  struct Body;
  void deform(Body&, double from, double to);
  Body* deforming(const void* rigid) const;  ///< null: another one
  btRigidBody& moving_at(const btVector3& velocity, std::size_t contact);

  btDiscreteDynamicsWorld& world_;
  std::vector<std::unique_ptr<Body>> bodies_;
  std::vector<std::unique_ptr<btRigidBody>> carriers_;  ///< of contacts, in no world
};

}  // namespace taut
