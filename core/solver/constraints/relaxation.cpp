#include "core/solver/constraints/relaxation.hpp"

#include <algorithm>
#include <type_traits>

#include "core/model/input_error.hpp"
#include "core/solver/constraints/hierarchy.hpp"
#include "core/solver/constraints/lines.hpp"
#include "core/solver/layout/colour_batches.hpp"
#include "core/solver/layout/interleaved_sheet.hpp"

namespace taut {

namespace {

/// One cost entry for each family with links that move; `bytes` is divided in proportion to their
/// number.
std::vector<PassCost> family_costs(std::span<const Link> links, std::span<const double> w,
                                   std::size_t bytes) {
  std::array<std::size_t, kFamilies.size()> items{};
  std::size_t all = 0;
  for (const Link& link : links)
    if (moves(link, w)) {
      ++items[static_cast<std::size_t>(link.family)];
      ++all;
    }
  std::vector<PassCost> costs;
  for (const Family family : kFamilies)
    if (const std::size_t n = items[static_cast<std::size_t>(family)]; n > 0)
      costs.push_back({.pass = std::string(to_string(family)),
                       .items = n,
                       .bytes = bytes * n / all,
                       .projections = true});
  return costs;
}

/// One Gauss-Seidel sweep over the links, one after another.
template <class Real, Projection kind>
class GaussSeidelPass final : public Pass<Real> {
 public:
  GaussSeidelPass(std::vector<DistanceConstraint<Real>> constraints, DampedConstraints<Real> damped,
                  std::vector<PassCost> costs)
      : constraints_(std::move(constraints)),
        damped_(std::move(damped)),
        costs_(std::move(costs)) {}

  void begin(Particles<Real>& p, double, double) override {
    damped_.begin(constraints_, p.previous.data());
  }
  void apply(Particles<Real>& p, double, double) override {
    Real* const x = p.x.data();
    for (const DistanceConstraint<Real>& c : constraints_) {
      Real* const a = x + 4 * c.a;
      Real* const b = x + 4 * c.b;
      Vec3T<Real> x1 = point_at(a);
      Vec3T<Real> x2 = point_at(b);
      project_distance<kind>(x1, x2, c.rest, c.share_a, c.share_b);
      put_point(a, x1);
      put_point(b, x2);
    }
  }

  std::vector<PassCost> cost() const override { return costs_; }

 private:
  std::vector<DistanceConstraint<Real>> constraints_;
  DampedConstraints<Real> damped_;
  std::vector<PassCost> costs_;
};

/// One Gauss-Seidel sweep with multipliers: XPBD's Algorithm 1.
template <class Real>
class CompliantGaussSeidelPass final : public Pass<Real> {
 public:
  CompliantGaussSeidelPass(std::vector<CompliantConstraint<Real>> constraints,
                           DampedConstraints<Real> damped, std::vector<PassCost> costs)
      : constraints_(std::move(constraints)),
        damped_(std::move(damped)),
        multipliers_(constraints_.size()),
        costs_(std::move(costs)) {}

  void begin(Particles<Real>& p, double, double) override {
    damped_.begin(constraints_, p.previous.data());
    std::ranges::fill(multipliers_, Real(0));
  }
  void apply(Particles<Real>& p, double, double) override {
    Real* const x = p.x.data();
    for (std::size_t i = 0; i < constraints_.size(); ++i) {
      const CompliantConstraint<Real>& c = constraints_[i];
      Real* const a = x + 4 * c.a;
      Real* const b = x + 4 * c.b;
      Vec3T<Real> x1 = point_at(a);
      Vec3T<Real> x2 = point_at(b);
      move_ends(x1, x2, c.share_a, c.share_b, [&](Real length2) {
        return compliant_excess(length2, c.rest, c.share, multipliers_[i]);
      });
      put_point(a, x1);
      put_point(b, x2);
    }
  }

  std::vector<PassCost> cost() const override { return costs_; }

 private:
  std::vector<CompliantConstraint<Real>> constraints_;
  DampedConstraints<Real> damped_;
  std::vector<Real> multipliers_;  ///< m; compliance / h^2 times XPBD's lambda
  std::vector<PassCost> costs_;
};

/// One Jacobi sweep: every link sees the particles as they were when the sweep began.
template <class Real, Projection kind>
class JacobiPass final : public Pass<Real> {
 public:
  JacobiPass(Jacobi method, std::vector<DistanceConstraint<Real>> constraints,
             std::vector<PassCost> costs, std::size_t particles)
      : constraints_(std::move(constraints)),
        costs_(std::move(costs)),
        correction_(std::make_shared<const Layout>(Layout::packed(particles))),
        factor_(particles, Real(1)) {
    std::vector<int> links(particles);
    for (const DistanceConstraint<Real>& c : constraints_) {
      ++links[static_cast<std::size_t>(c.a)];
      ++links[static_cast<std::size_t>(c.b)];
    }
    const int most = links.empty() ? 0 : *std::max_element(links.begin(), links.end());
    for (std::size_t i = 0; i < links.size(); ++i)
      if (method != Jacobi::plain && links[i] > 0)
        factor_[i] = Real(1) / static_cast<Real>(method == Jacobi::averaged ? links[i] : most);
    if (!costs_.empty())
      costs_.front().bytes += correction_.bytes() + factor_.size() * sizeof(Real);
  }

