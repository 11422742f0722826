#pragma once

#include "core/model/triangle.hpp"
#include "core/solver/contact/projector.hpp"
#include "core/solver/layout/particles.hpp"

namespace taut {

/// Keeps the faces, not just their corners, out of a ball or a capsule, and box edges and corners
/// out of the faces. Of each face that is too deep, the deepest point is moved out along the
/// surface's normal; its corners share the correction by their barycentric weights b and inverse
/// masses w,
///
///     dx_i = w_i b_i s n / sum of w_j b_j^2,
///
/// so that the point moves by s n and momentum changes along n alone.
template <class Real>
class FaceContactPass final : public Pass<Real> {
 public:
  /// The collider is no plane.
  FaceContactPass(const Collider& collider, double thickness, std::vector<Triangle> faces)
      : collider_(collider), thickness_(thickness), faces_(std::move(faces)) {}

  void begin(Particles<Real>&, double t, double dt) override {
    shape_ = shape_at(collider_, t + dt);
    motion_ = rigid_motion(collider_.motion, t, dt);
    if (Ball* ball = std::get_if<Ball>(&shape_)) {
      ball->radius += thickness_;
      center_ = ball->center, reach_ = ball->radius;
    }
    if (Box* box = std::get_if<Box>(&shape_)) {
      box->half_extents.array() += thickness_;
      center_ = box->center, reach_ = box->half_extents.norm();
    }
    if (Capsule* capsule = std::get_if<Capsule>(&shape_)) {
      capsule->radius += thickness_;
      center_ = capsule->middle();
      reach_ = (capsule->to - capsule->from).norm() / 2 + capsule->radius;
    }
  }

  void apply(Particles<Real>& p, double, double) override {
    for (const Triangle& face : faces_) {
      const Corners t{at(p.x, face[0]), at(p.x, face[1]), at(p.x, face[2])};
      const double side2 = std::max((t[1] - t[0]).squaredNorm(), (t[2] - t[0]).squaredNorm());
      // every point of the face is within a side of its first corner
      if ((t[0] - center_).squaredNorm() >= 2 * (reach_ * reach_ + side2)) continue;
      const Separation out = separation_of(shape_, t);
      if (out.length > 0) push(p, face, out);
    }
  }

  std::vector<PassCost> cost() const override {
    return {{.pass = "faces on " + std::string(type_name(collider_.shape)),
             .items = faces_.size(),
             .bytes = sizeof(*this) + faces_.size() * sizeof(Triangle)}};
  }

 private:
  /// How the deepest point of a face leaves a solid.
  struct Separation {
    double length = 0;           ///< m; <= 0: it is outside
    Vec3 normal = Vec3::Zero();  ///< unit
    TrianglePoint point;
  };

  /// A point that is equally deep below several sides leaves between them, over their common edge
  /// or corner: along n = sum of their normals, by depth / (n . one of them).
  static Separation over_edge(const Box& box, const Deepest& deepest) {
    const Vec3 local = box.rotation.conjugate() * (deepest.at.position - box.center);
    const Vec3 depths = box.half_extents - local.cwiseAbs();
    Vec3 out = Vec3::Zero();
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      if (depths[axis] <= deepest.depth * (1 + 1e-6)) out[axis] = local[axis] < 0 ? -1 : 1;
    const double sides = out.norm();  // sqrt(how many)
    if (sides == 0) return {};
    return {deepest.depth * sides, box.rotation * out / sides, deepest.at};
  }

  /// Precondition: no plane.
  static Separation separation_of(const Shape& shape, const Corners& t) {
    if (const Ball* ball = std::get_if<Ball>(&shape)) return out_of(*ball, t);
    if (const Capsule* capsule = std::get_if<Capsule>(&shape)) return out_of(*capsule, t);
    const Box& box = std::get<Box>(shape);
    const Deepest deepest = deepest_in(box, t);
    if (deepest.depth <= 0) return {};
    return over_edge(box, deepest);
  }

  template <class Round>
  static Separation out_of(const Round& shape, const Corners& t) {
    const Deepest deepest = deepest_in(shape, t);
    if (deepest.depth <= 0) return {};
    return {deepest.depth, surface(shape, deepest.at.position).normal, deepest.at};
  }

  void push(Particles<Real>& p, const Triangle& face, const Separation& out) const {
    double sum = 0;
    Vec3 previous = Vec3::Zero();
    for (std::size_t c = 0; c < 3; ++c) {
      const double b = out.point.weights[static_cast<Eigen::Index>(c)];
      sum += static_cast<double>(p.w[index(face[c])]) * b * b;
      previous += b * at(p.previous, face[c]);
    }
    if (sum == 0) return;  // all that could move it are pins
    Vec3 correction = out.length * out.normal;
    if (collider_.friction > 0) {
      Vec3 slip = out.point.position + correction - point(motion_(vec3t<double>(previous)));
      slip -= out.normal.dot(slip) * out.normal;
      const double length = slip.norm(), most = collider_.friction * out.length;
      correction -= length <= most ? slip : Vec3(most / length * slip);
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t i = index(face[c]);
      const double share =
          static_cast<double>(p.w[i]) * out.point.weights[static_cast<Eigen::Index>(c)] / sum;
      p.x.add(i, (share * correction).template cast<Real>());
    }
  }

  static std::size_t index(int vertex) { return static_cast<std::size_t>(vertex); }
  static Vec3 at(const Points<Real>& points, int vertex) {
    return points[index(vertex)].template cast<double>();
  }

  Collider collider_;
  double thickness_;
  std::vector<Triangle> faces_;
  Shape shape_;  ///< at the end of the step, grown by the thickness
  Vec3 center_ = Vec3::Zero();
  double reach_ = 0;  ///< m, from its centre to its farthest point
  RigidMotion<double> motion_;
};

}  // namespace taut
