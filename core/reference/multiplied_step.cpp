#include "core/reference/multiplied_step.hpp"

#include <utility>

namespace taut::reference {

ImplicitStep::Multiplied::Multiplied(const ImplicitStep& s, double rigid)
    : step(s), multiplier(s.links_.size(), 0) {
  harden(rigid);
  touches.resize(s.inertia_.size() * s.colliders_.size());
  for (const double m : s.inertia_) hardness = std::max(hardness, kHardness * m);
  for (const double k : stiffness) hardness = std::max(hardness, 10 * k);
  std::vector<double> of_membrane(s.inertia_.size(), 0.0);
  s.membrane_.add_stiffness(of_membrane);
  for (const double k : of_membrane) hardness = std::max(hardness, 10 * k);
  for (const double m : s.inertia_) column.push_back(m > 0 ? std::exchange(size, size + 3) : -1);
}

void ImplicitStep::Multiplied::harden(double rigid) {
  stiffness.clear();
  for (const Member& l : step.links_)
    stiffness.push_back(std::isinf(l.stiffness) ? rigid : l.stiffness);
}

double ImplicitStep::Multiplied::energy(const Points& x) const {
  double sum = step.membrane_.energy(x);
  for (std::size_t i = 0; i < x.size(); ++i)
    sum += step.inertia_[i] / 2 * (x[i] - step.y_[i]).squaredNorm();
  for (std::size_t j = 0; j < stiffness.size(); ++j) {
    const double c = stretch(x, j);
    sum += (multiplier[j] + stiffness[j] / 2 * c) * c;
  }
  each_held(x, [&](std::size_t, std::size_t, const Held& now) { sum += now.energy; });
  return sum;
}

Eigen::VectorXd ImplicitStep::Multiplied::gradient(const Points& x) const {
  Eigen::VectorXd g(size);
  for (std::size_t i = 0; i < x.size(); ++i)
    if (column[i] >= 0) g.segment<3>(column[i]) = step.inertia_[i] * (x[i] - step.y_[i]);
  for (std::size_t j = 0; j < stiffness.size(); ++j) {
    const auto& [a, b, rest, k] = step.links_[j];
    const Vec3 pull = (multiplier[j] + stiffness[j] * stretch(x, j)) * (x[b] - x[a]).normalized();
    if (column[a] >= 0) g.segment<3>(column[a]) -= pull;
    if (column[b] >= 0) g.segment<3>(column[b]) += pull;
  }
  for (const MembraneElement& e : step.membrane_.elements)
    step.membrane_.add_forces(
        e, [&](std::size_t v) { return x[v]; },
        [&](std::size_t v, const Vec3& force) {
          if (column[v] >= 0) g.segment<3>(column[v]) -= force;
        });
  each_held(x, [&](std::size_t i, std::size_t, const Held& now) {
    g.segment<3>(column[i]) -= now.force;
  });
  return g;
}

Vec3 ImplicitStep::Multiplied::contact_force(const Points& x) const {
  Vec3 sum = Vec3::Zero();
  each_held(x, [&](std::size_t, std::size_t, const Held& now) { sum += now.force; });
  return sum;
}

void ImplicitStep::Multiplied::lay_planes(const Points& x) {
  planes.clear();
  for (const Vec3& at : x)
    for (const Obstacle& obstacle : step.colliders_) {
      const Surface s = surface(obstacle.shape, at);
      planes.push_back({s.normal, s.normal.dot(at) - s.distance + step.thickness_});
    }
}

double ImplicitStep::Multiplied::update_contact(const Points& x) {
  double left = 0;
  std::vector<Vec3> on_old_planes;
  each_held(x,
            [&](std::size_t, std::size_t, const Held& now) { on_old_planes.push_back(now.force); });
  lay_planes(x);
  auto old = on_old_planes.begin();
  each_held(x, [&](std::size_t i, std::size_t k, const Held& now) {
    left = std::max(left, (now.force - *old++).norm() / hardness);
    Touch& touch = touches[i * step.colliders_.size() + k];
    const double bound = step.colliders_[k].friction * now.push;
    if (now.push > 0) left = std::max({left, std::abs(now.gap), now.slip});
    left = std::max(left, std::abs(bound - touch.bound) / hardness);
    touch = {now.push, bound, now.rub};
  });
  return left;
}

}  // namespace taut::reference
