// Statistics of timings: what may be called a difference on a noisy machine.
#include "experiments/timing/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <random>

#include "tests/support/recorded_samples.hpp"

namespace taut {
namespace {

/// A machine shared with others: log-normal noise, a slow drift of its speed and now and then a
/// burst.
class NoisyMachine {
 public:
  explicit NoisyMachine(unsigned seed) : random_(seed) {}
  double time(double cost) {
    speed_ = 0.98 * speed_ + 0.02 * normal_(random_);
    const double burst = uniform_(random_) < 0.05 ? 1 + uniform_(random_) : 1;
    return cost * burst * std::exp(0.1 * speed_ + 0.01 * normal_(random_));
  }

 private:
  std::mt19937 random_;
  std::normal_distribution<> normal_;
  std::uniform_real_distribution<> uniform_;
  double speed_ = 0;
};

struct Samples {
  std::vector<double> a, b;
};

Samples interleave(NoisyMachine& machine, double cost_a, double cost_b, int blocks) {
  Samples s;
  for (int i = 0; i < blocks; ++i) {
    s.a.push_back(machine.time(cost_a));
    s.b.push_back(machine.time(cost_b));
    s.b.push_back(machine.time(cost_b));
    s.a.push_back(machine.time(cost_a));
  }
  return s;
}

TEST(Statistics, TheMedianOfAnEvenCountIsTheMeanOfTheMiddleTwo) {
  EXPECT_EQ(median(std::vector{3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(median(std::vector{4.0, 1.0, 2.0, 3.0}), 2.5);
  EXPECT_TRUE(std::isnan(median({})));
}

TEST(Statistics, TheIntervalIsSeededAndShrinksWithSamples) {
  NoisyMachine machine(3);
  std::vector<double> few, many;
  for (int i = 0; i < 10; ++i) few.push_back(machine.time(1));
  for (int i = 0; i < 1000; ++i) many.push_back(machine.time(1));
  const Interval wide = bootstrap_median(few), narrow = bootstrap_median(many),
                 again = bootstrap_median(many);
  EXPECT_LT(narrow.high - narrow.low, wide.high - wide.low);
  EXPECT_EQ(narrow.low, again.low);
  EXPECT_TRUE(narrow.contains(narrow.mid));
}

// What 95 % means: the interval misses the true median in about one of twenty samples, on each side
// alike. The noise is skewed, as that of timings is.
TEST(Statistics, TheIntervalHoldsTheTrueMedianAsOftenAsItSays) {
  std::mt19937 random(5);
  std::normal_distribution<> normal;
  const auto missed = [&](double confidence) {
    int low = 0, high = 0;
    for (int trial = 0; trial < 400; ++trial) {
      std::vector<double> samples;
      for (int i = 0; i < 25; ++i) samples.push_back(std::exp(0.5 * normal(random)));  // median 1
      const Interval interval = bootstrap_median(samples, confidence);
      low += interval.high<1, high += interval.low> 1;
    }
    EXPECT_LT(std::abs(low - high), 40);
    return (low + high) / 400.0;
  };
  EXPECT_NEAR(missed(0.95), 0.05, 0.025);
  EXPECT_NEAR(missed(0.5), 0.5, 0.08);
}

TEST(Statistics, AnAaComparisonIsNeverADifferenceInAHundredBenches) {
  int declared = 0, noisy = 0;
  for (unsigned bench = 0; bench < 100; ++bench) {
    NoisyMachine machine(bench);
    const Samples control = interleave(machine, 1, 1, 20), pair = interleave(machine, 1, 1, 20);
    declared += is_difference(
        judge(interleaved_ratio(pair.a, pair.b), interleaved_ratio(control.a, control.b)));
    noisy += spread(interleaved_ratio(control.a, control.b)) > kTolerance;
  }
  EXPECT_EQ(declared, 0);
  EXPECT_LT(noisy, 30);  // most of these machines are still good enough to judge
}

/// A bench of one code against itself from samples that a busy machine gave: four neighbours of one
/// session, two as the control, two as the pair, the second of which costs `factor` times as much.
Certainty recorded_bench(std::size_t first, double factor) {
  const auto samples = [](std::size_t row, double cost) {
    std::vector<double> out;
    for (const int value : kRecorded[row]) out.push_back(cost * value);
    return out;
  };
  return judge(interleaved_ratio(samples(first + 2, factor), samples(first + 3, 1)),
               interleaved_ratio(samples(first, 1), samples(first + 1, 1)));
}

TEST(Statistics, RecordedSamplesOfOneCodeAreNeverADifferenceButATwofoldCostIs) {
  int benches = 0, clear = 0, declared = 0, seen = 0;
  for (std::size_t first = 0; first + 3 < std::size(kRecorded); ++first) {
    ++benches;
    clear += recorded_bench(first, 1) == Certainty::clear;
    declared += is_difference(recorded_bench(first, 1));
    seen += recorded_bench(first, 2) == Certainty::clear;
  }
  EXPECT_GE(benches, 100);
  EXPECT_EQ(declared, 0);
  EXPECT_GE(seen, 10) << "of benches quiet enough to judge: the machine was busy";
}

TEST(Statistics, ATwentyPercentChangeIsSeenDespiteTheNoise) {
  int slower = 0, faster = 0;
  for (unsigned bench = 0; bench < 100; ++bench) {
    NoisyMachine machine(bench);
    const Samples control = interleave(machine, 1, 1, 20), pair = interleave(machine, 1.2, 1, 20);
    const Interval ratio = interleaved_ratio(pair.a, pair.b);
    const bool told = is_difference(judge(ratio, interleaved_ratio(control.a, control.b)));
    slower += told && ratio.mid > 1;
    faster += told && ratio.mid < 1;
  }
  EXPECT_GE(slower, 70);
  EXPECT_EQ(faster, 0);
}

TEST(Statistics, TwoSessionsAgreeThoughTheMachineRunsAtAnotherSpeed) {
  int overlapping = 0, apart = 0;
  for (unsigned k = 0; k < 50; ++k) {
    const auto session = [](unsigned seed, double factor, double speed) {
      NoisyMachine machine(seed);
      const Samples s = interleave(machine, factor * speed, speed, 20);
      return interleaved_ratio(s.a, s.b);
    };
    const auto overlap = [](const Interval& a, const Interval& b) {
      return a.low <= b.high && b.low <= a.high;
    };
    overlapping += overlap(session(2 * k, 3, 1), session(2 * k + 1, 3, 1.7));
    apart += !overlap(session(2 * k, 3, 1), session(2 * k + 1, 3.6, 1));
  }
  EXPECT_GE(overlapping, 45);
  EXPECT_GE(apart, 45) << "a fifth more is seen";
}

TEST(Statistics, ALinearDriftCancelsInsideABlock) {
  std::vector<double> a, b;
  for (int i = 0; i < 80; i += 4) {
    const auto speed = [&](int k) { return 1 + 0.01 * (i + k); };
    a.push_back(speed(0)), b.push_back(speed(1)), b.push_back(speed(2)), a.push_back(speed(3));
  }
  EXPECT_NEAR(interleaved_ratio(a, b).mid, 1, 1e-12);
}

}  // namespace
}  // namespace taut
