#include "core/reference/contact_residual.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/model/collider.hpp"
#include "core/model/index.hpp"

namespace taut::reference {

ContactResidual contact_residual(const Scene& scene, const State& from, double t,
                                 const Stiffness& stiffness, const std::vector<Vec3>& x) {
  constexpr double kNoGap = 1e-7;  // m
  const double h = scene.dt;
  std::vector<Vec3> force(x.size(), Vec3::Zero());  // N, by links
  for (const Link& link : scene.links) {
    const std::size_t a = to_index(link.a), b = to_index(link.b);
    const Vec3 d = x[b] - x[a];
    const double k = stiffness[static_cast<std::size_t>(link.family)];
    const Vec3 pull = k * (1 - link.rest / d.norm()) * d;
    force[a] += pull;
    force[b] -= pull;
  }
  const std::vector<double> w = inverse_masses(scene);
  const Collider& collider = scene.colliders.front();
  const Shape shape = shape_at(collider, t + h);
  const std::vector<Vec3> carried_along = carried(collider, t, h, from.x);
  ContactResidual out;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (w[i] == 0) continue;
    const Vec3 y = from.x[i] + h * std::exp(-scene.damping * h) * from.v[i] + h * h * scene.gravity;
    const Vec3 r = x[i] - y - h * h * w[i] * force[i];
    const Surface at = surface(shape, x[i]);
    const auto across = [&](const Vec3& v) { return Vec3(v - at.normal.dot(v) * at.normal); };
    const double gap = at.distance - scene.thickness, push = at.normal.dot(r);
    const Vec3 wanted = across(r) - across(x[i] - carried_along[i]);
    const double most = collider.friction * std::max(0.0, push), length = wanted.norm();
    const Vec3 rub = length > most ? Vec3(most / length * wanted) : wanted;
    const double worst =
        std::max(std::abs(push - std::max(0.0, push - gap)), (across(r) - rub).norm());
    if (!(worst <= out.most)) out.most = worst;  // also if it is NaN
    out.touching += gap < kNoGap;
  }
  return out;
}

}  // namespace taut::reference
