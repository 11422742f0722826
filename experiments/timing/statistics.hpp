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

/// Median with a percentile-bootstrap confidence interval (Efron & Tibshirani 1993, section 13.3),
/// 2000 resamples, seeded: the same samples give the same interval. One sample gives an interval of
/// no width.
Interval bootstrap_median(std::span<const double> samples, double confidence = 0.95,
                          std::uint64_t seed = 1);

/// Cost of A over cost of B from samples taken in the order A B B A, A B B A, ...: a and b hold two
/// samples of each block, in order. A linear drift of the machine's speed cancels inside a block;
/// the interval is over blocks.
Interval interleaved_ratio(std::span<const double> a, std::span<const double> b,
                           double confidence = 0.95, std::uint64_t seed = 1);

/// The exponent of a fit, two standard errors to either side.
inline Interval interval_of_exponent(const PowerLaw& law) {
  return {law.exponent - 2 * law.error, law.exponent, law.exponent + 2 * law.error};
}

/// Relative differences below this do not count.
inline constexpr double kTolerance = 0.05;

/// How far the ratio of a code to itself lies from 1, as a share: 0.03 for 0.98 to 1.03.
double spread(const Interval& control);

/// How sure a comparison is; of several the last is the least sure.
enum class Certainty {
  clear,       ///< the whole interval is beyond the tolerance and beyond what identical code showed
  likely,      ///< the interval excludes 1 and its middle is beyond both
  too_noisy,   ///< identical code differed from itself by more
  none,        ///< no difference that can be told
  single_run,  ///< computed, not timed: the same bits on every run, no spread known
  unopposed    ///< there is nothing to compare with
};
/// "clear", "too noisy", "no difference", ...
std::string_view to_string(Certainty);

/// How sure a ratio of costs is, given the ratio of identical code to itself: `clear` or `likely`
/// a difference of more than the tolerance, which way the ratio's middle says; `too_noisy`; `none`.
Certainty judge(const Interval& ratio, const Interval& control, double tolerance = kTolerance);
/// Whether the whole interval is beyond the tolerance and beyond what identical code showed: what
/// an alarm of one among many comparisons rests on.
bool beyond_both(const Interval& ratio, const Interval& control, double tolerance = kTolerance);
/// `clear` or `likely`.
inline bool is_difference(Certainty c) { return c <= Certainty::likely; }
/// Whether the whole interval is within the tolerance of 1.
bool same_within(double tolerance, const Interval& ratio);

}  // namespace taut
