// `taut bench effects`: what is timed together.
#include "experiments/timing/bench/effects.hpp"

#include <gtest/gtest.h>

namespace taut {
namespace {

TEST(BenchEffects, EveryCopyMakesEveryStep) {
  const auto rows = bench_effects({.scenes = {"hang"},
                                   .solver = "jakobsen:iterations=1,substeps=15",
                                   .side = 24,
                                   .wall = true,
                                   .copies = 16,
                                   .rounds = 5,
                                   .seconds = 0.001});
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].copies.size(), rows[0].whole.size());
  EXPECT_GT(rows[0].times_one().mid, 4);  // two threads are at best eight sheets' time
}

}  // namespace
}  // namespace taut
