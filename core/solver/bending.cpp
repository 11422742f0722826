#include "core/solver/bending.hpp"

namespace taut {

namespace {

/// A bending element as the pass reads it, in the precision of the particles.
template <class Real>
struct Projected {
  std::uint32_t size, vertex[6];
  Real weight[6];  ///< c_i [1/m^2]
  Real move[6];    ///< w_i c_i [1/(kg m^2)]; 0: pinned
  Real softness;   ///< a [1/(kg m^4)]
  Real inverse;    ///< 1/(sum w_i c_i^2 + a) [kg m^4]
};

template <class Real>
class BendingPass final : public Pass<Real> {
 public:
  using V = typename Points<Real>::Point;
  BendingPass(const Scene& scene, std::span<const double> w)
      : elements_(make_bending(scene)), w_(w.begin(), w.end()), lambda_(elements_.size()) {}

  void begin(Particles<Real>&, double, double h) override {
    if (h != prepared_for_) prepare(h);
    std::ranges::fill(lambda_, V(V::Zero()));
  }

  void apply(Particles<Real>& p, double, double) override {
    for (std::size_t k = 0; k < projected_.size(); ++k) {
      const Projected<Real>& e = projected_[k];
      const V first = p.x[e.vertex[0]];  // differences of nearby positions are exact in float
      V g = e.weight[1] * (p.x[e.vertex[1]] - first);
      for (std::uint32_t i = 2; i < e.size; ++i) g += e.weight[i] * (p.x[e.vertex[i]] - first);
      const V change = e.inverse * (-g - e.softness * lambda_[k]);
      lambda_[k] += change;
      for (std::uint32_t i = 0; i < e.size; ++i)
        if (e.move[i] != 0) p.x.add(e.vertex[i], e.move[i] * change);
    }
  }

  std::vector<PassCost> cost() const override {
    return {{.pass = "bending",
             .items = elements_.size(),
             .bytes =
                 elements_.size() * (sizeof(BendingElement) + sizeof(Projected<Real>) + sizeof(V)) +
                 w_.size() * sizeof(double)}};
  }

 private:
  /// Computes the constants of all elements for substeps of h [s].
  void prepare(double h) {
    projected_.clear();
    for (const BendingElement& e : elements_) {
      Projected<Real>& p = projected_.emplace_back();
      const double softness = 1 / (e.stiffness * h * h);
      double mobility = 0;  // sum w c^2
      p.size = static_cast<std::uint32_t>(e.size);
      for (std::size_t i = 0; i < e.size; ++i) {
        const double w = w_[to_index(e.vertex[i])], c = e.weight[i];
        mobility += w * c * c;
        p.vertex[i] = static_cast<std::uint32_t>(e.vertex[i]);
        p.weight[i] = static_cast<Real>(c);
        p.move[i] = static_cast<Real>(w * c);
      }
      p.softness = static_cast<Real>(softness);
      p.inverse = static_cast<Real>(1 / (mobility + softness));
    }
    prepared_for_ = h;
  }

  std::vector<BendingElement> elements_;
  std::vector<double> w_;  ///< 1/kg
  std::vector<Projected<Real>> projected_;
  double prepared_for_ = 0;  ///< s; 0: no substep yet
  std::vector<V> lambda_;    ///< kg m^3
};

}  // namespace

template <class Real>
std::unique_ptr<Pass<Real>> make_bending_pass(const Scene& scene, std::span<const double> w) {
  return std::make_unique<BendingPass<Real>>(scene, w);
}
template std::unique_ptr<Pass<float>> make_bending_pass(const Scene&, std::span<const double>);
template std::unique_ptr<Pass<double>> make_bending_pass(const Scene&, std::span<const double>);

}  // namespace taut
