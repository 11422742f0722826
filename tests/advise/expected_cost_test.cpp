// Order in which taut advise tries solvers: by their measured cost, otherwise by theory.
#include "experiments/advise/expected_cost.hpp"

#include <gtest/gtest.h>

#include "experiments/system/files.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut::expected_cost_test {
namespace {

using Names = std::vector<std::string>;

/// Case of `hang` that took `seconds` per step [s].
BenchedCase timed(const std::string& solver, double seconds, char key) {
  BenchedCase c;
  c.record.solver = solver;
  c.record.scene = "hang";
  c.record.dt = 1.0 / 64;
  c.record.key = std::string(64, key);
  c.timing.samples = {seconds, seconds};
  c.timing.wall = {seconds, seconds};
  return c;
}

TEST(ExpectedCost, IsTheoryWhereNothingWasTimed) {
  const Scratch scratch;
  const Store store(scratch.path() / "results");
  EXPECT_EQ(by_expected_cost({"implicit", "vbd", "jakobsen", "nobody"}, "hang", {}, store),
            (Names{"jakobsen", "vbd", "implicit", "nobody"}));
}

TEST(ExpectedCost, IsWhatWasTimedOnASceneOfThisName) {
  const Scratch scratch;
  Store store(scratch.path() / "results");
  StudyBench session{"trade",
                     "m",
                     {{"hang",
                       {1, 1, 1},
                       {timed("jakobsen", 5e-3, 'a'), timed("jakobsen", 3e-3, 'b'),
                        timed("implicit", 1e-3, 'c')}}}};
  for (const BenchedCase& c : session.scenes[0].cases) store.commit(c.record);
  keep(store, session);
  EXPECT_EQ(by_expected_cost({"jakobsen", "implicit"}, "hang", {}, store),
            (Names{"implicit", "jakobsen"}));
  EXPECT_EQ(by_expected_cost({"implicit", "jakobsen"}, "drape", {}, store),
            (Names{"jakobsen", "implicit"}))
      << "another scene";
}

TEST(ExpectedCost, AnUnfinishedSearchSaysSo) {
  EXPECT_EQ(so_far("cheapest", 3, 0), "cheapest so far; 3 solvers not tried");
  EXPECT_EQ(so_far("cheapest", 1, 2),
            "cheapest so far; 1 solver not tried, 2 solvers not searched to the end");
}

}  // namespace
}  // namespace taut::expected_cost_test
