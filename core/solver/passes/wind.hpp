#pragma once

#include <vector>

#include "core/solver/pass.hpp"

namespace taut {

/// The report's wind on every face, F = c (n . d) n (section 3): n the unit normal, scaled by the
/// face's area, a third to each corner; d is the wind past the face, or, in the literal law, the
/// wind itself.
template <class Real>
class WindPass final : public Pass<Real> {
 public:
  WindPass(const Wind& wind, std::vector<Triangle> faces)
      : velocity_(wind.velocity),
        strength_(wind.strength),
        relative_(wind.law == Wind::Law::relative),
        faces_(std::move(faces)) {}

  void apply(Particles<Real>& p, double, double dt) override {
    const auto at = [](const Vec4<Real>& x) { return Vec3(x.x, x.y, x.z); };
    for (const auto& [a, b, c] : faces_) {
      const auto ia = static_cast<std::size_t>(a), ib = static_cast<std::size_t>(b),
                 ic = static_cast<std::size_t>(c);
      const Vec3 xa = at(p.x[ia]), xb = at(p.x[ib]), xc = at(p.x[ic]);
      const Vec3 twice_area = (xb - xa).cross(xc - xa);
      const double norm = twice_area.norm();
      if (norm == 0) continue;
      Vec3 d = velocity_;
      if (relative_)
        d -= (xa - at(p.previous[ia]) + xb - at(p.previous[ib]) + xc - at(p.previous[ic])) /
             (3 * dt);
      const Vec3 corner = strength_ * twice_area.dot(d) / (6 * norm) * twice_area;
      for (const std::size_t i : {ia, ib, ic}) {
        const double w = p.x[i].w;
        p.a[i].x += static_cast<Real>(w * corner.x());
        p.a[i].y += static_cast<Real>(w * corner.y());
        p.a[i].z += static_cast<Real>(w * corner.z());
      }
    }
  }

  PassCost cost() const override {
    return {.pass = "wind", .items = faces_.size(), .bytes = faces_.size() * sizeof(Triangle)};
  }

 private:
  Vec3 velocity_;
  double strength_;
  bool relative_;
  std::vector<Triangle> faces_;
};

}  // namespace taut
