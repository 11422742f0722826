// `taut bench effects`: what is timed together.
#include "experiments/timing/bench/effects.hpp"

#include <gtest/gtest.h>

namespace taut::effects_test {
namespace {

TEST(BenchEffects, EveryCopyMakesEveryStep) {
  const auto rows = bench_effects({.scenes = {"hang"},
                                   .solver = "jakobsen:iterations=1,substeps=15",
                                   .side = 24,
                                   .copies = 16,
                                   .rounds = 5,
                                   .seconds = 0.001});
  ASSERT_EQ(rows.size(), 1u);
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
  const auto rows = bench_effects({.scenes = {"hang", "crumple"},
                                   .solver = "jakobsen:iterations=1,substeps=2",
                                   .side = 92,  // so fine that threads share it
                                   .two_threads = true,
                                   .rounds = 2,
                                   .seconds = 0.001});
  ASSERT_EQ(rows.size(), 2u);
  for (const EffectRow& row : rows) {
    EXPECT_EQ(row.refused, "");
    EXPECT_EQ(row.two_cores.rounds(), 4u);
    EXPECT_TRUE(row.whole.empty());
    EXPECT_GT(row.two_cores.threads().low, 0.05) << "of one thread, on a busy machine";
    EXPECT_LT(row.two_cores.unrelated().mid, 4) << "each sheet makes every step";
    EXPECT_LT(row.two_cores.threads().mid, 4);
  }
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
