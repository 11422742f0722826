#include "core/solver/newton/kept_tensions.hpp"

namespace taut::solver::implicit {

void KeptTensions::take_over(const KeptTensions& before) {
  std::size_t j = 0;
  for (std::size_t k = 0; k < before.tension_.size(); ++k) {
    const Spring& one = before.springs_[k];
    while (springs_[j].a != one.a || springs_[j].b != one.b) ++j;
    tension_[j] = before.tension_[k];
  }
}

void KeptTensions::put_into(Hessian& hessian, const std::vector<Vec3>& x) {
  excess_.assign(springs_.size(), 0);
  for (std::size_t j = 0; j < springs_.size(); ++j) {
    const auto& [a, b, rest, stiffness] = springs_[j];
    const Vec3 d = x[b] - x[a];
    const double length = d.norm();
    if (length == 0) continue;
    excess_[j] = length - rest;
    const double across = std::max(0.0, tension_[j]) / length;
    hessian.block(j) = {across, stiffness - across, d / length};
  }
}

void KeptTensions::follow(const Vector& direction, Hessian& hessian) {
  const auto way = [&](std::size_t v) -> Vec3 {
    const int c = hessian.column(v);
    return c < 0 ? Vec3(Vec3::Zero()) : Vec3(direction.segment<3>(c));
  };
  for (std::size_t j = 0; j < springs_.size(); ++j) {
    const Spring& s = springs_[j];
    tension_[j] = s.stiffness * (excess_[j] + hessian.block(j).u.dot(way(s.b) - way(s.a)));
  }
}

}  // namespace taut::solver::implicit
