#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace taut {

/// An estimate with its confidence interval.
struct Interval {
  double low = 0;
  double mid = 0;
  double high = 0;
  bool contains(double value) const { return low <= value && value <= high; }
};

/// As JSON: [low, mid, high]. Json is nlohmann's, which finds this by itself.
template <class Json>
void to_json(Json& json, const Interval& i) {
  json = {i.low, i.mid, i.high};
}

/// A number with so many significant digits ("-": NaN), and "2.3 (2.1 to 2.5)" in a unit.
std::string number_text(double value, int digits = 3);
std::string interval_text(const Interval&, double unit = 1);

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

/// Relative differences below this are none.
inline constexpr double kTolerance = 0.05;

/// How far the ratio of a code to itself lies from 1, as a share: 0.03 for 0.98 to 1.03.
double spread(const Interval& control);

/// What a ratio of costs A / B allows us to say. It is a difference if its interval excludes 1 and
/// it exceeds the tolerance (0.05: five per cent).
enum class Difference {
  none,
  faster,    ///< A costs less
  slower,    ///< A costs more
  too_noisy  ///< the control itself spreads further than the tolerance: nothing can be said
};
Difference compare_costs(const Interval& ratio, const Interval& control, double tolerance);

}  // namespace taut
