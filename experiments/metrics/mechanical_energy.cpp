#include "experiments/metrics/mechanical_energy.hpp"

#include <cmath>
#include <numeric>

#include "core/model/index.hpp"

namespace taut {

MechanicalEnergy::MechanicalEnergy(const Scene& scene)
    : mass_(scene.mesh.mass),
      start_(scene.start.x),
      gravity_(scene.gravity),
      bending_(make_bending(scene)),
      membrane_(make_membrane(scene)) {
  for (const Link& link : scene.links) {
    const double stiffness = scene.stiffness[static_cast<std::size_t>(link.family)];
    if (std::isfinite(stiffness)) springs_.push_back({link, stiffness});
  }
  unit_ = std::accumulate(mass_.begin(), mass_.end(), 0.0) * gravity_.norm() * extent(scene);
  at_start_ = stored(start_);
}

double MechanicalEnergy::kinetic(const State& state) const {
  double sum = 0;
  for (std::size_t i = 0; i < state.v.size(); ++i) sum += mass_[i] * state.v[i].squaredNorm() / 2;
  return sum;
}

double MechanicalEnergy::potential(const State& state) const {
  double sum = stored(state.x) - at_start_;
  for (std::size_t i = 0; i < state.x.size(); ++i)
    sum -= mass_[i] * gravity_.dot(state.x[i] - start_[i]);
  return sum;
}

double MechanicalEnergy::stored(const std::vector<Vec3>& x) const {
  double sum = bending_energy(bending_, x) + membrane_.energy(x);
  for (const auto& [link, stiffness] : springs_) {
    const double longer = (x[to_index(link.a)] - x[to_index(link.b)]).norm() - link.rest;
    sum += stiffness / 2 * longer * longer;
  }
  return sum;
}

}  // namespace taut
