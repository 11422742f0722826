// `taut bench kernels` and `contact` on small sheets: what is timed, what is counted of it, and
// what no machine can be faster than.
#include <gtest/gtest.h>

#include "core/solver/simd/kernels.hpp"
#include "experiments/timing/bench/contact.hpp"
#include "experiments/timing/bench/kernels.hpp"
#include "tests/support/cloths.hpp"

namespace taut::bench_kernels_test {
namespace {

bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

TEST(BenchKernels, CountWhatAProjectionComputesAndMoves) {
  std::vector<std::size_t> told;
  const KernelBench bench = bench_kernels({.side = 17,
                                           .rounds = 2,
                                           .seconds = 2e-4,
                                           .bullet = true,
                                           .progress = [&](std::size_t done, std::size_t all) {
                                             EXPECT_EQ(all, 2u);
                                             told.push_back(done);
                                           }});
  EXPECT_EQ(told, (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(bench.side, 17);
  EXPECT_EQ(bench.rows[0].name, "textbook, float");
  EXPECT_EQ(bench.rows[1].name, "textbook, double");
  int threaded = 0, interleaved = 0, bullet = 0;
  for (const KernelRow& row : bench.rows) {
    SCOPED_TRACE(row.name);
    const bool single = has(row.name, "float");
    const int word = single ? 4 : 8;
    // Two particles are read and written: three numbers each, or four with their padding. A list
    // has two numbers of vertices and a rest length for each link.
    if (has(row.name, "textbook")) {
      EXPECT_EQ(row.bytes, 15 * word + 8);  // two weights and a rest length besides
      EXPECT_EQ(row.flops, 27);
    } else if (has(row.name, "bullet")) {
      EXPECT_EQ(row.bytes, 19 * word);
      EXPECT_EQ(row.flops, 27);
      ++bullet;
    } else {
      EXPECT_EQ(row.bytes, has(row.name, "interleaved") ? 12 * word : 16 * word + 8 + word);
      EXPECT_EQ(row.flops, has(row.name, "exact") ? 22 : 21);
    }
    EXPECT_EQ(row.threads, has(row.name, "threads=2") ? 2 : 1);
    threaded += row.threads == 2, interleaved += has(row.name, "interleaved");
    EXPECT_NEAR(row.floor, 1e9 * seconds_per_flop(single) * row.flops / row.threads,
                0.4 * row.floor);
    EXPECT_EQ(row.samples.size(), 2u);
    EXPECT_EQ(row.fixed.size(), 2u);
    if (row.threads > 1) continue;  // by the wall's clock
    EXPECT_GT(row.fastest, 0.5 * row.floor) << "no code is faster than its additions";
    EXPECT_LT(row.fastest, 1e4) << "ns";
  }
  EXPECT_EQ(threaded, 2);
  EXPECT_EQ(interleaved, widest() == Simd::avx512 ? 6 : 5);
  EXPECT_EQ(bullet, 1) << "this program has Bullet in double";
  for (const Interval& speed : {bench.two_cores.unrelated(), bench.two_cores.threads()}) {
    EXPECT_GT(speed.mid, 0.05) << "of one thread, on a busy machine";
    EXPECT_LT(speed.mid, 4);
  }
  EXPECT_EQ(bench.two_cores.rounds(), 20u) << "ten in the place of each";
}

TEST(BenchKernels, ThePeakRateFollowsFromTheWidthOfAVector) {
  const int bytes = widest() == Simd::avx512 ? 64 : widest() == Simd::avx2 ? 32 : 16;
  for (const bool single : {true, false}) {
    const double lanes = bytes / (single ? 4.0 : 8.0), rate = 1 / seconds_per_flop(single) / lanes;
    EXPECT_GT(rate, 1e6) << "vectors a second, of code that is not optimized, on a busy machine";
    EXPECT_LT(rate, 4 * 7e9) << "no core makes more than four in a cycle";
    EXPECT_GT(seconds_per_projection(single), 1e-11);
    EXPECT_LT(seconds_per_projection(single), 1e-6);
  }
  const double twice = seconds_per_flop(false) / seconds_per_flop(true);
  EXPECT_GT(twice, 1.3) << "half as many doubles in a vector";
  EXPECT_LT(twice, 3);
  // By links: a sheet of four times as many costs as much each.
  const double small = seconds_per_link_traffic(hanging_sheet(24, 24), true),
               large = seconds_per_link_traffic(hanging_sheet(48, 48), true);
  EXPECT_GT(large / small, 0.4);
  EXPECT_LT(large / small, 2.5);
  EXPECT_GT(small, 1e-10);
  EXPECT_LT(small, 1e-6);
}

TEST(BenchKernels, AWordTakesTimeFromThreadToThread) {
  const double seconds = seconds_per_handover();
  EXPECT_GT(seconds, 5e-9);  // more than from a cache of the same core
  EXPECT_LT(seconds, 1e-2);
}

// A cloth that has lain down for 0.75 s touches the floor with every vertex, and what is dearer
// costs more: ABBA over two rounds.
TEST(BenchContact, StartsFromAClothThatLiesOnWhatItFellOn) {
  const auto rows = bench_contact({.side = 17, .rounds = 2, .seconds = 1e-4});
  ASSERT_EQ(rows.size(), 3u * 6 + 2 * 5);
  std::size_t k = 0;
  for (const ContactRow& row : rows) {
    SCOPED_TRACE(row.scene + " " + row.setting);
    EXPECT_EQ(row.particles, 17u * 17);
    for (const auto* all : {&row.sweep, &row.each_sweep, &row.each_step, &row.bare})
      EXPECT_EQ(all->size(), 2u);
    EXPECT_GT(median(row.sweep), 0.1) << "ns";
    EXPECT_LT(median(row.sweep), 1000);
    if (row.scene == "plane") {
      EXPECT_GT(row.touching, 0.9);
    }
    if (row.scene == "ball" || row.scene == "box") {
      EXPECT_GT(row.touching, 0.02);
      EXPECT_LT(row.touching, 0.9);
    }
    const bool crumple = row.scene.starts_with("crumple");
    EXPECT_EQ(crumple, k >= 18);
    EXPECT_EQ(row.steps, !crumple || (k - 18) % 5 % 2 == 1 ? crumple ? 8 : 4 : 1);
    ++k;
  }
  EXPECT_EQ(rows[18].scene, "crumple, 0.3 s");
  EXPECT_EQ(rows[23].scene, "crumple, 0.6 s");
  EXPECT_EQ(rows[22].setting, "self=octree,order=mesh");
}

}  // namespace
}  // namespace taut::bench_kernels_test
