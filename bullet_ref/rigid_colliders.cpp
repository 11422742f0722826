#include "bullet_ref/rigid_colliders.hpp"

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "bullet_ref/bullet_solver.hpp"
#include "core/model/body_frames.hpp"
#include "core/model/deforming_body.hpp"
#include "core/model/index.hpp"
#include "core/model/triangle_mesh.hpp"

namespace taut {

struct RigidPose {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Vec3 origin = Vec3::Zero();
};

namespace {

btTransform transform_of(const Eigen::Quaterniond& rotation, const Vec3& origin) {
  const Eigen::Matrix3d m = rotation.toRotationMatrix();
  const auto at = [&](int i, int j) { return static_cast<btScalar>(m(i, j)); };
  const btMatrix3x3 basis(at(0, 0), at(0, 1), at(0, 2), at(1, 0), at(1, 1), at(1, 2), at(2, 0),
                          at(2, 1), at(2, 2));
  return btTransform(basis, to_bullet(origin));
}

/// Slab that stands in for a plane; its solid side is -y. It follows a cloth that leaves its
/// middle, and is too thick for cloth to reach its far side within a time step. Larger slabs gain
/// nothing and cost GJK digits in float.
struct Slab {
  double half_width = 50, half_depth = 5;  ///< m
  /// Largest distance of the cloth's middle from the slab's, along the slab [m].
  double follows() const { return 0.4 * half_width; }
};

/// Upper bound of a vertex' displacement relative to a plane in a time step [m]: after a free fall
/// for the whole duration.
double longest_way(const Scene& scene) {
  double fastest = 0;
  for (const Vec3& v : scene.start.v) fastest = std::max(fastest, v.norm());
  double plane = 0;
  for (const Collider& c : scene.colliders)
    if (std::holds_alternative<Plane>(c.shape)) plane = std::max(plane, c.motion.velocity.norm());
  return (fastest + plane + scene.gravity.norm() * scene.dt * scene.steps) * scene.dt;
}

Slab slab_for(const Scene& scene) {
  Eigen::AlignedBox3d cloth;
  for (const Vec3& p : scene.start.x) cloth.extend(p);
  Slab slab;
  slab.half_width = std::max(slab.half_width, cloth.sizes().norm());
  slab.half_depth = std::max(slab.half_depth, 1.5 * longest_way(scene));
  return slab;
}

/// The shortest rotation of y onto a unit vector; onto -y, half a turn about x.
Eigen::Quaterniond tilt(const Vec3& normal) {
  if (normal.y() < -1 + 1e-12) return {0, 1, 0, 0};
  const double s = std::sqrt(2 * (1 + normal.y()));
  return {s / 2, normal.z() / s, 0, -normal.x() / s};
}

RigidPose slab_pose(const Plane& plane, const Vec3& above, const Slab& slab) {
  const Vec3 top = above - (plane.normal.dot(above) - plane.offset) * plane.normal;
  return {tilt(plane.normal), top - slab.half_depth * plane.normal};
}

RigidPose pose_at_start(const Shape& shape, const Vec3& above, const Slab& slab) {
  if (const auto* plane = std::get_if<Plane>(&shape)) return slab_pose(*plane, above, slab);
  if (const auto* ball = std::get_if<Ball>(&shape))
    return {Eigen::Quaterniond::Identity(), ball->center};
  if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    const Vec3 along = capsule->to - capsule->from;
    return {tilt(along.isZero(0) ? Vec3(Vec3::UnitY()) : along.normalized()), capsule->middle()};
  }
  if (const auto* body = std::get_if<MeshBody>(&shape)) return {body->rotation, body->center};
  const Box& box = std::get<Box>(shape);
  return {box.rotation, box.center};
}

}  // namespace

/// A body's triangles in Bullet's form, and the shape that refers to them.
class TriangleShape {
 public:
  explicit TriangleShape(const TriangleMesh& mesh) {
    place(mesh.vertices());
    for (const Triangle& t : mesh.triangles()) indices_.insert(indices_.end(), t.begin(), t.end());
    btIndexedMesh part;
    part.m_numTriangles = static_cast<int>(mesh.triangles().size());
    part.m_triangleIndexBase = reinterpret_cast<const unsigned char*>(indices_.data());
    part.m_triangleIndexStride = 3 * sizeof(int);
    part.m_numVertices = static_cast<int>(mesh.vertices().size());
    part.m_vertexBase = reinterpret_cast<const unsigned char*>(vertices_.data());
    part.m_vertexStride = 3 * sizeof(btScalar);
    array_.addIndexedMesh(part, PHY_INTEGER);
    constexpr bool kCompressed = true;  // boxes of the tree, Bullet's default
    shape_.emplace(&array_, kCompressed);
    shape_->setMargin(0);
  }
  btBvhTriangleMeshShape& shape() { return *shape_; }

