#pragma once

#include <charconv>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace taut {

/// External text made safe for a terminal: each control character except tab and line feed becomes
/// '?', and anything beyond `most` bytes becomes "...". The text of every Diagnostic is printable.
std::string printable(std::string_view, std::size_t most = 2000);

// Numbers from and to text, in every locale alike: a program that embeds this library may have set
// one with a decimal comma. tests/source/numbers_test.py bans the ways that know locales.

/// The number that a whole text is, including "nan" and "inf"; empty if it is not a number.
template <class T>
std::optional<T> whole(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// The number with which a text begins, which is removed from it; empty if it begins with none.
std::optional<double> take_number(std::string_view& text);

/// The texts that printf() has of "%.*g", "%.*f" and "%.*e" in the locale "C".
std::string general(double value, int digits);
std::string decimal(double value, int decimals);
std::string scientific(double value, int decimals);

/// The number that general() shows.
double rounded_to(double value, int digits);

/// The shortest text that reads back as the same number.
std::string shortest(double value);

/// The shortest text as a person types it: 1e6 and not 1e+06, zero without a sign.
std::string as_typed(double value);

/// "5 %" for 0.05, without digits that come from rounding alone.
std::string percent(double share);

/// Keeps the text for as long as the program runs, for tables of std::string_view. So a help text
/// can take its numbers from constants.
std::string_view lasting(std::string);

/// The parts of "a|b|c".
std::vector<std::string> parts_of(std::string_view list, char separator = '|');

/// Joins the texts of all elements; text_of(element) is an element's text.
template <class All, class TextOf = std::identity>
std::string join(const All& all, std::string_view separator, const TextOf& text_of = {}) {
  std::string joined;
  bool first = true;
  for (const auto& one : all) {
    if (!first) joined += separator;
    joined += std::invoke(text_of, one);
    first = false;
  }
  return joined;
}

}  // namespace taut