  void apply(Particles<Real>& p, double, double) override {
    using Point = typename Points<Real>::Point;
    for (const DistanceConstraint<Real>& c : constraints_) {
      const auto a = static_cast<std::size_t>(c.a), b = static_cast<std::size_t>(c.b);
      const Point from1 = p.x[a], from2 = p.x[b];
      Vec3T<Real> x1{from1.x(), from1.y(), from1.z()}, x2{from2.x(), from2.y(), from2.z()};
      project_distance<kind>(x1, x2, c.rest, c.share_a, c.share_b);
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
  std::vector<DistanceConstraint<Real>> constraints_;
  std::vector<PassCost> costs_;
  Points<Real> correction_;
  std::vector<Real> factor_;
};

/// One Gauss-Seidel sweep over an InterleavedSheet or ColourBatches, shared among threads.
template <class Real, template <class> class Links>
class ColouredPass final : public Pass<Real> {
 public:
  ColouredPass(Links<Real> links, std::vector<PassCost> costs, const RelaxationSettings& settings,
               ThreadPool& pool)
      : links_(std::move(links)),
        costs_(std::move(costs)),
        projection_(settings.projection),
        compliant_(settings.compliances.multipliers),
        kernels_(kernels<Real>(settings.simd)),
        pool_(pool) {}

  void restart() override { links_.clear_multipliers(); }
  void begin(Particles<Real>& p, double, double) override {
    keep_ = Real(0);
    if constexpr (std::is_same_v<Links<Real>, ColourBatches<Real>>) links_.damp(p.previous.data());
  }
  void apply(Particles<Real>& p, double, double) override {
    sweep(links_, p);
    keep_ = Real(1);
  }
  bool queues() const override { return std::is_same_v<Links<Real>, InterleavedSheet<Real>>; }

  std::vector<PassCost> cost() const override { return costs_; }

 private:
  void sweep(const InterleavedSheet<Real>& links, Particles<Real>& p) {
    const bool wide = links.sweep().lanes == kWide, shared = p.size() >= ThreadPool::kWorthSharing;
    const auto of_block = [&links, x = p.x.data()](std::size_t block, const auto& project) {
      const auto [begin, end] = rows_of_block(block, links.rows());
      project(links.sweep(), x, begin, end);
    };
    if (compliant_) {
      const auto project = wide ? kernels_.compliant_wide_sheet : kernels_.compliant_narrow_sheet;
      pool_.queue_pairs(
          p.layout->blocks(),
          [of_block, project, keep = keep_](std::size_t block) {
            of_block(block, [&](const auto& sweep, Real* x, int begin, int end) {
              project(sweep, x, keep, begin, end);
            });
          },
          shared);
    } else {
      const auto& kernels = wide ? kernels_.wide_sheet : kernels_.narrow_sheet;
      const auto project = kernels[static_cast<int>(projection_)];
      pool_.queue_pairs(
          p.layout->blocks(), [of_block, project](std::size_t block) { of_block(block, project); },
          shared);
    }
  }

  void sweep(const ColourBatches<Real>& links, Particles<Real>& p) {
    const auto project = kernels_.batches[static_cast<int>(projection_)];
    for (std::size_t phase = 0; phase < links.phases(); ++phase)
      pool_.run(
          links.parts(phase),
          [&](std::size_t begin, std::size_t end) {
            for (std::size_t tile = begin; tile < end; ++tile)
              for (const BatchRun<Real>& run : links.runs(phase, tile))
                compliant_ ? kernels_.compliant_batches(run, p.x.data(), keep_)
                           : project(run, p.x.data());
          },
          p.size() >= ThreadPool::kWorthSharing);
  }

  Links<Real> links_;
  std::vector<PassCost> costs_;
  Projection projection_;
  bool compliant_;  ///< some links have multipliers
  /// Factor on the multipliers at the start of the next sweep: 0 in the first, then 1.
  Real keep_ = 0;
  const Kernels<Real>& kernels_;
  ThreadPool& pool_;
};

/// The scene's regular links if an interleaved sheet is to hold them. Throws InputError if
/// layout=interleaved was asked for and the scene has no such links.
std::optional<RegularLinks> regular(const Scene& scene, LinkLayout layout) {
  if (layout == LinkLayout::batches) return {};
  auto links = regular_links(scene.mesh, scene.links);
  if (!links && layout == LinkLayout::interleaved)
    throw InputError(
        "layout=interleaved needs a regular sheet of at least 8 columns or rows with "
        "all links "
        "of a direction present and of one length; layout=batches takes any mesh");
  return links;
}

template <class Real, Projection kind>
std::unique_ptr<Pass<Real>> make_sequential(const Scene& scene, std::span<const double> w,
                                            const RelaxationSettings& settings) {
  const std::vector<Link> links = ordered(scene, settings.order, settings.seed);
  DampedConstraints<Real> damped(links, w, settings.compliances);
  if (settings.compliances.multipliers) {
    auto compliant =
        make_compliant_constraints<Real>(links, w, settings.omega, settings.compliances);
    auto costs = family_costs(
        links, w, compliant.size() * (sizeof compliant[0] + sizeof(Real)) + damped.bytes());
    return std::make_unique<CompliantGaussSeidelPass<Real>>(std::move(compliant), std::move(damped),
                                                            std::move(costs));
  }
  auto constraints =
      make_distance_constraints<Real>(links, w, settings.omega, settings.compliances);
  auto costs = family_costs(links, w, constraints.size() * sizeof constraints[0] + damped.bytes());
  if (settings.jacobi)
    return std::make_unique<JacobiPass<Real, kind>>(*settings.jacobi, std::move(constraints),
                                                    std::move(costs), scene.start.x.size());
  return std::make_unique<GaussSeidelPass<Real, kind>>(std::move(constraints), std::move(damped),
                                                       std::move(costs));
}

/// The pass that visits the links one after another, or null if no link can move.
template <class Real>
std::unique_ptr<Pass<Real>> make_sequential(const Scene& scene, std::span<const double> w,
                                            const RelaxationSettings& settings) {
  if (family_costs(scene.links, w, 0).empty()) return nullptr;
  return settings.projection == Projection::exact
             ? make_sequential<Real, Projection::exact>(scene, w, settings)
             : make_sequential<Real, Projection::sqrt_free>(scene, w, settings);
}

}  // namespace

template <class Real>
Relaxation<Real> make_relaxation(const Scene& scene, std::span<const double> w,
                                 const RelaxationSettings& settings, ThreadPool& pool) {
  const std::size_t n = scene.start.x.size();
  if (family_costs(scene.links, w, 0).empty()) return {Layout::packed(n), nullptr};
  if (settings.lines) {
    Scene others = scene;
    std::erase_if(others.links, [](const Link& l) { return l.family == Family::structural; });
    return {Layout::packed(n), make_lines(scene, w, make_sequential<Real>(others, w, settings))};
  }
  if (settings.order != Order::coloured || settings.jacobi)
    return {Layout::packed(n), make_sequential<Real>(scene, w, settings)};
  const auto coloured = [&]<template <class> class Links>(Layout layout, Links<Real> sweep) {
    auto costs = family_costs(scene.links, w, sweep.bytes());
    return Relaxation<Real>{std::move(layout),
                            std::make_unique<ColouredPass<Real, Links>>(
                                std::move(sweep), std::move(costs), settings, pool)};
  };
  // A sheet has one rest length for all links of a direction, and damped ones have each their own.
  const bool damped = settings.compliances.damped > 0;
  if (const auto links = damped ? std::nullopt : regular(scene, settings.layout))
    return coloured(interleaved_layout(links->grid),
                    InterleavedSheet<Real>(*links, w, settings.omega, settings.compliances));
  Layout layout = Layout::packed(n, tile_ranks(scene.mesh));
  ColourBatches<Real> batches(colour(scene.links, scene.mesh), w, settings.omega, layout,
                              settings.compliances);
  return coloured(std::move(layout), std::move(batches));
}

template <class Real>
std::vector<std::unique_ptr<Pass<Real>>> make_levels(const Scene& scene, std::span<const double> w,
                                                     const RelaxationSettings& settings) {
  std::vector<std::unique_ptr<Pass<Real>>> passes;
  if (settings.levels == 1) return passes;
  auto levels = make_hierarchy(scene, w, settings.levels - 1);
  if (levels.empty()) return passes;
  if (settings.projection == Projection::exact)
    passes.push_back(
        std::make_unique<HierarchyPass<Real, Projection::exact>>(std::move(levels), w.size()));
  else
    passes.push_back(
        std::make_unique<HierarchyPass<Real, Projection::sqrt_free>>(std::move(levels), w.size()));
  return passes;
}

template Relaxation<float> make_relaxation(const Scene&, std::span<const double>,
                                           const RelaxationSettings&, ThreadPool&);
template Relaxation<double> make_relaxation(const Scene&, std::span<const double>,
                                            const RelaxationSettings&, ThreadPool&);
template std::vector<std::unique_ptr<Pass<float>>> make_levels(const Scene&,
                                                               std::span<const double>,
                                                               const RelaxationSettings&);
template std::vector<std::unique_ptr<Pass<double>>> make_levels(const Scene&,
                                                                std::span<const double>,
                                                                const RelaxationSettings&);

}  // namespace taut
