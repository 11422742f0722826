#pragma once

#include "core/solver/contact/exit.hpp"
#include "core/solver/contact/place.hpp"
#include "core/solver/pass.hpp"

namespace taut {

/// Keeps the faces, not just their corners, out of a ball, and box edges and corners out of the
/// faces. Of each face that is too deep, the deepest point is moved out along the surface's normal;
/// its corners share the correction by their barycentric weights b and inverse masses w,
///
///     dx_i = w_i b_i s n / sum of w_j b_j^2,
///
/// so that the point moves by s n and momentum changes along n alone.
template <class Real>
class FaceContactPass final : public Pass<Real> {
 public:
  /// The collider is a ball or a box.
  FaceContactPass(const Collider& collider, double thickness, std::vector<Triangle> faces)
      : collider_(collider), thickness_(thickness), faces_(std::move(faces)) {}

  void begin(Particles<Real>&, double t, double dt) override {
    shape_ = shape_at(collider_, t + dt);
    carry_ = carry_of(collider_.motion, t, dt);
    if (Ball* ball = std::get_if<Ball>(&shape_)) {
      ball->radius += thickness_;
      center_ = ball->center, reach_ = ball->radius;
    }
    if (Box* box = std::get_if<Box>(&shape_)) {
      box->half_extents.array() += thickness_;
      center_ = box->center, reach_ = box->half_extents.norm();
    }
  }

  void apply(Particles<Real>& p, double, double) override {
    for (const Triangle& face : faces_) {
      const Corners t{at(p.x, face[0]), at(p.x, face[1]), at(p.x, face[2])};
      const double side2 = std::max((t[1] - t[0]).squaredNorm(), (t[2] - t[0]).squaredNorm());
      // every point of the face is within a side of its first corner
      if ((t[0] - center_).squaredNorm() >= 2 * (reach_ * reach_ + side2)) continue;
      const Exit exit = way_out(shape_, t);
      if (exit.length > 0) push(p, face, exit);
    }
  }

  std::vector<PassCost> cost() const override {
    return {{.pass = "faces on " + std::string(type_name(collider_.shape)),
             .items = faces_.size(),
             .bytes = sizeof(*this) + faces_.size() * sizeof(Triangle)}};
  }

 private:
  void push(Particles<Real>& p, const Triangle& face, const Exit& exit) const {
    double sum = 0;
    Vec3 previous = Vec3::Zero();
    for (std::size_t c = 0; c < 3; ++c) {
      const double b = exit.point.weights[static_cast<Eigen::Index>(c)];
      sum += static_cast<double>(p.w[index(face[c])]) * b * b;
      previous += b * at(p.previous, face[c]);
    }
    if (sum == 0) return;  // all that could move it are pins
    Vec3 correction = exit.length * exit.normal;
    if (collider_.friction > 0) {
      Vec3 slip = exit.point.position + correction - point(carry_(triple<double>(previous)));
      slip -= exit.normal.dot(slip) * exit.normal;
      const double length = slip.norm(), most = collider_.friction * exit.length;
      correction -= length <= most ? slip : Vec3(most / length * slip);
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t i = index(face[c]);
      const double share =
          static_cast<double>(p.w[i]) * exit.point.weights[static_cast<Eigen::Index>(c)] / sum;
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
  Carry<double> carry_;
};

}  // namespace taut
