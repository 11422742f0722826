#include "core/solver/newton/integrator.hpp"

#include "core/solver/global_system.hpp"

namespace taut::solver::implicit {

Integrator::Integrator(const Params& params, const Vec3& gravity)
    : kind_(params.is("integrator", "bdf2")       ? Kind::bdf2
            : params.is("integrator", "midpoint") ? Kind::midpoint
                                                  : Kind::euler),
      gravity_(gravity) {}

double Integrator::own_step(double h) const {
  if (kind_ == Kind::midpoint) return h / 2;
  return kind_ == Kind::bdf2 && !before_.empty() ? 2 * h / 3 : h;
}

void Integrator::predict(Particles<double>& p, Points<double>& y, double h) {
  if (kind_ == Kind::euler) return;
  const double own = own_step(h);
  start_.resize(p.size());
  v_start_.resize(p.size());
  pins_at_end_ = positions(p);
  for (std::size_t i = 0; i < p.size(); ++i) {
    start_[i] = p.previous[i];
    v_start_[i] = (y[i] - start_[i] - h * h * gravity_) / h;
    if (p.w[i] == 0) {
      if (kind_ != Kind::midpoint) continue;
      p.x.set(i, (start_[i] + y[i]) / 2);
      y.set(i, p.x[i]);
    } else if (kind_ == Kind::midpoint) {
      y.set(i, start_[i] + own * v_start_[i] + own * own * gravity_);
    } else if (!before_.empty()) {
      y.set(i, (4 * start_[i] - before_[i]) / 3 + own * (4 * v_start_[i] - v_before_[i]) / 3 +
                   own * own * gravity_);
    }
  }
}

void Integrator::finish(Particles<double>& p, double h) {
  if (kind_ == Kind::euler) return;
  const double own = own_step(h);
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (p.w[i] == 0) {
      p.x.set(i, pins_at_end_[i]);
      continue;
    }
    Vec3 x = p.x[i], v;
    if (kind_ == Kind::midpoint) {
      v = 2 * (x - start_[i]) / own - v_start_[i];
      x = 2 * x - start_[i];
    } else if (before_.empty()) {
      v = (x - start_[i]) / h;
    } else {
      v = (x - (4 * start_[i] - before_[i]) / 3) / own;
    }
    p.x.set(i, x);
    p.previous.set(i, x - h * v);
  }
  if (kind_ != Kind::bdf2) return;
  before_ = start_;
  v_before_ = v_start_;
}

}  // namespace taut::solver::implicit
