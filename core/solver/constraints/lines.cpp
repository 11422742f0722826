#include "core/solver/constraints/lines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "core/model/index.hpp"
#include "core/solver/simd/distance.hpp"

namespace taut {

namespace {

template <class Real>
class LinesPass final : public Pass<Real> {
 public:
  LinesPass(const Scene& scene, std::span<const double> w, std::unique_ptr<Pass<Real>> others)
      : others_(std::move(others)) {
    std::map<std::pair<int, int>, double> rest;
    for (const Link& link : scene.links)
      if (link.family == Family::structural) rest[std::minmax(link.a, link.b)] = link.rest;
    const auto add = [&](int first, int stride, int count) {
      std::vector<LineLink> line;
      for (int a = first; a < first + count * stride; a += stride) {
        const auto link = rest.find({a, a + stride});
        if (link != rest.end() && a + stride < first + count * stride)
          line.push_back({to_index(a), to_index(a + stride), link->second, w[to_index(a)],
                          w[to_index(a + stride)]});
        else if (!line.empty())
          lines_.push_back(std::exchange(line, {}));
      }
    };
    const Grid& grid = *scene.mesh.grid;
    for (int j = 0; j < grid.nv; ++j) add(grid.index(0, j), 1, grid.nu);
    for (int i = 0; i < grid.nu; ++i) add(grid.index(i, 0), grid.nu, grid.nv);
    rows_.resize(to_index(std::max(grid.nu, grid.nv)));
  }

  void restart() override {
    if (others_) others_->restart();
  }
  void begin(Particles<Real>& p, double t, double h) override {
    if (others_) others_->begin(p, t, h);
  }
  void end(Particles<Real>& p, double t, double h) override {
    if (others_) others_->end(p, t, h);
  }
  void apply(Particles<Real>& p, double t, double h) override {
    for (const std::vector<LineLink>& line : lines_) solve(line, p);
    if (others_) others_->apply(p, t, h);
  }

  std::vector<PassCost> cost() const override {
    std::size_t links = 0, that_move = 0;
    for (const auto& line : lines_) {
      links += line.size();
      for (const LineLink& link : line) that_move += link.wa + link.wb > 0 ? 1 : 0;
    }
    std::vector<PassCost> costs{{.pass = "structural, in lines",
                                 .items = that_move,
                                 .bytes = links * sizeof(LineLink) + rows_.size() * sizeof(Row),
                                 .projections = true}};
    if (others_)
      for (PassCost& cost : others_->cost()) costs.push_back(std::move(cost));
    return costs;
  }

 private:
  struct LineLink {
    std::size_t a, b;
    double rest, wa, wb;  ///< m, 1/kg
  };
  /// A row of the system: link direction, off-diagonal entry to the row before [1/kg], pivot
  /// [1/kg], and the right-hand side that is left [m].
  struct Row {
    Vec3 u;
    double off, pivot, right;
  };

  void solve(const std::vector<LineLink>& line, Particles<Real>& p) {
    double largest = 0;
    for (const LineLink& link : line) largest = std::max(largest, link.wa + link.wb);
    const double softness = (sizeof(Real) == sizeof(float) ? 1e-5 : 1e-8) * largest;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const LineLink& link = line[i];
      const Vec3 d = (p.x[link.b] - p.x[link.a]).template cast<double>();
      const double length = d.norm() + kTinyLength;
      Row& row = rows_[i] = {d / length, 0, link.wa + link.wb + softness, length - link.rest};
      if (row.pivot == 0) row.pivot = 1;  // two pins
      if (i == 0) continue;
      const Row& before = rows_[i - 1];
      row.off = -link.wa * before.u.dot(row.u);
      const double share = row.off / before.pivot;
      row.pivot -= share * row.off;
      row.right -= share * before.right;
    }
    double next = 0;  // off-diagonal entry times multiplier of the next row
    for (std::size_t i = line.size(); i-- > 0;) {
      const LineLink& link = line[i];
      const Row& row = rows_[i];
      const double multiplier = (row.right - next) / row.pivot;
      next = row.off * multiplier;
      if (link.wa > 0) p.x.add(link.a, (link.wa * multiplier * row.u).template cast<Real>());
      if (link.wb > 0) p.x.add(link.b, (-link.wb * multiplier * row.u).template cast<Real>());
    }
  }

  std::vector<std::vector<LineLink>> lines_;
  std::vector<Row> rows_;  ///< [links of the longest line]
  std::unique_ptr<Pass<Real>> others_;
};

}  // namespace

template <class Real>
std::unique_ptr<Pass<Real>> make_lines(const Scene& scene, std::span<const double> w,
                                       std::unique_ptr<Pass<Real>> others) {
  return std::make_unique<LinesPass<Real>>(scene, w, std::move(others));
}
template std::unique_ptr<Pass<float>> make_lines(const Scene&, std::span<const double>,
                                                 std::unique_ptr<Pass<float>>);
template std::unique_ptr<Pass<double>> make_lines(const Scene&, std::span<const double>,
                                                  std::unique_ptr<Pass<double>>);

double line_tension(const Scene& scene, double h) {
  double weight = 0, lightest = std::numeric_limits<double>::infinity(), shortest = lightest;
  for (const double m : scene.mesh.mass) {
    weight += m * scene.gravity.norm();
    lightest = std::min(lightest, m);
  }
  for (const Link& link : scene.links)
    if (link.family == Family::structural && !is_seam(link))
      shortest = std::min(shortest, link.rest);
  if (scene.pins.empty()) return 0;
  return h * h * weight / static_cast<double>(scene.pins.size()) / (lightest * shortest);
}

}  // namespace taut