  /// Moves the vertices and refits the tree. Boxes of Bullet's tree are integers within the bounds
  /// with which it is made or refitted.
  void refit(const std::vector<Vec3>& x) {
    place(x);
    btVector3 least, most;
    array_.calculateAabbBruteForce(least, most);
    shape_->refitTree(least, most);
    shape_->recalcLocalAabb();
  }

 private:
  void place(const std::vector<Vec3>& x) {
    vertices_.resize(3 * x.size());
    auto at = vertices_.begin();
    for (const Vec3& p : x)
      for (const double c : p) *at++ = static_cast<btScalar>(c);
  }

  std::vector<btScalar> vertices_;
  std::vector<int> indices_;
  btTriangleIndexVertexArray array_;
  std::optional<btBvhTriangleMeshShape> shape_;
};

namespace {

/// Reads the triangles from the arrays to which the shape itself refers.
std::shared_ptr<const TriangleMesh> triangles_of(const btBvhTriangleMeshShape& shape) {
  const unsigned char *vertices = nullptr, *indices = nullptr;
  int vertex_count = 0, vertex_stride = 0, triangle_count = 0, triangle_stride = 0;
  PHY_ScalarType number{}, index{};
  shape.getMeshInterface()->getLockedReadOnlyVertexIndexBase(
      &vertices, vertex_count, number, vertex_stride, &indices, triangle_stride, triangle_count,
      index);
  std::vector<Vec3> x;
  for (int v = 0; v < vertex_count; ++v) {
    const auto* at = reinterpret_cast<const btScalar*>(vertices + v * vertex_stride);
    x.emplace_back(at[0], at[1], at[2]);
  }
  std::vector<Triangle> triangles;
  for (int t = 0; t < triangle_count; ++t) {
    const auto* at = reinterpret_cast<const int*>(indices + t * triangle_stride);
    triangles.push_back({at[0], at[1], at[2]});
  }
  shape.getMeshInterface()->unLockReadOnlyVertexBase(0);
  return std::make_shared<const TriangleMesh>(std::move(x), std::move(triangles));
}

/// Whether the body is solid, in one piece, and bent inward along no edge.
bool is_convex(const MeshBody& body) {
  const TriangleMesh& mesh = *body.mesh;
  if (body.sides != MeshBody::Sides::out || !mesh.closed()) return false;
  const double rounding = 1e-9 * mesh.reach();
  std::vector<char> seen(mesh.triangles().size());
  std::vector<int> ahead{0};
  seen[0] = 1;
  std::size_t reached = 1;
  while (!ahead.empty()) {
    const int t = ahead.back();
    ahead.pop_back();
    const Vec3& corner = mesh.vertices()[to_index(mesh.triangles()[to_index(t)][0])];
    for (int k = 0; k < 3; ++k) {
      const int edge = mesh.beyond(t, k), other = edge / 3;
      const int opposite = mesh.triangles()[to_index(other)][to_index((edge + 2) % 3)];
      if (mesh.normal(t).dot(mesh.vertices()[to_index(opposite)] - corner) > rounding) return false;
      if (std::exchange(seen[to_index(other)], 1)) continue;
      ++reached;
      ahead.push_back(other);
    }
  }
  return reached == seen.size();
}

/// Convex hull shape with all corners of the mesh, in their order.
std::unique_ptr<btConvexHullShape> hull_of(const TriangleMesh& mesh) {
  auto made = std::make_unique<btConvexHullShape>();
  for (const Vec3& x : mesh.vertices()) made->addPoint(to_bullet(x), false);
  made->recalcLocalAabb();
  made->setMargin(0);
  return made;
}

std::shared_ptr<const TriangleMesh> triangles_of(const btConvexHullShape& hull,
                                                 const std::vector<Triangle>& triangles) {
  std::vector<Vec3> x;
  for (int v = 0; v < hull.getNumPoints(); ++v) x.push_back(from_bullet(hull.getScaledPoint(v)));
  return std::make_shared<const TriangleMesh>(std::move(x), triangles);
}

std::unique_ptr<btCollisionShape> make_shape(const Shape& shape, const Slab& slab) {
  if (const auto* body = std::get_if<MeshBody>(&shape)) return hull_of(*body->mesh);
  if (const auto* ball = std::get_if<Ball>(&shape))
    return std::make_unique<btSphereShape>(static_cast<btScalar>(ball->radius));
  if (const auto* capsule = std::get_if<Capsule>(&shape))
    return std::make_unique<btCapsuleShape>(
        static_cast<btScalar>(capsule->radius),
        static_cast<btScalar>((capsule->to - capsule->from).norm()));
  const auto* box = std::get_if<Box>(&shape);
  const Vec3 half =
      box ? box->half_extents : Vec3(slab.half_width, slab.half_depth, slab.half_width);
  auto made = std::make_unique<btBoxShape>(to_bullet(half));
  made->setMargin(0);  // the default rounds a box by 0.04 m
  return made;
}

Eigen::AlignedBox3d extent_of(const std::vector<Vec3>& points) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : points) box.extend(p);
  return box;
}

