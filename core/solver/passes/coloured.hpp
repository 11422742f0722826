#pragma once

#include "core/solver/batch.hpp"
#include "core/solver/distance.hpp"
#include "core/solver/pass.hpp"
#include "core/solver/strips.hpp"
#include "core/solver/team.hpp"

namespace taut {

/// One Gauss-Seidel sweep over a regular sheet, kLanes links at a time.
template <class Real>
class StripPass final : public Pass<Real> {
 public:
  StripPass(StripPlan<Real> plan, std::vector<PassCost> costs, Projection projection, Simd simd,
            Team& team)
      : plan_(std::move(plan)),
        costs_(std::move(costs)),
        project_(choose(kernels<Real>(simd), plan_.sweep().lanes)[static_cast<int>(projection)]),
        team_(team) {}

  void apply(Particles<Real>& p, double, double) override {
    for (const int parity : {0, 1})
      team_.run(plan_.blocks(parity), [&](std::size_t begin, std::size_t end) {
        for (std::size_t block = begin; block < end; ++block) {
          const auto rows = plan_.rows(parity, block);
          project_(plan_.sweep(), p.x.data(), rows.begin, rows.end);
        }
      });
  }

  std::vector<PassCost> cost() const override { return costs_; }

 private:
  static const auto& choose(const Kernels<Real>& kernels, int lanes) {
    return lanes == kWide ? kernels.wide_strips : kernels.narrow_strips;
  }
  StripPlan<Real> plan_;
  std::vector<PassCost> costs_;
  void (*project_)(const StripSweep<Real>&, Real*, int, int);
  Team& team_;
};

/// The same for any links.
template <class Real>
class BatchPass final : public Pass<Real> {
 public:
  BatchPass(BatchPlan<Real> plan, std::vector<PassCost> costs, Projection projection, Simd simd,
            Team& team)
      : plan_(std::move(plan)),
        costs_(std::move(costs)),
        project_(kernels<Real>(simd).batches[static_cast<int>(projection)]),
        team_(team) {}

  void apply(Particles<Real>& p, double, double) override {
    for (std::size_t phase = 0; phase < plan_.phases(); ++phase)
      team_.run(plan_.tiles(phase), [&](std::size_t begin, std::size_t end) {
        for (std::size_t tile = begin; tile < end; ++tile)
          for (const BatchRun<Real>& run : plan_.runs(phase, tile)) project_(run, p.x.data());
      });
  }

  std::vector<PassCost> cost() const override { return costs_; }

 private:
  BatchPlan<Real> plan_;
  std::vector<PassCost> costs_;
  void (*project_)(const BatchRun<Real>&, Real*);
  Team& team_;
};

}  // namespace taut
