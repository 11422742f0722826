#pragma once

#include "core/solver/passes/links.hpp"

namespace taut {

/// What a particle makes of the corrections that all its links ask for at the same time.
enum class Jacobi {
  plain,     ///< their sum: diverges where many links meet (truths: 2.4 per step on a chain)
  averaged,  ///< their mean: stable, does not conserve momentum
  under      ///< their sum / the largest number of links at any particle: stable (Gershgorin bounds
             ///< the sweep's eigenvalues by it), conserves momentum, slow
};

/// One Jacobi sweep: every link sees the particles as they were when the sweep began.
template <class Real, Projection kind>
class JacobiPass final : public Pass<Real> {
 public:
  JacobiPass(Jacobi method, std::vector<Stick<Real>> sticks, std::vector<PassCost> costs,
             std::size_t particles)
      : sticks_(std::move(sticks)),
        costs_(std::move(costs)),
        correction_(std::make_shared<const Layout>(Layout::packed(particles))),
        factor_(particles, Real(1)) {
    std::vector<int> links(particles);
    for (const Stick<Real>& s : sticks_)
      ++links[static_cast<std::size_t>(s.a)], ++links[static_cast<std::size_t>(s.b)];
    const int most = links.empty() ? 0 : *std::max_element(links.begin(), links.end());
    for (std::size_t i = 0; i < links.size(); ++i)
      if (method != Jacobi::plain && links[i] > 0)
        factor_[i] = Real(1) / static_cast<Real>(method == Jacobi::averaged ? links[i] : most);
    if (!costs_.empty())
      costs_.front().bytes += correction_.bytes() + factor_.size() * sizeof(Real);
  }

  void apply(Particles<Real>& p, double, double) override {
    using Point = typename Points<Real>::Point;
    for (const Stick<Real>& stick : sticks_) {
      const auto a = static_cast<std::size_t>(stick.a), b = static_cast<std::size_t>(stick.b);
      const Point from1 = p.x[a], from2 = p.x[b];
      Triple<Real> x1{from1.x(), from1.y(), from1.z()}, x2{from2.x(), from2.y(), from2.z()};
      project_distance<kind>(x1, x2, stick.rest, stick.share_a, stick.share_b);
      correction_.add(a, Point(x1.x, x1.y, x1.z) - from1);
      correction_.add(b, Point(x2.x, x2.y, x2.z) - from2);
    }
    for (std::size_t i = 0; i < p.size(); ++i) {
      p.x.add(i, factor_[i] * correction_[i]);
      correction_.set(i, Point::Zero());
    }
  }

  std::vector<PassCost> cost() const override { return costs_; }

 private:
  std::vector<Stick<Real>> sticks_;
  std::vector<PassCost> costs_;
  Points<Real> correction_;
  std::vector<Real> factor_;
};

}  // namespace taut