/// The rigid motion that takes points nearest to where they are later, by least squares (Umeyama,
/// Least-Squares Estimation of Transformation Parameters Between Two Point Patterns, 1991).
RigidPose pose_of(const std::vector<Vec3>& points, const std::vector<Vec3>& later) {
  const auto columns = [](const std::vector<Vec3>& all) {
    return Eigen::Map<const Eigen::Matrix3Xd>(all.front().data(), 3,
                                              static_cast<Eigen::Index>(all.size()));
  };
  const Eigen::Matrix4d m = Eigen::umeyama(columns(points), columns(later), false);
  return {Eigen::Quaterniond(Eigen::Matrix3d(m.topLeftCorner<3, 3>())), m.topRightCorner<3, 1>()};
}

}  // namespace

bool deforms(const Collider& collider) {
  if (!collider.frames) return false;
  const auto& places = collider.frames->places;
  const std::vector<Vec3>& first = places.front();
  const double within = 1e-3 * extent_of(first).diagonal().norm();
  const auto is_off = [&](const std::vector<Vec3>& x) {
    const RigidPose pose = pose_of(first, x);
    for (std::size_t i = 0; i < x.size(); ++i)
      if (!((pose.rotation * first[i] + pose.origin - x[i]).norm() <= within)) return true;
    return false;
  };
  for (std::size_t k = 1; k < places.size(); ++k)
    if (is_off(places[k]) ||
        is_off(collider.frames->at((static_cast<double>(k) - 0.5) / collider.frames->fps)))
      return true;
  return false;
}

bool is_met_by_triangles(const Collider& collider) {
  const auto* body = std::get_if<MeshBody>(&collider.shape);
  return body && (!is_convex(*body) || deforms(collider));
}

