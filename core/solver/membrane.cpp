#include "core/solver/membrane.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <utility>
#include <vector>

namespace taut {

namespace {

/// The elements in colours: none of a colour shares a vertex, as none of the links of a colour does
/// (order=coloured), so that a correction does not run across the cloth within one sweep.
MembraneModel coloured(MembraneModel membrane, std::size_t vertices) {
  std::vector<std::vector<std::size_t>> taken(vertices);  // colours at each vertex
  std::vector<std::pair<std::size_t, MembraneElement>> all;
  for (const MembraneElement& e : membrane.elements) {
    std::size_t colour = 0;
    const auto has = [&](int v) { return std::ranges::count(taken[to_index(v)], colour) > 0; };
    while (std::ranges::any_of(e.vertex, has)) ++colour;
    for (const int v : e.vertex) taken[to_index(v)].push_back(colour);
    all.emplace_back(colour, e);
  }
  std::ranges::stable_sort(all, {}, [](const auto& one) { return one.first; });
  for (std::size_t k = 0; k < all.size(); ++k) membrane.elements[k] = all[k].second;
  return membrane;
}

template <class Real>
class MembranePass final : public Pass<Real> {
 public:
  using V = typename Points<Real>::Point;
  MembranePass(const Scene& scene, std::span<const double> w, double h)
      : membrane_(coloured(make_membrane(scene, h), w.size())),
        compliance_(membrane_.law.stiffness().inverse()),
        w_(w.begin(), w.end()),
        lambda_(membrane_.elements.size()) {}

  void begin(Particles<Real>& p, double, double) override {
    membrane_.begin([&](std::size_t v) { return p.previous[v]; });
    std::ranges::fill(lambda_, Vec3(Vec3::Zero()));
  }

  void apply(Particles<Real>& p, double, double h) override {
    for (std::size_t k = 0; k < lambda_.size(); ++k) {
      const MembraneElement& e = membrane_.elements[k];
      const MembraneLaw::Strain strain =
          membrane_.law.strain(e.deformation([&](std::size_t v) { return p.x[v]; }));
      const Eigen::Matrix3d softness = compliance_ / (e.area * h * h);
      Eigen::Matrix3d system = softness;
      std::array<Eigen::Matrix3d, 3> by_corner;
      for (std::size_t a = 0; a < 3; ++a) {
        by_corner[a] = strain.by_corner(e.gradient[a]);
        system += w_[to_index(e.vertex[a])] * by_corner[a] * by_corner[a].transpose();
      }
      const Vec3 change =
          system.llt().solve(membrane_.rest(e) - strain.value - softness * lambda_[k]);
      lambda_[k] += change;
      for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t v = to_index(e.vertex[a]);
        const Vec3 move = w_[v] * (by_corner[a].transpose() * change);
        if (w_[v] != 0) p.x.add(v, V(move.template cast<Real>()));
      }
    }
  }

  std::vector<PassCost> cost() const override {
    return {
        {.pass = "membrane",
         .items = lambda_.size(),
         .bytes = membrane_.bytes() + lambda_.size() * sizeof(Vec3) + w_.size() * sizeof(double)}};
  }

 private:
  MembraneModel membrane_;
  Eigen::Matrix3d compliance_;  ///< m/N, C^-1
  std::vector<double> w_;       ///< 1/kg
  std::vector<Vec3> lambda_;    ///< kg m^2
};

}  // namespace

template <class Real>
std::unique_ptr<Pass<Real>> make_membrane_pass(const Scene& scene, std::span<const double> w,
                                               double h) {
  return std::make_unique<MembranePass<Real>>(scene, w, h);
}
template std::unique_ptr<Pass<float>> make_membrane_pass(const Scene&, std::span<const double>,
                                                         double);
template std::unique_ptr<Pass<double>> make_membrane_pass(const Scene&, std::span<const double>,
                                                          double);

}  // namespace taut
