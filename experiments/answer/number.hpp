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
/// [low, mid, high]: found by the JSON library, wherever an interval becomes JSON.
template <class Json>
void to_json(Json& json, const Interval& i) {
  json = {i.low, i.mid, i.high};
}

/// Units beside those of metrics.
inline constexpr Unit kMilliseconds{"s", "ms", 1e3}, kNanoseconds{"s", "ns", 1e9},
    kBytes{"B", "B", 1, false}, kKilobytes{"B", "kB", 1e-3}, kMegabytes{"B", "MB", 1e-6};

/// That of a metric's value.
inline Unit unit_of_value(std::string_view name) {
  const ValueSpec* spec = find_value(name).second;
  return spec ? spec->unit : kNumber;
}

// How a number becomes text, everywhere.

/// So many significant digits at most, no exponent between 1e-4 and 1e6: 0.01234 -> "0.0123",
/// 20 -> "20", 3.4e-13 -> "3.4e-13"; "-": NaN.
std::string number_text(double value, int digits = 3);
/// "2.3 (2.1 to 2.5)", of an interval in SI shown in this unit.
std::string interval_text(const Interval&, const Unit& = kNumber, int digits = 3);
/// In the unit that people are shown, with its name: "1.2 %", "0.31 mm"; whole numbers without a
/// unit have all their digits.
std::string number_text(double si, const Unit&, int digits = 3);
/// "12:05", minutes and seconds.
std::string clock_text(double seconds);

/// The same for print, with the signs that a keyboard lacks and as many zeros as there are digits:
/// 22.04 -> "22", 3.4e-13 -> "3.4×10⁻¹³". NaN and infinities are "–" and "∞".
std::string significant(double value, int digits = 2);
/// Of an exponent as typed, of any length: "-09" -> "10⁻⁹".
std::string power_of_ten(std::string_view exponent);
/// So many decimals: -0.934 -> "−0.93"; never "−0.00".
std::string fixed(double value, int decimals);
/// The decimals that a value deserves whose uncertainty spans `width`: one digit of it, two where
/// the first is below 3; at most six.
int decimals_for(double width);
/// Every bit, shortest form: for data files. NaN is "".
std::string exact(double value);
/// "1.2 %", "0.31 mm", with a space that does not break: for prose and tables of the page.
std::string shown(const Unit&, double si, int digits = 2);

}  // namespace taut
