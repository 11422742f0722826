#include "experiments/command_line/conditions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <system_error>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/system/clock.hpp"

namespace taut {

namespace {

/// The number that a word is; nullopt if it is none.
std::optional<double> parsed_number(const std::string& word) { return whole<double>(word); }
/// As the parser reads it, so that "0x10" is one.
std::optional<long long> parsed_whole_number(const std::string& word) {
  char* end = nullptr;
  const long long value = std::strtoll(word.c_str(), &end, 0);
  if (word.empty() || end != word.c_str() + word.size()) return std::nullopt;
  return value;
}

template <class Number, class Read>
Condition in_range(const std::string& type, Number least, Number most, const Read& read) {
  const std::string from = as_typed(least), to = as_typed(most);
  return {type + " in [" + from + " - " + to + "]", [=](const std::string& word) {
            const auto value = read(word);
            if (value && least <= *value && *value <= most) return std::string();
            return "Value " + word + " not in range " + from + " to " + to;
          }};
}

}  // namespace

Condition above_zero() {
  return {"above 0", [](const std::string& word) {
            const std::optional<double> value = parsed_number(word);
            const bool right = value && std::isfinite(*value) && *value > 0;
            return right ? "" : "'" + word + "' is not a number above 0";
          }};
}

Condition above_zero_seconds() {
  return {"above 0", [](const std::string& word) {
            const std::optional<double> value = parsed_number(word);
            const bool right = value && *value > 0 && *value <= kLongestSeconds;
            return right ? ""
                         : "'" + word + "' is not a number above 0, at most " +
                               as_typed(kLongestSeconds);
          }};
}

Condition in_range(int least, int most) {
  return in_range("INT", least, most, parsed_whole_number);
}

Condition in_range(double least, double most) {
  return in_range("FLOAT", least, most, parsed_number);
}

Condition existing_file() {
  return {"FILE", [](const std::string& word) -> std::string {
            std::error_code none;
            const auto status = std::filesystem::status(word, none);
            if (!exists(status)) return "File does not exist: " + word;
            return is_directory(status) ? "File is actually a directory: " + word : "";
          }};
}

Condition only(const std::string& name) {
  return {"{" + name + "}", [=](const std::string& word) {
            return word == name ? "" : word + " not in {" + name + "}";
          }};
}

Condition either(const Condition& one, const Condition& other) {
  return {one.shown + other.shown, [=](const std::string& word) -> std::string {
            const std::string first = one.complaint(word), second = other.complaint(word);
            if (first.empty() || second.empty()) return "";
            return "(" + first + ") OR (" + second + ")";
          }};
}

Condition known(const std::string& what, std::vector<std::string> names) {
  return {"", [what, names = std::move(names)](const std::string& word) {
            if (std::ranges::find(names, word) != names.end()) return std::string();
            return "unknown " + what + " '" + word + "'" + suggestion(word, names) +
                   (names.size() < 12 ? " (one of " + join(names, ", ") + ")" : "");
          }};
}

Condition metric_value() { return known("metric value", value_names()); }

}  // namespace taut
