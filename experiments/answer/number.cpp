#include "experiments/answer/number.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/model/text.hpp"

namespace taut {

namespace {

constexpr std::array<const char*, 10> kRaised{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};

/// Removes trailing zeros of the decimals.
std::string stripped(std::string text) {
  if (text.find('.') == std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

/// A size rounded to `digits` digits. The exponent is taken after rounding, so that 9.96 with two
/// digits becomes "10" and not "10.0".
struct Rounded {
  std::string mantissa, plain;  ///< of 3.4e-13: "3.4", and the same number without an exponent
  int exponent = 0;

  Rounded(double size, int digits) {
    const std::string text = scientific(size, digits - 1);
    const auto e = text.find('e');
    mantissa = stripped(text.substr(0, e));
    exponent = std::stoi(text.substr(e + 1));
    plain = decimal(size, std::max(0, digits - 1 - exponent));
  }
  bool needs_exponent() const { return exponent < -4 || exponent > 5; }
};

/// Whether the number gets all its digits: it is whole, and no unit stands behind it.
bool is_whole(double value, const Unit& unit) {
  return unit.shown.empty() && value == std::round(value) && std::abs(value) < 1e15;
}

}  // namespace

std::string number_text(double value, int digits) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  if (value == 0) return "0";
  const Rounded size(std::abs(value), digits);
  return (value < 0 ? "-" : "") + (size.needs_exponent()
                                       ? size.mantissa + "e" + std::to_string(size.exponent)
                                       : stripped(size.plain));
}

std::string number_text(double si, const Unit& unit, int digits) {
  const std::string number =
      is_whole(si, unit) ? decimal(si, 0) : number_text(si * unit.scale, digits);
  return unit.shown.empty() || !std::isfinite(si) ? number : number + " " + std::string(unit.shown);
}

std::string interval_text(const Interval& i, const Unit& unit, int digits) {
  const auto one = [&](double si) { return number_text(si * unit.scale, digits); };
  return one(i.mid) + " (" + one(i.low) + " to " + one(i.high) + ")";
}

std::string clock_text(double seconds) {
  const auto of_minute = static_cast<int>(std::fmod(seconds, 60));
  return decimal(std::floor(seconds / 60), 0) + (of_minute < 10 ? ":0" : ":") +
         std::to_string(of_minute);
}

std::string power_of_ten(std::string_view exponent) {
  const auto digits = std::min(exponent.find_first_not_of("+-0"), exponent.size() - 1);
  std::string text = exponent.front() == '-' && exponent[digits] != '0' ? "10⁻" : "10";
  for (const char digit : exponent.substr(digits))
    text += kRaised[static_cast<std::size_t>(digit - '0')];
  return text;
}

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return significant(value);
  const std::string text = decimal(std::abs(value), decimals);
  const bool nothing = text.find_first_not_of("0.") == std::string::npos;
  return (value < 0 && !nothing ? "−" : "") + text;
}

int decimals_for(double width) {
  if (!(width > 0) || !std::isfinite(width)) return 6;
  const double exponent = std::floor(std::log10(width));
  const bool two = width / std::pow(10.0, exponent) < 3;
  return std::clamp(static_cast<int>(two ? 1 - exponent : -exponent), 0, 6);
}

std::string significant(double value, int digits) {
  if (std::isnan(value)) return "–";
  if (std::isinf(value)) return value > 0 ? "∞" : "−∞";
  if (value == 0) return "0";
  const Rounded size(std::abs(value), digits);
  std::string text = size.plain;
  if (size.needs_exponent())
    text = (size.mantissa == "1" ? "" : size.mantissa + "×") +
           power_of_ten(std::to_string(size.exponent));
  return (value < 0 ? "−" : "") + text;
}

std::string exact(double value) { return std::isnan(value) ? "" : shortest(value); }

std::string shown(const Unit& unit, double si, int digits) {
  const bool whole = is_whole(si, unit) && std::abs(si) < 1e7;
  const std::string number = whole ? exact(si) : significant(si * unit.scale, digits);
  return unit.shown.empty() || !std::isfinite(si) ? number
                                                  : number + "\u00A0" + std::string(unit.shown);
}

}  // namespace taut
