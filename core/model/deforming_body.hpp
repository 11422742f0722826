#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "core/model/collider.hpp"
#include "core/model/triangle.hpp"
#include "core/model/triangle_mesh.hpp"

namespace taut {

/// Motion of the neighbourhood of a point that is fixed to a moving triangle: the point keeps its
/// barycentric coordinates, and its surroundings turn as the triangle turns.
struct PlaceMotion {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< m
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();

  Vec3 operator()(const Vec3& p) const { return to + turn * (p - from); }
};

/// A collider whose triangles move by themselves, between two moments. In its own frame, which
/// moves by the collider's `motion`, every vertex goes straight from its position at the first
/// moment to that at the second. Points are in that frame, except those of local_before(), local(),
/// world_before() and world().
class DeformingBody {
 public:
  /// Precondition: the collider has frames. Both moments are set to t = 0.
  explicit DeformingBody(const Collider&);

  /// Sets the two moments [s].
  void move(double from, double to);

  const TriangleMesh& before() const { return *before_; }
  const TriangleMesh& after() const { return *after_; }
  /// The body at the end; its mesh changes with the next move().
  MeshBody body() const;
  bool is_thin() const { return pose_.sides == MeshBody::Sides::both; }
  /// Longest displacement of a vertex [m].
  double longest_way() const { return longest_way_; }

  Vec3 local_before(const Vec3& world) const {
    return axes_before_.transpose() * (world - center_before_);
  }
  Vec3 world_before(const Vec3& local) const { return center_before_ + axes_before_ * local; }
  Vec3 local(const Vec3& world) const { return axes_.transpose() * (world - pose_.center); }
  Vec3 world(const Vec3& local) const { return pose_.center + axes_ * local; }
  Vec3 turned_to_world(const Vec3& local) const { return axes_ * local; }
  /// Vector in the world at the end that is `world` at the start and is fixed to the triangle.
  Vec3 turned(int triangle, const Vec3& world) const {
    return axes_ * (motion_of(triangle, Vec3::UnitX()).turn * (axes_before_.transpose() * world));
  }

  /// The first triangle that a point passes through on its straight path, the start included and
  /// the end excluded: the first root of the cubic for which point and triangle are in one plane.
  /// The share is that of the time; `inward` means against the triangle's normal there.
  std::optional<MeshHit> first_hit(const Vec3& from, const Vec3& to) const;
  /// All triangles that the point passes through, in the order of time.
  std::vector<MeshHit> hits(const Vec3& from, const Vec3& to) const;

  /// Motion at the point of the triangle with these barycentric coordinates.
  PlaceMotion motion_of(int triangle, const Vec3& weights) const;
  PlaceMotion motion_of(const NearestPlace& at_the_end, const Vec3& p) const;
  /// Barycentric coordinates of a point that passes through the triangle there.
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

/// A pass of a point through a triangle, while all of them move straight: the share of the time,
/// and whether it goes against the normal.
struct TrianglePass {
  double share = 0;
  bool inward = false;
};
/// All passes, in the order of time; at most three.
std::vector<TrianglePass> passes(const Corners& before, const Corners& after, const Vec3& from,
                                 const Vec3& to);

/// An edge whose ends move straight.
struct MovingEdge {
  std::array<Vec3, 2> before, now;  ///< m

  Vec3 end(std::size_t which, double share) const {
    return before[which] + share * (now[which] - before[which]);
  }
};
/// A moment at which two edges come into one plane, whether they meet or not: the share of the
/// time, and whether (p - q) . (u x v) rises, where p and q are their first ends and u and v lead
/// from these to their second ends.
struct LinePass {
  double share = 0;
  bool rises = false;
};
/// All such moments in the order of time, the start included and the end excluded; at most three.
std::vector<LinePass> passes(const MovingEdge& one, const MovingEdge& other);

}  // namespace taut
