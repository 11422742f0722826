// `taut bench effects`: which runs are timed together.
#include "experiments/timing/bench/effects.hpp"

#include <gtest/gtest.h>

#include <deque>

#include "core/model/solver.hpp"

namespace taut::effects_test {
namespace {

/// Jakobsen's solver, counting its steps.
class Counting final : public Solver {
 public:
  Counting(std::unique_ptr<Solver> solver, int& steps)
      : solver_(std::move(solver)), steps_(steps) {}
  void load(const State& state) override { solver_->load(state); }
  void step(double t, double dt) override {
    ++steps_;
    solver_->step(t, dt);
  }
  void store(State& state) const override { solver_->store(state); }
  std::vector<PassCost> step_cost() const override { return solver_->step_cost(); }

 private:
  std::unique_ptr<Solver> solver_;
  int& steps_;
};

/// Registers a solver "counting" with jakobsen's parameters for its lifetime.
class Counted {
 public:
  Counted() {
    steps_of().clear();
    set_solver_source(
        {.names = [] { return std::vector<std::string>{"counting"}; },
         .find = [](std::string_view name,
                    std::string_view) { return name == "counting" ? &entry() : nullptr; }});
  }
  ~Counted() { set_solver_source({}); }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;
  /// Steps of every instance that was made, in order of creation.
  std::vector<int> steps() const { return {steps_of().begin(), steps_of().end()}; }

 private:
  static std::deque<int>& steps_of() {
    static std::deque<int> steps;  // a deque, so that references stay valid
    return steps;
  }
  static const SolverEntry& entry() {
    static const SolverEntry counting = [] {
      SolverEntry one = find_solver("jakobsen");
      one.name = "counting";
      one.make = [make = one.make](const Scene& scene, const Params& params) {
        return std::make_unique<Counting>(make(scene, params), steps_of().emplace_back(0));
      };
      return one;
    }();
    return counting;
  }
};

TEST(BenchEffects, EveryCopyMakesEveryStep) {
  const Counted counted;
  const auto rows = bench_effects({.scenes = {"hang"},
                                   .solver = "counting:iterations=1,substeps=15",
                                   .side = 24,
                                   .copies = 16,
                                   .rounds = 5,
                                   .seconds = 0.001});
  ASSERT_EQ(rows.size(), 1u);
  const std::vector<int> steps = counted.steps();  // whole scene, without effects, copies
  ASSERT_EQ(steps.size(), 2u + 16);
  EXPECT_GT(steps[1], 0);
  for (std::size_t copy = 2; copy < steps.size(); ++copy) EXPECT_EQ(steps[copy], steps[1]);
  EXPECT_EQ(rows[0].copies.size(), rows[0].whole.size());
  // two threads save at most half of the time of eight sheets
  EXPECT_GT(rows[0].times_one().mid, 4);
}

TEST(BenchEffects, LookingInVainCostsLessThanContact) {
#ifdef TAUT_SANITIZED
  GTEST_SKIP() << "times of a program without sanitizers are what users compare";
#endif
  const auto rows = bench_effects({.scenes = {"hang", "box"},
                                   .solver = "jakobsen:iterations=1,substeps=15",
                                   .rounds = 5,
                                   .seconds = 0.002});
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_TRUE(rows[0].touching_nothing.empty());
  ASSERT_EQ(rows[1].touching_nothing.size(), rows[1].whole.size());
  EXPECT_LT(interleaved_ratio(rows[1].touching_nothing, rows[1].whole).mid, 0.9);
}

// The thickness of `ball` would fill the gaps between vertices of so fine a sheet.
TEST(BenchEffects, ASceneThatCannotBeTimedCostsItselfAlone) {
  const EffectBenchOptions options{.scenes = {"hang", "no-such-scene", "ball"},
                                   .solver = "jakobsen:iterations=1,substeps=2",
                                   .side = 96,
                                   .rounds = 1,
                                   .seconds = 1e-4};
  const auto rows = bench_effects(options);
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_NE(rows[1].refused.find("no-such-scene"), std::string::npos) << rows[1].refused;
  for (const std::size_t k : {0u, 2u}) {
    EXPECT_EQ(rows[k].refused, "");
    EXPECT_EQ(rows[k].whole.size(), 2u);
  }
}

}  // namespace
}  // namespace taut::effects_test
