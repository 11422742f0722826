#pragma once

#include <vector>

#include "core/model/wind.hpp"
#include "core/solver/pass.hpp"

namespace taut {

/// The report's wind on every face (core/model/wind.hpp).
template <class Real>
class WindPass final : public Pass<Real> {
 public:
  WindPass(const Wind& wind, std::vector<Triangle> faces) : wind_(wind), faces_(std::move(faces)) {}

  void apply(Particles<Real>& p, double, double dt) override {
    for (const auto& [a, b, c] : faces_) {
      const auto ia = static_cast<std::size_t>(a), ib = static_cast<std::size_t>(b),
                 ic = static_cast<std::size_t>(c);
      const Vec3 xa = at(p.x, ia), xb = at(p.x, ib), xc = at(p.x, ic);
      const Vec3 moved =
          xa - at(p.previous, ia) + xb - at(p.previous, ib) + xc - at(p.previous, ic);
      const Vec3 corner = wind_on_corner(wind_, xa, xb, xc, moved / (3 * dt));
      for (const std::size_t i : {ia, ib, ic})
        p.a.add(i, (static_cast<double>(p.w[i]) * corner).template cast<Real>());
    }
  }

  std::vector<PassCost> cost() const override {
    return {{.pass = "wind", .items = faces_.size(), .bytes = faces_.size() * sizeof(Triangle)}};
  }

 private:
  static Vec3 at(const Points<Real>& points, std::size_t i) {
    return points[i].template cast<double>();
  }
  Wind wind_;
  std::vector<Triangle> faces_;
};

}  // namespace taut