struct RigidColliders::Body {
  Body(const Collider& collider, const Vec3& above, const Slab& slab)
      : start(pose_at_start(collider.shape, above, slab)),
        motion(collider.motion),
        is_plane(std::holds_alternative<Plane>(collider.shape)),
        follows(slab.follows()),
        body(is_met_by_triangles(collider)
                 ? std::make_unique<TriangleShape>(*std::get<MeshBody>(collider.shape).mesh)
                 : nullptr),
        frames(collider.frames),
        surface(deforms(collider) ? std::make_unique<DeformingBody>(collider) : nullptr),
        sides(body ? std::get<MeshBody>(collider.shape).sides : MeshBody::Sides::out),
        hull(body || !std::holds_alternative<MeshBody>(collider.shape)
                 ? nullptr
                 : std::get<MeshBody>(collider.shape).mesh),
        shape(body ? nullptr : make_shape(collider.shape, slab)),
        rigid(btRigidBody::btRigidBodyConstructionInfo(
            0, nullptr, body ? static_cast<btCollisionShape*>(&body->shape()) : shape.get())) {
    rigid.setFriction(static_cast<btScalar>(collider.friction));
    rigid.setRestitution(0);
    if (moves()) {
      rigid.setCollisionFlags(rigid.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
      rigid.setActivationState(DISABLE_DEACTIVATION);
    }
    rigid.setWorldTransform(at(0));
    rigid.setInterpolationWorldTransform(at(0));
  }

  bool moves() const { return frames || !motion.at_rest(); }

  /// What the frames of a rigid body have done until time t [s], in its own frame.
  RigidPose by_frames(double t) const {
    if (!frames || surface) return {};
    return pose_of(frames->places.front(), frames->at(t));
  }
  btTransform at(double t) const {
    const RigidPose own = by_frames(t);
    return transform_of(motion.rotation(t) * start.rotation * own.rotation,
                        motion.moved(start.origin + start.rotation * own.origin, t));
  }

  /// Shifts a slab along itself to below the cloth's middle at time t [s] if that is far away.
  void follow(double t, const Vec3& cloth) {
    if (!is_plane) return;
    const Eigen::Quaterniond turned = motion.rotation(t);
    const Vec3 normal = turned * start.rotation * Vec3::UnitY();
    Vec3 way = cloth - motion.moved(start.origin, t);
    way -= normal.dot(way) * normal;
    if (!(way.norm() > follows)) return;  // also if it is NaN
    start.origin += turned.conjugate() * way;
    rigid.setWorldTransform(at(t));
    rigid.setInterpolationWorldTransform(at(t));
  }

  RigidPose start;
  Motion motion;
  bool is_plane;
  double follows;                            ///< m, for a slab
  std::unique_ptr<TriangleShape> body;       ///< null: not a mesh
  std::shared_ptr<const BodyFrames> frames;  ///< null: none
  std::unique_ptr<DeformingBody> surface;    ///< for a body that deforms, in this substep
  MeshBody::Sides sides;                     ///< of a mesh; Bullet does not know it
  /// Mesh whose corners the shape has; null: another shape.
  std::shared_ptr<const TriangleMesh> hull;
  std::unique_ptr<btCollisionShape> shape;
  btRigidBody rigid;
};

RigidColliders::RigidColliders(const Scene& scene, btDiscreteDynamicsWorld& world) : world_(world) {
  for (const Collider& collider : scene.colliders) {
    bodies_.push_back(
        std::make_unique<Body>(collider, extent_of(scene.start.x).center(), slab_for(scene)));
    world_.addRigidBody(&bodies_.back()->rigid);
  }
}

RigidColliders::~RigidColliders() {
  for (const auto& body : bodies_) world_.removeRigidBody(&body->rigid);
}

void RigidColliders::follow(double t, const Vec3& cloth) {
  for (const auto& body : bodies_) body->follow(t, cloth);
}

void RigidColliders::move(double from, double to) {
  for (const auto& body : bodies_) {
    if (!body->moves()) continue;
    body->rigid.setInterpolationWorldTransform(body->at(from));
    body->rigid.setWorldTransform(body->at(to));
    if (body->surface) deform(*body, from, to);
  }
}

/// Moves a deforming body. Bullet's soft bodies keep a hull of every triangle that they have met,
/// as it was then, while the pair of bodies lasts; so the pair is removed.
void RigidColliders::deform(Body& body, double from, double to) {
  body.surface->move(from, to);
  body.body->refit(body.surface->after().vertices());
  world_.updateSingleAabb(&body.rigid);
  world_.getBroadphase()->getOverlappingPairCache()->cleanProxyFromPairs(
      body.rigid.getBroadphaseHandle(), world_.getDispatcher());
}

bool RigidColliders::deform() const {
  return std::ranges::any_of(bodies_, [](const auto& body) { return body->surface != nullptr; });
}

RigidColliders::Body* RigidColliders::deforming(const void* rigid) const {
  for (const auto& body : bodies_)
    if (&body->rigid == rigid && body->surface) return body.get();
  return nullptr;
}

btRigidBody& RigidColliders::moving_at(const btVector3& velocity, std::size_t contact) {
  if (contact == carriers_.size())
    carriers_.push_back(std::make_unique<btRigidBody>(
        btRigidBody::btRigidBodyConstructionInfo(0, nullptr, nullptr)));
  carriers_[contact]->setLinearVelocity(velocity);
  return *carriers_[contact];
}

void RigidColliders::carry(btSoftBody& cloth, double h) {
  std::size_t contacts = 0;
  const auto carry = [&](btSoftBody::sCti& contact,
                         const btVector3& x) -> std::optional<btVector3> {
    const Body* const body = deforming(contact.m_colObj);
    if (!body) return {};
    const DeformingBody& surface = *body->surface;
    const Vec3 place = surface.local(from_bullet(x));
    const PlaceMotion motion = surface.motion_of(surface.after().nearest(place), place);
    const btVector3 way = to_bullet(surface.world(motion.to) - surface.world_before(motion.from));
    contact.m_colObj = &moving_at(way / static_cast<btScalar>(h), contacts++);
    return way;
  };
  for (int i = 0; i < cloth.m_rcontacts.size(); ++i) {
    btSoftBody::RContact& c = cloth.m_rcontacts[i];
    const btScalar friction = cloth.m_cfg.kDF * c.m_cti.m_colObj->getFriction();
    const auto way = carry(c.m_cti, c.m_node->m_x);
    if (!way) continue;
    // Repeat what Bullet decided from the body's velocity (btSoftColliders::CollideSDF_RS).
    const btVector3 slip = c.m_node->m_x - c.m_node->m_q - *way;
    const btScalar into = slip.dot(c.m_cti.m_normal), holds = into * friction;
    const btVector3 along = slip - c.m_cti.m_normal * into;
    c.m_c3 = along.length2() < holds * holds ? 0 : 1 - friction;
  }
  for (int i = 0; i < cloth.m_nodeRigidContacts.size(); ++i)
    carry(cloth.m_nodeRigidContacts[i].m_cti, cloth.m_nodeRigidContacts[i].m_node->m_x);
}

std::size_t RigidColliders::bytes() const {
  return bodies_.size() * (sizeof(Body) + sizeof(btBoxShape));
}

std::vector<Collider> RigidColliders::read_back(double t) const {
  std::vector<Collider> colliders;
  for (const auto& body : bodies_) {
    const btTransform& now = body->rigid.getWorldTransform();
    const btQuaternion q = now.getRotation();
    const Eigen::Quaterniond turned = body->motion.rotation(t).conjugate();
    const Eigen::Quaterniond turned_back =
        turned * Eigen::Quaternion<btScalar>(q.w(), q.x(), q.y(), q.z()).cast<double>();
    const Vec3& pivot = body->motion.pivot;
    const Vec3 moved = from_bullet(now.getOrigin()) - body->motion.displacement(t);
    const RigidPose own = body->by_frames(t);
    const Eigen::Quaterniond rotation = turned_back * own.rotation.conjugate();
    const Vec3 origin = pivot + turned * (moved - pivot) - rotation * own.origin;
    Collider collider{.motion = body->motion,
                      .friction = static_cast<double>(body->rigid.getFriction()),
                      .frames = body->frames};
    const btCollisionShape* shape = body->rigid.getCollisionShape();
    if (const auto* triangles = dynamic_cast<const btBvhTriangleMeshShape*>(shape)) {
      collider.shape = MeshBody{triangles_of(*triangles), origin, rotation, body->sides};
    } else if (const auto* hull = dynamic_cast<const btConvexHullShape*>(shape)) {
      collider.shape =
          MeshBody{triangles_of(*hull, body->hull->triangles()), origin, rotation, body->sides};
    } else if (const auto* ball = dynamic_cast<const btSphereShape*>(shape)) {
      collider.shape = Ball{origin, static_cast<double>(ball->getRadius())};
    } else if (const auto* round = dynamic_cast<const btCapsuleShape*>(shape)) {
      const Vec3 half = static_cast<double>(round->getHalfHeight()) * (rotation * Vec3::UnitY());
      collider.shape =
          Capsule{origin - half, origin + half, static_cast<double>(round->getRadius())};
    } else {
      const auto& box = dynamic_cast<const btBoxShape&>(*shape);
      const Vec3 half = from_bullet(box.getHalfExtentsWithoutMargin());
      const Vec3 normal = rotation * Vec3::UnitY();
      if (body->is_plane)
        collider.shape = Plane{normal, normal.dot(origin) + half.y()};
      else
        collider.shape = Box{origin, half, rotation};
    }
    colliders.push_back(std::move(collider));
  }
  return colliders;
}

}  // namespace taut
