// The price of an error: who is said to be cheaper, by how much, and when nobody is.
#include "experiments/report/price.hpp"

#include <gtest/gtest.h>

#include <iterator>

#include "experiments/report/comparison.hpp"
#include "experiments/report/figures.hpp"
#include "tests/support/recorded_samples.hpp"

namespace taut::report {
namespace {

/// A case that reaches `stretch` at `cost` CPU s per simulated s, its samples alternating by
/// +- `noise`.
BenchedCase timed(const std::string& scene, const std::string& solver, double stretch, double cost,
                  double noise = 0.01) {
  BenchedCase c;
  c.record.scene = scene, c.record.solver = solver, c.record.dt = 0.5;
  c.record.spec = {scene, {}, solver};
  c.record.id = scene + " " + solver;
  c.record.key = c.record.id;
  c.record.params = {{"iterations", "16"}};
  c.record.values["stretch.rms"] = stretch;
  for (int block = 0; block < 8; ++block)
    for (int half = 0; half < 2; ++half)
      c.timing.samples.push_back(cost / 2 * (1 + (block % 2 == 0 ? noise : -noise)));
  return c;
}

BenchSession session() {
  const Interval quiet{0.99, 1, 1.01};
  return {
      "trade",
      "a machine",
      {{"hang", quiet, {timed("hang", "jakobsen", 5e-3, 1), timed("hang", "bullet", 5e-3, 4)}},
       {"ball", quiet, {timed("ball", "jakobsen", 5e-3, 1), timed("ball", "bullet", 5e-3, 9)}}}};
}

std::string sentence(const BenchSession& bench) {
  ReportInput input;
  StudyResult study{"s", "?", {}, 0, {}};
  for (const std::string solver : {"jakobsen", "bullet"})
    study.records.push_back(timed("hang", solver, 5e-3, 1).record);
  input.studies = {study};
  input.bench = bench;
  return price_verdict(compare(input));
}

TEST(Price, TheMeanOverScenesIsGeometricAndSoIsItsInterval) {
  const Interval mean = geometric_mean({{3, 4, 5}, {8, 9, 10}});
  EXPECT_NEAR(mean.mid, 6, 1e-12);
  EXPECT_GT(mean.low, 5);
  EXPECT_LT(mean.high, 7.1);
  const Interval alone = geometric_mean({{3, 4, 5}});
  EXPECT_NEAR(alone.low, 3, 1e-12);
  EXPECT_NEAR(alone.high, 5, 1e-12);
}

TEST(Price, EachSceneHasItsFactorAndTheMeanIsOverThoseBothReach) {
  BenchSession bench = session();
  bench.scenes.push_back({"box",
                          {0.99, 1, 1.01},
                          {timed("box", "jakobsen", 5e-3, 1), timed("box", "bullet", 0.02, 1)}});
  const Price price = compare_price(bench, "jakobsen", "bullet");
  ASSERT_EQ(price.scenes.size(), 3U);
  EXPECT_NEAR(price.scenes[0].ratio->mid, 4, 1e-9);
  EXPECT_TRUE(price.scenes[2].other_ran);
  EXPECT_FALSE(price.scenes[2].other) << "2 % is not 1 %";
  EXPECT_NEAR(price.mean->mid, 6, 1e-9);
  EXPECT_NEAR(price.other_cost / price.first_cost, 6, 1e-9);
}

TEST(Price, AFastExplosionNeverBuysTheError) {
  BenchSession bench = session();
  bench.scenes[0].cases[1].record.status = {Status::Kind::exploded, "nonfinite", 3, 0};
  const Price price = compare_price(bench, "jakobsen", "bullet");
  EXPECT_FALSE(price.scenes[0].other);
}

TEST(Price, ADifferenceExceedsTheToleranceAndTheNoise) {
  EXPECT_TRUE(is_significant({1.2, 1.3, 1.4}, {0.98, 1, 1.02}));
  EXPECT_FALSE(is_significant({0.9, 1.3, 1.4}, {0.98, 1, 1.02})) << "the interval holds 1";
  EXPECT_FALSE(is_significant({1.01, 1.03, 1.04}, {1, 1, 1})) << "below 5 %";
  EXPECT_FALSE(is_significant({1.2, 1.3, 1.4}, {0.7, 1, 1.1})) << "the same code strays by 43 %";
  EXPECT_TRUE(is_significant({3.5, 4, 4.5}, {0.7, 1, 1.1})) << "a factor of four is more than that";
}

/// is_significant() does not fall silent on a noisy machine, so it has more to prove than
/// diagnostics().
TEST(Price, RecordedSamplesOfOneCodeAreNotToldApartButATwofoldCostIs) {
  const auto samples = [](std::size_t row, double cost) {
    std::vector<double> out;
    for (const int value : kRecorded[row]) out.push_back(cost * value);
    return out;
  };
  int benches = 0, same = 0, twice = 0;
  for (std::size_t k = 0; k + 3 < std::size(kRecorded); ++k, ++benches) {
    const Interval control = interleaved_ratio(samples(k, 1), samples(k + 1, 1));
    const auto apart = [&](double factor) {
      return is_significant(interleaved_ratio(samples(k + 2, factor), samples(k + 3, 1)), control);
    };
    same += apart(1), twice += apart(2);
  }
  EXPECT_GE(benches, 100);
  EXPECT_EQ(same, 0);
  EXPECT_GE(twice, 100);
}

TEST(PriceVerdict, NamesWinnerFactorIntervalAndExtremes) {
  const std::string text = sentence(session());
  EXPECT_NE(text.find(">Jakobsen</b> needs <b>6.0 times less CPU time</b>"), std::string::npos)
      << text;
  EXPECT_NE(text.find("95 % interval"), std::string::npos) << text;
  EXPECT_NE(text.find("from 4.0 on hang to 9.0 on ball"), std::string::npos) << text;
}

TEST(PriceVerdict, TheOtherMayWinTieOrNeverArrive) {
  BenchSession bench = session();
  bench.scenes[0].cases[1] = timed("hang", "bullet", 5e-3, 0.5);
  bench.scenes[1].cases[1] = timed("ball", "bullet", 5e-3, 1.01);
  std::string text = sentence(bench);
  EXPECT_NE(text.find(">Bullet</b> needs <b>2.0 times less CPU time</b>"), std::string::npos)
      << text;
  EXPECT_NE(text.find("no difference can be told on ball"), std::string::npos) << text;
  bench.scenes[0].cases.pop_back();
  bench.scenes[1].cases[1] = timed("ball", "bullet", 0.5, 1);
  text = sentence(bench);
  EXPECT_NE(text.find("</b> reaches it on ball"), std::string::npos) << text;
  EXPECT_NE(text.find("cannot run hang"), std::string::npos) << text;
  EXPECT_EQ(text.find("less CPU time"), std::string::npos) << "nothing to compare";
}

}  // namespace
}  // namespace taut::report
