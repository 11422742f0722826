// `taut bench effects`: what is timed together.
#include "experiments/timing/bench/effects.hpp"

#include <gtest/gtest.h>

namespace taut::effects_test {
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
  EXPECT_TRUE(rows[1].traffic.empty());
  ASSERT_EQ(rows[2].traffic.size(), rows[2].whole.size());
  EXPECT_LT(interleaved_ratio(rows[2].traffic, rows[2].bare).mid, 1);
  EXPECT_GT(interleaved_ratio(rows[2].traffic, rows[0].whole).mid, 0.5);
}

}  // namespace
}  // namespace taut::effects_test
