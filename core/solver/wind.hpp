#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/model/scene.hpp"
#include "core/model/wind.hpp"
#include "core/solver/layout/particles.hpp"
#include "core/solver/simd/kernels.hpp"
#include "core/solver/thread_pool.hpp"

namespace taut {

template <class Real>
using Vec3Of = Eigen::Matrix<Real, 3, 1>;

/// Adds w[i] times the wind's force on vertex i to a[i]; does nothing if the scene has no wind. x
/// [n] m, v [n] m/s, w [n] 1/kg, a [n] m/s^2.
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

/// The wind on every face (core/model/wind.hpp) as a pass of the loop, in the precision of the
/// particles. w: inverse masses [1/kg].
template <class Real>
std::unique_ptr<Pass<Real>> make_wind(const Scene&, std::span<const double> w, const Layout&, Simd,
                                      ThreadPool&);

}  // namespace taut
