#pragma once

#include <memory>
#include <string_view>
#include <variant>
#include <vector>

#include "core/model/vec3.hpp"

namespace taut {

class TriangleMesh;
struct BodyFrames;

/// Solid below the plane { x : normal . x = offset }.
struct Plane {
  Vec3 normal = Vec3::UnitY();  ///< unit, points out of the solid
  double offset = 0;            ///< m
};

struct Ball {
  Vec3 center = Vec3::Zero();  ///< m
  double radius = 0;           ///< m, > 0
};

struct Box {
  Vec3 center = Vec3::Zero();        ///< m
  Vec3 half_extents = Vec3::Zero();  ///< m, > 0 each, along the box's own axes
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< box axes -> world
};

/// All points within the radius of an axis; with an axis of no length it is a ball.
struct Capsule {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< m, the ends of the axis
  double radius = 0;                            ///< m, > 0

  Vec3 middle() const { return (from + to) / 2; }
  Vec3 nearest_on_axis(const Vec3& p) const;
  /// A unit vector across the axis; upward if the axis has no length.
  Vec3 beside() const;
};

/// A body of triangles (core/model/triangle_mesh.hpp): solid, or thin with two sides.
struct MeshBody {
  enum class Sides {
    out,  ///< solid behind its triangles, which are closed and face outward
    both  ///< thin: the cloth stays on the side where it is
  };
  std::shared_ptr<const TriangleMesh> mesh;  ///< in the body's own frame; never null in a Scene
  Vec3 center = Vec3::Zero();                ///< m, position of the frame's origin
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< frame -> world
  Sides sides = Sides::out;
};

using Shape = std::variant<Plane, Ball, Box, Capsule, MeshBody>;
std::string_view type_name(const Shape&);
/// One of each type, at its defaults.
std::vector<Shape> shapes_of_each_type();

/// A prescribed rigid motion, known in advance and never influenced by the cloth. The displacement
/// is velocity * t plus the path, which is linear between its keys and constant before the first
/// and after the last. The rotation is by spin * t about pivot. All zero and empty: at rest.
struct Motion {
  struct Key {
    double t = 0;                      ///< s, strictly increasing
    Vec3 displacement = Vec3::Zero();  ///< m from the start
  };
  Vec3 velocity = Vec3::Zero();  ///< m/s
  Vec3 spin = Vec3::Zero();      ///< rad/s about the world axis through pivot
  Vec3 pivot = Vec3::Zero();     ///< m
  std::vector<Key> path;

  bool at_rest() const { return velocity.isZero(0) && spin.isZero(0) && path.empty(); }
  Vec3 displacement(double t) const;            ///< m at time t [s]
  Eigen::Quaterniond rotation(double t) const;  ///< at time t [s]
  Vec3 moved(const Vec3& start,
             double t) const;  ///< where a point that starts at `start` is at time t
};

/// An obstacle: rigid, except for a body of triangles with frames, which deforms in its own frame.
struct Collider {
  Shape shape;  ///< at t = 0
  Motion motion;
  double friction = 0;                            ///< Coulomb coefficient, >= 0
  std::shared_ptr<const BodyFrames> frames = {};  ///< of a MeshBody's vertices; null: rigid

  bool at_rest() const { return !frames && motion.at_rest(); }
};

/// Shape at time t [s].
Shape shape_at(const Collider&, double t);

/// Positions [m] at t + h of points that are given at time t and move with the collider from then
/// on [s]. On a collider that deforms they follow the point of its surface that is nearest at time
/// t.
std::vector<Vec3> carried(const Collider&, double t, double h, const std::vector<Vec3>&);

/// Distance from p to the surface, negative inside, and its gradient. Both are exact, also inside a
/// box and past its edges and corners. Where the gradient is not unique (a ball's centre, a
/// capsule's axis, the medial axis of a box or a body), it is one of the valid ones, always the
/// same. A thin body has no inside: its gradient points away from it.
struct Surface {
  double distance = 0;  ///< m
  Vec3 normal = Vec3::UnitY();
};
Surface surface(const Shape&, const Vec3& p);

}  // namespace taut
