#include "core/model/text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>

namespace taut {

namespace {

std::string formatted_as(double value, std::chars_format format, int digits) {
  // The longest is -DBL_MAX with decimals.
  std::string text(
      static_cast<std::size_t>(std::numeric_limits<double>::max_exponent10 + digits + 9), '\0');
  text.resize(static_cast<std::size_t>(
      std::to_chars(text.data(), text.data() + text.size(), value, format, digits).ptr -
      text.data()));
  return text;
}

}  // namespace

std::string printable(std::string_view text, std::size_t most) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto at = [&](std::size_t k) -> unsigned {
      return k < text.size() ? static_cast<unsigned char>(text[k]) : 0U;
    };
    const unsigned c = at(i);
    if (out.size() >= most && (c & 0xC0U) != 0x80) return out + "...";
    const bool two = c == 0xC2 && at(i + 1) >= 0x80 && at(i + 1) < 0xA0;  // U+0080 to U+009F
    const bool one = (c < 0x20 && c != '\t' && c != '\n') || c == 0x7f;
    out += one || two ? '?' : text[i];
    if (two) ++i;
  }
  return out;
}

std::optional<double> take_number(std::string_view& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

std::string general(double value, int digits) {
  return formatted_as(value, std::chars_format::general, digits);
}

std::string decimal(double value, int decimals) {
  return formatted_as(value, std::chars_format::fixed, decimals);
}

std::string scientific(double value, int decimals) {
  return formatted_as(value, std::chars_format::scientific, decimals);
}

double rounded_to(double value, int digits) { return *whole<double>(general(value, digits)); }

std::string shortest(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

std::string as_typed(double value) {
  std::string text = shortest(value == 0 ? 0 : value);
  const auto exponent = text.find('e');
  if (exponent == text.npos) return text;
  if (text[exponent + 1] == '+') text.erase(exponent + 1, 1);
  const auto digits = text.find_first_of("0123456789", exponent);
  if (text[digits] == '0') text.erase(digits, 1);
  return text;
}

std::string percent(double share) { return as_typed(std::round(1e8 * share) / 1e6) + " %"; }

std::string_view lasting(std::string text) {
  static auto& all = *new std::deque<std::string>;  // tables point into it until the very end
  return all.emplace_back(std::move(text));
}

std::vector<std::string> parts_of(std::string_view list, char separator) {
  std::vector<std::string> all;
  while (!list.empty()) {
    const std::size_t end = std::min(list.find(separator), list.size());
    all.emplace_back(list.substr(0, end));
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  return all;
}

}  // namespace taut
