#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "core/model/collider.hpp"
#include "core/model/triangle.hpp"
#include "core/model/triangle_mesh.hpp"

namespace taut {

/// Where the neighbourhood of a place goes that is fixed to a triangle which moves: the place by
/// its barycentric coordinates, what is around it turned as the triangle turns.
struct PlaceMotion {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< m
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();

  Vec3 operator()(const Vec3& p) const { return to + turn * (p - from); }
};

/// A collider whose triangles move by themselves, between two moments: in its own frame, which
/// moves as the collider's `motion` says, every vertex goes straight from where it is at the one to
/// where it is at the other. Points are in that frame but for those of local_before(), local(),
/// world_before() and world().
class DeformingBody {
 public:
  /// Precondition: the collider has frames. Both moments are t = 0.
  explicit DeformingBody(const Collider&);

  /// From one time to another [s].
  void move(double from, double to);

  const TriangleMesh& before() const { return *before_; }
  const TriangleMesh& after() const { return *after_; }
  /// As it is at the end; its mesh changes with the next move().
  MeshBody body() const;
  bool is_thin() const { return pose_.sides == MeshBody::Sides::both; }
  double longest_way() const { return longest_way_; }  ///< m, of a vertex

  Vec3 local_before(const Vec3& world) const {
    return axes_before_.transpose() * (world - center_before_);
  }
  Vec3 world_before(const Vec3& local) const { return center_before_ + axes_before_ * local; }
  Vec3 local(const Vec3& world) const { return axes_.transpose() * (world - pose_.center); }
  Vec3 world(const Vec3& local) const { return pose_.center + axes_ * local; }
  Vec3 turned_to_world(const Vec3& local) const { return axes_ * local; }
  /// A vector that is fixed to the triangle, from the start to the end; both in the world.
  Vec3 turned(int triangle, const Vec3& world) const {
    return axes_ * (motion_of(triangle, Vec3::UnitX()).turn * (axes_before_.transpose() * world));
  }

  /// The first triangle that a point on its straight way goes through, the start included and the
  /// end not: the first root of the cubic by which point and triangle are in one plane. The share
  /// is that of the time, `inward` against the triangle's normal there.
  std::optional<MeshHit> first_hit(const Vec3& from, const Vec3& to) const;
  /// All of them, in the order of time.
  std::vector<MeshHit> hits(const Vec3& from, const Vec3& to) const;

  /// Of the place with these barycentric coordinates.
  PlaceMotion motion_of(int triangle, const Vec3& weights) const;
  PlaceMotion motion_of(const NearestPlace& at_the_end, const Vec3& p) const;
  /// Of a point that goes through the triangle there.
  Vec3 weights_at(const MeshHit&, const Vec3& p) const;
  PlaceMotion motion_of_before(const NearestPlace& at_the_start, const Vec3& p) const;

  std::size_t bytes() const;

 private:
  template <class Visit>
  void along(const Vec3& from, const Vec3& to, const Visit& visit) const;
  Corners corners(const TriangleMesh& mesh, int triangle) const;

  std::shared_ptr<const BodyFrames> frames_;
  Motion motion_;
  MeshBody start_, pose_;  ///< at t = 0; at the end
  std::shared_ptr<TriangleMesh> before_, after_;
  double end_ = 0;  ///< s
  Vec3 center_before_;
  Eigen::Matrix3d axes_before_, axes_;
  double longest_way_ = 0;
};

/// The shares of the time at which a point passes the plane of a triangle within it, all of them
/// going straight; with whether it goes against the normal. At most three, in their order.
struct TrianglePass {
  double share = 0;
  bool inward = false;
};
std::vector<TrianglePass> passes(const Corners& before, const Corners& after, const Vec3& from,
                                 const Vec3& to);

/// An edge whose ends go straight.
struct MovingEdge {
  std::array<Vec3, 2> before, now;  ///< m

  Vec3 end(std::size_t which, double share) const {
    return before[which] + share * (now[which] - before[which]);
  }
};
/// The shares of the time at which two edges come into one plane, within each other or not, the
/// start included and the end not; with whether (p - q) . (u x v), of their first ends and of their
/// ways to the second ones, rises. At most three, in their order.
struct LinePass {
  double share = 0;
  bool rises = false;
};
std::vector<LinePass> passes(const MovingEdge& one, const MovingEdge& other);

}  // namespace taut
