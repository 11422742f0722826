#include "core/solver/bending.hpp"

namespace taut {

namespace {

template <class Real>
class BendingPass final : public Pass<Real> {
 public:
  using V = typename Points<Real>::Point;
  BendingPass(const Scene& scene, std::span<const double> w) : elements_(make_bending(scene)) {
    for (const BendingElement& e : elements_) {
      double mobility = 0;  // sum w c^2
      for (std::size_t i = 0; i < e.size; ++i)
        mobility += w[to_index(e.vertex[i])] * e.weight[i] * e.weight[i];
      mobility_.push_back(mobility);
    }
    lambda_.resize(elements_.size());
  }

  void begin(Particles<Real>&, double, double) override {
    std::ranges::fill(lambda_, V(V::Zero()));
  }

  void apply(Particles<Real>& p, double, double h) override {
    for (std::size_t k = 0; k < elements_.size(); ++k) {
      const BendingElement& e = elements_[k];
      const double softness = 1 / (e.stiffness * h * h);
      const V g = e.value([&](std::size_t v) { return p.x[v]; });
      const V change = (-g - static_cast<Real>(softness) * lambda_[k]) /
                       static_cast<Real>(mobility_[k] + softness);
      lambda_[k] += change;
      for (std::size_t i = 0; i < e.size; ++i)
        if (const std::size_t v = to_index(e.vertex[i]); p.w[v] > 0)
          p.x.add(v, p.w[v] * static_cast<Real>(e.weight[i]) * change);
    }
  }

  std::vector<PassCost> cost() const override {
    return {{.pass = "bending",
             .items = elements_.size(),
             .bytes = elements_.size() * (sizeof(BendingElement) + sizeof(double) + sizeof(V))}};
  }

 private:
  std::vector<BendingElement> elements_;
  std::vector<double> mobility_;  ///< 1/(kg m^4)
  std::vector<V> lambda_;         ///< kg m^3
};

}  // namespace

template <class Real>
std::unique_ptr<Pass<Real>> make_bending_pass(const Scene& scene, std::span<const double> w) {
  return std::make_unique<BendingPass<Real>>(scene, w);
}
template std::unique_ptr<Pass<float>> make_bending_pass(const Scene&, std::span<const double>);
template std::unique_ptr<Pass<double>> make_bending_pass(const Scene&, std::span<const double>);

}  // namespace taut
