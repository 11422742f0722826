// Statistics of timings: the differences that may be claimed on a noisy machine.
#include "experiments/timing/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <random>

#include "tests/support/recorded_samples.hpp"

namespace taut::statistics_test {
namespace {

/// Shared machine: log-normal noise, a slow drift of its speed, and occasional bursts.
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

// The median of a resample of n (odd) samples is at most the k-th smallest sample iff at least half
// of its draws are. Each draw is with probability k/n, so that the ends of the interval are known
// order statistics.
TEST(Statistics, TheIntervalEndsAtOrderStatistics) {
  const auto at_most = [](int n, int k) {  // P(median <= k-th smallest)
    double p = 0;
    for (int j = (n + 1) / 2; j <= n; ++j)
      p += std::exp(std::lgamma(n + 1) - std::lgamma(j + 1) - std::lgamma(n - j + 1) +
                    j * std::log(1.0 * k / n) +
                    (k < n   ? (n - j) * std::log1p(-1.0 * k / n)
                     : j < n ? -1e9
                             : 0));
    return p;
  };
  for (const int n : {3, 9, 15, 25, 61})
    for (const double confidence : {0.5, 0.8, 0.9, 0.95, 0.99}) {
      std::vector<double> samples;
      for (int i = 0; i < n; ++i) samples.push_back(i * 37 % n + 1);  // 1 ... n in irregular order
      const double tail = (1 - confidence) / 2, doubt = 4 * std::sqrt(tail * (1 - tail) / 2000);
      const auto end = [&](double q) {
        int k = 1;
        while (at_most(n, k) < q) ++k;
        return k;
      };
      const Interval is = bootstrap_median(samples, confidence, 7);
      EXPECT_GE(is.low, end(std::max(0.0, tail - doubt))) << n << ' ' << confidence;
      EXPECT_LE(is.low, end(tail + doubt)) << n << ' ' << confidence;
      EXPECT_GE(is.high, end(1 - tail - doubt)) << n << ' ' << confidence;
      EXPECT_LE(is.high, end(std::min(1 - 1e-9, 1 - tail + doubt))) << n << ' ' << confidence;
      EXPECT_EQ(is.mid, (n + 1) / 2);
    }
  const Interval one = bootstrap_median(std::vector{4.0});
  EXPECT_EQ(one.low, 4);
  EXPECT_EQ(one.high, 4);
}

TEST(Statistics, ARatioIsThatOfTheBlocks) {
  // three blocks of ratios 2, 3 and 8; the machine has another speed in each
  const Interval ratio = interleaved_ratio(std::vector{2.0, 4.0, 20.0, 40.0, 1.5, 0.5},
                                           std::vector{1.0, 2.0, 8.0, 12.0, 0.2, 0.05});
  EXPECT_NEAR(ratio.mid, 3, 1e-12);
  EXPECT_NEAR(ratio.low, 2, 1e-12);
  EXPECT_NEAR(ratio.high, 8, 1e-12);
  EXPECT_NEAR(spread({0.9, 1, 1.05}), 1 / 0.9 - 1, 1e-12);
  EXPECT_NEAR(spread({0.98, 1, 1.05}), 0.05, 1e-12);
  const Interval quiet{0.99, 1, 1.01};
  EXPECT_EQ(judge({1.06, 1.08, 1.2}, quiet, 0.05), Certainty::clear);
  EXPECT_EQ(judge({1.02, 1.06, 1.2}, quiet, 0.05), Certainty::likely);
  EXPECT_EQ(judge({1.02, 1.04, 1.2}, quiet, 0.05), Certainty::none) << "within the tolerance";
  EXPECT_EQ(judge({0.99, 1.06, 1.2}, quiet, 0.05), Certainty::none) << "1 is within";
  EXPECT_EQ(judge({1, 1.06, 1.2}, quiet, 0.05), Certainty::none);
  EXPECT_EQ(judge({0.8, 1 / 1.07, 1 / 1.06}, quiet, 0.05), Certainty::clear);
  EXPECT_EQ(judge({0.8, 1 / 1.06, 0.99}, quiet, 0.05), Certainty::likely);
  EXPECT_EQ(judge({0.8, 1 / 1.04, 0.99}, quiet, 0.05), Certainty::none);
  EXPECT_EQ(judge({1.5, 2, 3}, {0.96, 1, 1.045}, 0.05), Certainty::clear);
  EXPECT_EQ(judge({1.5, 2, 3}, {0.94, 1, 1}, 0.05), Certainty::likely) << "identical code differed";
  EXPECT_EQ(judge({1.02, 1.06, 1.2}, {0.92, 1, 1}, 0.05), Certainty::too_noisy);
}

TEST(Statistics, EveryCertaintyHasItsWord) {
  std::string words;
  for (const Certainty c : {Certainty::clear, Certainty::likely, Certainty::too_noisy,
                            Certainty::none, Certainty::single_run, Certainty::unopposed})
    words += std::string(to_string(c)) + (is_difference(c) ? "! " : ". ");
  EXPECT_EQ(words, "clear! likely! too noisy. no difference. single run. unopposed. ");
  EXPECT_TRUE(same_within(0.05, {0.96, 1, 1.049}));
  EXPECT_FALSE(same_within(0.05, {0.95, 1, 1.02})) << "1/0.95 is more than 5 % apart";
  EXPECT_FALSE(same_within(0.05, {0.99, 1, 1.051}));
}

// Meaning of 95 %: the interval misses the true median in about one of twenty samples, equally
// often on both sides. The noise is as skewed as that of timings.
TEST(Statistics, TheIntervalHoldsTheTrueMedianAsOftenAsItSays) {
  std::mt19937 random(5);
  std::normal_distribution<> normal;
  const auto missed = [&](double confidence) {
    int low = 0, high = 0;
    for (int trial = 0; trial < 400; ++trial) {
      std::vector<double> samples;
      for (int i = 0; i < 25; ++i) samples.push_back(std::exp(0.5 * normal(random)));  // median 1
      const Interval interval = bootstrap_median(samples, confidence);
      low += interval.high < 1;
      high += interval.low > 1;
    }
    EXPECT_LT(std::abs(low - high), 40);
    return (low + high) / 400.0;
  };
  EXPECT_NEAR(missed(0.95), 0.05, 0.025);
  EXPECT_NEAR(missed(0.5), 0.5, 0.08);
}

TEST(Statistics, AnAaComparisonIsNeverADifference) {
  int declared = 0, noisy = 0;
  for (unsigned bench = 0; bench < 100; ++bench) {
    NoisyMachine machine(bench);
    const Samples control = interleave(machine, 1, 1, 20), pair = interleave(machine, 1, 1, 20);
    declared += is_difference(
        judge(interleaved_ratio(pair.a, pair.b), interleaved_ratio(control.a, control.b)));
    noisy += spread(interleaved_ratio(control.a, control.b)) > kTolerance;
  }
  EXPECT_EQ(declared, 0);
  EXPECT_LT(noisy, 30);  // most of these machines are quiet enough to judge
}

/// Bench of identical code, from samples recorded on a busy machine. Four neighbouring sample sets
/// of one session serve: two as the control, two as the pair. The second of the pair costs `factor`
/// times as much.
Certainty recorded_bench(std::size_t first, double factor) {
  const auto samples = [](std::size_t row, double cost) {
    std::vector<double> out;
    for (const int value : kRecorded[row]) out.push_back(cost * value);
    return out;
  };
  return judge(interleaved_ratio(samples(first + 2, factor), samples(first + 3, 1)),
               interleaved_ratio(samples(first, 1), samples(first + 1, 1)));
}

TEST(Statistics, RecordedSamplesOfOneCodeAreNoDifference) {
  int benches = 0, declared = 0, seen = 0;
  for (std::size_t first = 0; first + 3 < std::size(kRecorded); ++first) {
    ++benches;
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

TEST(Statistics, TwoSessionsAgreeAtAnotherSpeed) {
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
    a.push_back(speed(0));
    b.push_back(speed(1));
    b.push_back(speed(2));
    a.push_back(speed(3));
  }
  EXPECT_NEAR(interleaved_ratio(a, b).mid, 1, 1e-12);
}

}  // namespace
}  // namespace taut::statistics_test
