#pragma once

#include "core/solver/distance.hpp"
#include "core/solver/hierarchy.hpp"
#include "core/solver/pass.hpp"

namespace taut {

/// Relaxes the coarse levels before the sweep over all links: from the coarsest to the finest, each
/// hands what it moved down to the next. Coarse links only resist stretching, for between their
/// ends the cloth may fold.
template <class Real, Projection kind>
class HierarchyPass final : public Pass<Real> {
 public:
  HierarchyPass(std::vector<Level> levels, std::size_t particles)
      : levels_(std::move(levels)),
        start_(std::make_shared<const Layout>(Layout::packed(particles))) {}

  void apply(Particles<Real>& p, double, double) override {
    for (const Level& level : levels_)
      for (const int v : level.vertices) start_.set(index(v), p.x[index(v)]);
    for (const Level& level : levels_) {
      for (const Stick<double>& stick : level.links) relax(p, stick);
      for (const Level::Child& child : level.children) {
        if (p.w[index(child.vertex)] == 0) continue;
        Point moved = Point::Zero();
        for (int k = child.first; k < child.end; ++k) {
          const auto& [parent, weight] = level.parents[index(k)];
          moved += static_cast<Real>(weight) * (p.x[index(parent)] - start_[index(parent)]);
        }
        p.x.add(index(child.vertex), moved);
      }
    }
  }

  std::vector<PassCost> cost() const override {
    PassCost cost{.pass = "hierarchy", .bytes = start_.bytes(), .projections = true};
    for (const Level& level : levels_) {
      cost.items += level.links.size();
      cost.bytes += level.links.size() * sizeof level.links[0] +
                    level.vertices.size() * sizeof level.vertices[0] +
                    level.children.size() * sizeof level.children[0] +
                    level.parents.size() * sizeof level.parents[0];
    }
    return {cost};
  }

 private:
  using Point = typename Points<Real>::Point;
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  static void relax(Particles<Real>& p, const Stick<double>& stick) {
    const Point a = p.x[index(stick.a)], b = p.x[index(stick.b)];
    const Real rest = static_cast<Real>(stick.rest);
    if ((b - a).squaredNorm() <= rest * rest) return;
    Triple<Real> x1{a.x(), a.y(), a.z()}, x2{b.x(), b.y(), b.z()};
    project_distance<kind>(x1, x2, rest, static_cast<Real>(stick.share_a),
                           static_cast<Real>(stick.share_b));
    p.x.set(index(stick.a), {x1.x, x1.y, x1.z});
    p.x.set(index(stick.b), {x2.x, x2.y, x2.z});
  }

  std::vector<Level> levels_;
  Points<Real> start_;  ///< where the coarse vertices were
};

}  // namespace taut
