#pragma once

#include <vector>

#include "core/model/scene.hpp"
#include "core/solver/layout/order.hpp"
#include "core/solver/layout/particles.hpp"

namespace taut {

/// One level of a hierarchy of ever coarser cloths.
struct Level {
  std::vector<int> vertices;  ///< of this level; about half as many as in the finer one
  std::vector<DistanceConstraint<double>> links;  ///< between vertices that were two links apart
  /// A vertex that exists on the next finer level only; it moves with the weighted mean of its
  /// parents.
  struct Child {
    int vertex = 0;
    int first = 0, end = 0;  ///< range in `parents`
  };
  std::vector<Child> children;
  struct Parent {
    int vertex = 0;
    double weight = 0;  ///< inverse distance at rest; those of a child add up to 1
  };
  std::vector<Parent> parents;
};

/// Builds the hierarchy of Mueller, Hierarchical Position Based Dynamics (VRIPHYS 2008). Each level
/// has every pin and a greedy independent set of the finer level, so that every other vertex has a
/// neighbour in it. Coarsest level first; at most `levels` levels, fewer when nothing is left to
/// coarsen.
std::vector<Level> make_hierarchy(const Scene&, std::span<const double> w, int levels);

/// Relaxes the coarse levels before the sweep over all links, from the coarsest to the finest. Each
/// level hands its displacements down to the next. Coarse links only resist stretching, because the
/// cloth may fold between their ends.
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
      for (const DistanceConstraint<double>& c : level.links) relax(p, c);
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

  static void relax(Particles<Real>& p, const DistanceConstraint<double>& c) {
    const Point a = p.x[index(c.a)], b = p.x[index(c.b)];
    const Real rest = static_cast<Real>(c.rest);
    if ((b - a).squaredNorm() <= rest * rest) return;
    Vec3T<Real> x1{a.x(), a.y(), a.z()}, x2{b.x(), b.y(), b.z()};
    project_distance<kind>(x1, x2, rest, static_cast<Real>(c.share_a),
                           static_cast<Real>(c.share_b));
    p.x.set(index(c.a), {x1.x, x1.y, x1.z});
    p.x.set(index(c.b), {x2.x, x2.y, x2.z});
  }

  std::vector<Level> levels_;
  Points<Real> start_;  ///< positions of the coarse vertices before the pass
};

}  // namespace taut
