#include "experiments/metrics/observables.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

Observables& Observables::operator+=(const Observables& other) {
  centre += other.centre;
  lengths += other.lengths;
  in_contact += other.in_contact;
  return *this;
}

Observables Observables::operator*(double factor) const {
  return {factor * centre, factor * lengths, factor * in_contact};
}

Observables observables(const Scene& scene, const std::vector<Vec3>& x, double t) {
  Observables all;
  double mass = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    all.centre += scene.mesh.mass[i] * x[i];
    mass += scene.mesh.mass[i];
  }
  all.centre /= mass;
  Vec3 square = Vec3::Zero();
  for (std::size_t i = 0; i < x.size(); ++i)
    square += scene.mesh.mass[i] * (x[i] - all.centre).cwiseAbs2() / mass;
  all.lengths = square.cwiseSqrt();
  std::vector<Shape> shapes;
  for (const Collider& body : scene.colliders) shapes.push_back(shape_at(body, t));
  const double reach = scene.thickness + Observables::kTouch * extent(scene);
  const auto touches = [&](const Vec3& p) {
    return std::ranges::any_of(
        shapes, [&](const Shape& shape) { return surface(shape, p).distance <= reach; });
  };
  all.in_contact =
      static_cast<double>(std::ranges::count_if(x, touches)) / static_cast<double>(x.size());
  return all;
}

double apart(const Observables& a, const Observables& b, double fall) {
  return std::max({(a.centre - b.centre).norm() / fall,
                   (a.lengths - b.lengths).cwiseAbs().maxCoeff() / fall,
                   std::abs(a.in_contact - b.in_contact)});
}

}  // namespace taut
