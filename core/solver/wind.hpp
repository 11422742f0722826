#pragma once

#include <vector>

#include "core/model/scene.hpp"
#include "core/model/wind.hpp"
#include "core/solver/layout/particles.hpp"

namespace taut {

template <class Real>
using Vec3Of = Eigen::Matrix<Real, 3, 1>;

/// a[i] += w[i] times the wind's force on vertex i; nothing if the scene has no wind.
/// x [n] m, v [n] m/s, w [n] 1/kg, a [n] m/s^2.
template <class Real>
void add_wind(const Scene& scene, const std::vector<Vec3Of<Real>>& x,
              const std::vector<Vec3Of<Real>>& v, const std::vector<Real>& w,
              std::vector<Vec3Of<Real>>& a) {
  if (!scene.wind) return;
  for (const Triangle& face : scene.mesh.triangles) {
    Vec3 corners[3], velocity = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(face[static_cast<std::size_t>(k)]);
      corners[k] = x[i].template cast<double>();
      velocity += v[i].template cast<double>() / 3;
    }
    const Vec3Of<Real> force =
        wind_on_corner(*scene.wind, corners[0], corners[1], corners[2], velocity)
            .template cast<Real>();
    for (const int k : face)
      a[static_cast<std::size_t>(k)] += w[static_cast<std::size_t>(k)] * force;
  }
}

/// The wind on every face (core/model/wind.hpp), as a pass of `jakobsen`.
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
