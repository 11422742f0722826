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

TEST(BenchEffects, LookingInVainCostsLessThanContact) {
  const auto rows = bench_effects({.scenes = {"hang", "box", "disc"},
                                   .solver = "jakobsen:iterations=1,substeps=15",
                                   .rounds = 5,
                                   .seconds = 0.002});
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_TRUE(rows[0].looking.empty());
  ASSERT_EQ(rows[1].looking.size(), rows[1].whole.size());
  EXPECT_LT(interleaved_ratio(rows[1].looking, rows[1].whole).mid, 0.9);
  EXPECT_EQ(rows[1].traffic, 0);
  EXPECT_GT(rows[2].traffic, 0);
  EXPECT_LT(rows[2].traffic, bootstrap_median(rows[2].bare).mid);
}

}  // namespace
}  // namespace taut
