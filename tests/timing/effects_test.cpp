// `taut bench effects`: what is timed together.
#include "experiments/timing/bench/effects.hpp"

#include <gtest/gtest.h>

#include <deque>

#include "core/model/solver.hpp"

namespace taut::effects_test {
namespace {

/// Jakobsen's, and the steps that it makes.
class Counting final : public Solver {
 public:
  Counting(std::unique_ptr<Solver> solver, int& steps)
      : solver_(std::move(solver)), steps_(steps) {}
  void load(const State& state) override { solver_->load(state); }
  void step(double t, double dt) override { ++steps_, solver_->step(t, dt); }
  void store(State& state) const override { solver_->store(state); }
  std::vector<PassCost> step_cost() const override { return solver_->step_cost(); }

 private:
  std::unique_ptr<Solver> solver_;
  int& steps_;
};

/// As long as it lives there is a solver "counting" with jakobsen's parameters.
class Counted {
 public:
  Counted() {
    steps_of().clear();
    set_solver_source(
        {.all = [] { return std::vector<const SolverEntry*>{&entry()}; },
         .find = [](std::string_view name,
                    std::string_view) { return name == "counting" ? &entry() : nullptr; }});
  }
  ~Counted() { set_solver_source({}); }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;
  /// Of every one that was made, in that order.
  std::vector<int> steps() const { return {steps_of().begin(), steps_of().end()}; }

 private:
  static std::deque<int>& steps_of() {
    static std::deque<int> steps;  // which stay where they are
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
  const std::vector<int> steps = counted.steps();  // the whole, without effects, the copies
  ASSERT_EQ(steps.size(), 2u + 16);
  EXPECT_GT(steps[1], 0);
  for (std::size_t copy = 2; copy < steps.size(); ++copy) EXPECT_EQ(steps[copy], steps[1]);
  EXPECT_EQ(rows[0].copies.size(), rows[0].whole.size());
  EXPECT_GT(rows[0].times_one().mid, 4);  // two threads are at best eight sheets' time
}

TEST(TwoCores, AreJudgedWhereBothWereFree) {
  TwoCores cores;
  cores.add(2, 1.25, 2, 2);         // 1.6 and 2
  cores.add(2, 4, 2, 2.5);          // half, and 1.6: another program had the second core
  cores.add(2.5, 1.25, 2, 2.0001);  // 2 and 1.9998
  cores.add(2, 1.25, 2, 4);         // 1.6 and 1
  cores.add(9, 1.25, 2, 4);  // 7.2 and 1: a slow single thread is not what calls the cores free
  EXPECT_EQ(cores.rounds(), 5u);
  EXPECT_EQ(cores.free_rounds(), 2u);
  EXPECT_DOUBLE_EQ(cores.threads_while_free().low, 1.6);
  EXPECT_DOUBLE_EQ(cores.threads_while_free().high, 2);
  EXPECT_DOUBLE_EQ(cores.threads().low, 0.5);
  EXPECT_DOUBLE_EQ(cores.unrelated().high, 2);
  EXPECT_DOUBLE_EQ(cores.unrelated().low, 1);
  EXPECT_NEAR(cores.share().mid, 0.8, 1e-4);
}

TEST(BenchEffects, TwoThreadsAreTimedBesideTwoUnrelatedSheets) {
  const Counted counted;
  const auto rows = bench_effects({.scenes = {"hang", "crumple"},
                                   .solver = "counting:iterations=1,substeps=2",
                                   .side = 92,  // so fine that threads share it
                                   .two_threads = true,
                                   .rounds = 2,
                                   .seconds = 0.001});
  ASSERT_EQ(rows.size(), 2u);
  for (const EffectRow& row : rows) {
    EXPECT_EQ(row.refused, "");
    EXPECT_EQ(row.two_cores.rounds(), 4u);
    EXPECT_TRUE(row.whole.empty());
  }
  const std::vector<int> steps = counted.steps();  // one thread, two threads, another sheet
  ASSERT_EQ(steps.size(), 2u * 3);
  for (const std::size_t scene : {0u, 3u}) {
    EXPECT_GT(steps[scene + 1], 0);
    EXPECT_EQ(steps[scene + 2], steps[scene + 1]) << "each sheet makes every step";
    // Alone before and after, then beside the other one; and the whole run before all that.
    EXPECT_GT(steps[scene], 3 * steps[scene + 1]);
  }
}

TEST(BenchEffects, LookingInVainCostsLessThanContact) {
  const auto rows = bench_effects({.scenes = {"hang", "box", "disc"},
                                   .solver = "jakobsen:iterations=1,substeps=15",
                                   .rounds = 5,
                                   .seconds = 0.002});
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_TRUE(rows[0].touching_nothing.empty());
  ASSERT_EQ(rows[1].touching_nothing.size(), rows[1].whole.size());
  EXPECT_LT(interleaved_ratio(rows[1].touching_nothing, rows[1].whole).mid, 0.9);
  EXPECT_TRUE(rows[1].traffic.empty());
  ASSERT_EQ(rows[2].traffic.size(), rows[2].whole.size());
  // About 0.95 where nothing else runs: the low end, for a round in which something does.
  EXPECT_LT(interleaved_ratio(rows[2].traffic, rows[2].links_alone).low, 1);
  EXPECT_GT(interleaved_ratio(rows[2].traffic, rows[0].whole).mid, 0.5);
}

}  // namespace
}  // namespace taut::effects_test
