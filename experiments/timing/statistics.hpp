#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/reference/fit.hpp"
#include "experiments/answer/number.hpp"

namespace taut {

double median(std::span<const double>);  ///< NaN if empty

/// Median with a percentile-bootstrap confidence interval (Efron & Tibshirani 1993, section 13.3)
/// from 2000 seeded resamples: the same samples give the same interval. A single sample gives an
/// interval of zero width.
Interval bootstrap_median(std::span<const double> samples, double confidence = 0.95,
                          std::uint64_t seed = 1);

/// Cost of A relative to cost of B, from samples in the order A B B A, A B B A, ...: a and b hold
/// two samples from each block, in order. A linear drift in the machine's speed cancels within a
/// block; the bootstrap is over blocks.
Interval interleaved_ratio(std::span<const double> a, std::span<const double> b,
                           double confidence = 0.95, std::uint64_t seed = 1);

/// Fitted exponent, with two standard errors on either side.
inline Interval interval_of_exponent(const PowerLaw& law) {
  return {law.exponent - 2 * law.error, law.exponent, law.exponent + 2 * law.error};
}

/// Relative differences below this are ignored.
inline constexpr double kTolerance = 0.05;

/// How far the ratio of a code to itself deviates from 1, as a share: 0.03 for 0.98 to 1.03.
double spread(const Interval& control);

/// How certain a comparison is. The later value is the less certain one.
enum class Certainty {
  /// The whole interval is beyond the tolerance, and identical code stayed within the tolerance.
  clear,
  likely,      ///< the interval excludes 1 and its middle is beyond both
  too_noisy,   ///< identical code differed from itself by more than the difference
  none,        ///< no detectable difference
  single_run,  ///< computed, not timed: every run gives the same bits, so there is no spread
  unopposed    ///< nothing to compare with
};
/// "clear", "too noisy", "no difference", ...
std::string_view to_string(Certainty);

/// Certainty of a ratio of costs, given the ratio of identical code to itself: `clear` or `likely`
/// for a difference beyond the tolerance, whose direction the ratio's middle gives; otherwise
/// `too_noisy` or `none`.
Certainty judge(const Interval& ratio, const Interval& control, double tolerance = kTolerance);
/// Whether the whole interval is beyond both the tolerance and the deviation of identical code.
/// This is the criterion for an alarm on one of many comparisons.
bool beyond_both(const Interval& ratio, const Interval& control, double tolerance = kTolerance);
/// `clear` or `likely`.
inline bool is_difference(Certainty c) { return c <= Certainty::likely; }
/// Whether the whole interval is within the tolerance of 1.
bool same_within(double tolerance, const Interval& ratio);

}  // namespace taut
