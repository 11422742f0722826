#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "core/model/params.hpp"
#include "core/solver/layout/particles.hpp"
#include "core/solver/thread_pool.hpp"

namespace taut {

inline constexpr ParamSpec kChebyshev =
    ParamSpec::real("chebyshev", "", "0", 0, 0.99999,
                    "rho of Chebyshev's semi-iteration, the error's factor per iteration; 0: none");

/// Over-relaxation of a pass f whose error shrinks by a factor rho per iteration (Wang: A Chebyshev
/// Semi-Iterative Approach for Accelerating Projective and Position-Based Dynamics, SIGGRAPH Asia
/// 2015, equation 9):
///
///     x_k+1 = omega_k (f(x_k) - x_k-1) + x_k-1,
///     omega_k = 2/(2 - rho^2), then 4/(4 - rho^2 omega_k-1), from the third iteration of a substep
///
/// If the eigenvalues of f are real and rho is the largest, the error shrinks by
/// rho/(1 + sqrt(1 - rho^2)) per iteration.
template <class Real>
class ChebyshevPass final : public Pass<Real> {
 public:
  ChebyshevPass(std::unique_ptr<Pass<Real>> pass, double rho, std::size_t particles,
                ThreadPool& pool)
      : pass_(std::move(pass)), rho_(rho), pool_(pool), from_(particles), before_(particles) {}

  void restart() override { pass_->restart(); }
  void take_over(const Pass<Real>& before) override {
    pass_->take_over(*static_cast<const ChebyshevPass&>(before).pass_);
  }
  void accelerate(Particles<Real>& p, double t, double h) override { pass_->accelerate(p, t, h); }
  void begin(Particles<Real>& p, double t, double h) override {
    iteration_ = 0;
    pass_->begin(p, t, h);
  }
  void apply(Particles<Real>& p, double t, double h) override {
    for (std::size_t i = 0; i < p.size(); ++i) from_[i] = p.x[i];
    pass_->apply(p, t, h);
    pool_.finish();
    ++iteration_;
    omega_ = iteration_ < kDelay    ? 1
             : iteration_ == kDelay ? 2 / (2 - rho_ * rho_)
                                    : 4 / (4 - rho_ * rho_ * omega_);
    for (std::size_t i = 0; iteration_ >= kDelay && i < p.size(); ++i)
      if (p.w[i] > 0) p.x.set(i, static_cast<Real>(omega_) * (p.x[i] - before_[i]) + before_[i]);
    std::swap(from_, before_);
  }
  void end(Particles<Real>& p, double t, double h) override { pass_->end(p, t, h); }
  Points<Real>* target() override { return pass_->target(); }

  std::vector<PassCost> cost() const override {
    std::vector<PassCost> costs = pass_->cost();
    costs.push_back({.pass = "Chebyshev",
                     .items = before_.size(),
                     .bytes = 2 * before_.size() * sizeof(typename Points<Real>::Point)});
    return costs;
  }

 private:
  static constexpr int kDelay = 3;
  std::unique_ptr<Pass<Real>> pass_;
  double rho_, omega_ = 1;
  ThreadPool& pool_;
  int iteration_ = 0;
  std::vector<typename Points<Real>::Point> from_, before_;  ///< m, x_k and x_k-1
};

/// Wraps the pass in ChebyshevPass, or returns it unchanged if rho is 0. Precondition: rho in
/// [0, 1).
template <class Real>
std::unique_ptr<Pass<Real>> with_chebyshev(std::unique_ptr<Pass<Real>> pass, double rho,
                                           std::size_t particles, ThreadPool& pool) {
  if (!pass || rho == 0) return pass;
  return std::make_unique<ChebyshevPass<Real>>(std::move(pass), rho, particles, pool);
}

}  // namespace taut
