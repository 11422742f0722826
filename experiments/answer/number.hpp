#pragma once

#include <string>
#include <string_view>

#include "experiments/metrics/metric.hpp"

namespace taut {

/// An estimate with its confidence interval.
struct Interval {
  double low = 0;
  double mid = 0;
  double high = 0;
  bool contains(double value) const { return low <= value && value <= high; }
  Interval operator*(double factor) const { return {low * factor, mid * factor, high * factor}; }
  bool operator==(const Interval&) const = default;
};
/// Converts an interval to [low, mid, high]. The JSON library finds this function and calls it.
template <class Json>
void to_json(Json& json, const Interval& i) {
  json = {i.low, i.mid, i.high};
}

/// Units that no metric has.
inline constexpr Unit kMilliseconds{Unit::Kind::time, "s", "ms", 1e3},
    kNanoseconds{Unit::Kind::time, "s", "ns", 1e9}, kBytes{Unit::Kind::other, "B", "B", 1, false},
    kKilobytes{Unit::Kind::other, "B", "kB", 1e-3}, kMegabytes{Unit::Kind::other, "B", "MB", 1e-6};

/// Unit of a metric's value.
inline Unit unit_of_value(std::string_view name) {
  const ValueSpec* spec = find_value(name).second;
  return spec ? spec->unit : kNumber;
}

// Conversions of numbers to text, used everywhere.

/// At most `digits` significant digits, and no exponent between 1e-4 and 1e6: 0.01234 -> "0.0123",
/// 20 -> "20", 3.4e-13 -> "3.4e-13"; NaN -> "-".
std::string number_text(double value, int digits = 3);
/// An interval in SI, shown in this unit but without its name: "2.3 (2.1 to 2.5)".
std::string interval_text(const Interval&, const Unit& = kNumber, int digits = 3);
/// A number with the name of the unit that people are shown: "1.2 %", "0.31 mm". A whole number
/// without a unit has all its digits.
std::string number_text(double si, const Unit&, int digits = 3);
/// Minutes and seconds: "12:05".
std::string clock_text(double seconds);

/// As number_text(), but for print: with signs that a keyboard lacks, and with trailing zeros up to
/// `digits`. 22.04 -> "22", 3.4e-13 -> "3.4×10⁻¹³". NaN and infinities are "–" and "∞".
std::string significant(double value, int digits = 2);
/// Power of ten for an exponent as typed, of any length: "-09" -> "10⁻⁹".
std::string power_of_ten(std::string_view exponent);
/// A number with this many decimals: -0.934 -> "−0.93"; never "−0.00".
std::string fixed(double value, int decimals);
/// Number of decimals worth showing for a value whose uncertainty spans `width`: down to the first
/// digit of the width, or the second if the first is below 3; at most six.
int decimals_for(double width);
/// Shortest text that preserves every bit, for data files. NaN is "".
std::string exact(double value);
/// A number with its unit for prose and tables of the page: "1.2 %", "0.31 mm", with a no-break
/// space.
std::string shown(const Unit&, double si, int digits = 2);

}  // namespace taut
