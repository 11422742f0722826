#include "core/io/section.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <tuple>

#include "core/io/scene_io.hpp"
#include "core/model/text.hpp"

namespace taut {

void Diagnostics::throw_if_any() {
  if (found_.empty()) return;
  // Overrides have no line and come last, as on the command line.
  std::stable_sort(found_.begin(), found_.end(), [](const Diagnostic& a, const Diagnostic& b) {
    return std::tuple(a.line == 0, a.file, a.line, a.column) <
           std::tuple(b.line == 0, b.file, b.line, b.column);
  });
  throw InputError(found_);
}

std::string Range::text() const {
  const Range any;
  std::string low, high;
  if (min != any.min) low = (above_min ? "greater than " : "at least ") + shortest(min);
  if (max != any.max) high = "at most " + shortest(max);
  return low + (low.empty() || high.empty() ? "" : " and ") + high;
}

double parse_number(const std::string& text) {
  const auto part = [&](std::string_view s) {
    double value = 0;
    const auto [end, error] = std::from_chars(s.data(), s.data() + s.size(), value);
    if (error != std::errc() || end != s.data() + s.size() || !std::isfinite(value))
      throw InputError("'" + text + "' is not a number; write 0.015625 or \"1/64\"");
    return value;
  };
  const std::string_view all = text;
  const auto slash = all.find('/');
  if (slash == std::string_view::npos) return part(all);
  const double numerator = part(all.substr(0, slash)), denominator = part(all.substr(slash + 1));
  if (denominator == 0) throw InputError("'" + text + "' divides by zero");
  return numerator / denominator;
}

std::optional<double> as_number(const Value& value) {
  if (value.is_number()) return value.number;
  if (!value.is_string()) return std::nullopt;
  try {
    return parse_number(value.string);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

Section::Section(Diagnostics& diagnostics, const Value& table, std::string name)
    : diagnostics_(diagnostics), table_(table), name_(std::move(name)) {}

const Value* Section::find(const std::string& key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.push_back(key);
  return table_.find(key);
}

SourceLocation Section::place(const std::string& key) const {
  const Value* value = table_.find(key);
  return value ? value->place : table_.place;
}

void Section::missing(const std::string& key) {
  diagnostics_.report(table_.place, "missing key '" + key + "' in " + name_);
}

void Section::need(std::initializer_list<const char*> keys) {
  for (const char* key : keys)
    if (!find(key)) missing(key);
}

void Section::report(const std::string& key, const std::string& message) {
  diagnostics_.report(place(key), "'" + key + "' in " + name_ + " " + message);
}

void Section::wrong_type(const Value& value, const std::string& key, const std::string& wanted) {
  diagnostics_.report(
      value.place, "'" + key + "' in " + name_ + " must be " + wanted + ", not " + describe(value));
}

std::optional<double> Section::judged(const Value& value, const std::string& key,
                                      const Range& range) {
  const auto number = as_number(value);
  if (!number) {
    wrong_type(value, key, "a number or a fraction such as \"1/64\"");
  } else if (!std::isfinite(*number)) {
    diagnostics_.report(value.place, "'" + key + "' in " + name_ + " must be finite");
  } else if (!range.holds(*number)) {
    diagnostics_.report(value.place, "'" + key + "' in " + name_ + " must be " + range.text() +
                                         ", not " + shortest(*number));
  } else {
    return *number;
  }
  return std::nullopt;
}

std::optional<double> Section::number(const std::string& key, const Range& range) {
  const Value* value = find(key);
  return value ? judged(*value, key, range) : std::nullopt;
}

std::optional<std::vector<double>> Section::numbers(const std::string& key, std::size_t count,
                                                    const Range& range) {
  const Value* value = find(key);
  if (!value) return std::nullopt;
  if (!value->is_array() || value->items.size() != count) {
    wrong_type(*value, key, "an array of " + std::to_string(count) + " numbers");
    return std::nullopt;
  }
  std::vector<double> all;
  for (const Value& item : value->items)
    if (const auto number = judged(item, key, range)) all.push_back(*number);
  if (all.size() != count) return std::nullopt;
  return all;
}

std::optional<Vec3> Section::vec3(const std::string& key, double bound) {
  const auto all = numbers(key, 3, Range::within(bound));
  if (!all) return std::nullopt;
  return Vec3((*all)[0], (*all)[1], (*all)[2]);
}

Vec3 Section::direction(const std::string& key, const Vec3& fallback) {
  const auto given = vec3(key, 1e6);
  if (!given) return fallback;
  const double length = given->norm();
  if (!(length > 1e-6)) {
    report(key, "is a direction and must not be zero");
    return fallback;
  }
  return *given / length;
}

bool Section::boolean(const std::string& key, bool fallback) {
  const Value* value = find(key);
  if (!value) return fallback;
  if (value->kind != Value::Kind::boolean) {
    wrong_type(*value, key, "true or false");
    return fallback;
  }
  return value->boolean;
}

std::optional<std::string> Section::string(const std::string& key) {
  const Value* value = find(key);
  if (!value) return std::nullopt;
  if (!value->is_string()) {
    wrong_type(*value, key, "a string");
    return std::nullopt;
  }
  return value->string;
}

std::optional<std::vector<std::string>> Section::strings(const std::string& key) {
  const Value* value = find(key);
  if (!value) return std::nullopt;
  if (!value->is_array()) return wrong_type(*value, key, "a list of strings"), std::nullopt;
  std::vector<std::string> all;
  for (const Value& item : value->items)
    if (item.is_string())
      all.push_back(item.string);
    else
      wrong_type(item, key, "a list of strings");
  return all;
}

std::string Section::choice(const std::string& key, const std::vector<std::string>& choices,
                            const std::string& fallback) {
  const auto given = string(key);
  if (!given) return fallback;
  if (std::find(choices.begin(), choices.end(), *given) != choices.end()) return *given;
  std::string all;
  for (const std::string& c : choices) all += (all.empty() ? "\"" : " or \"") + c + "\"";
  report(key, "must be " + all + ", not \"" + *given + "\"" + suggestion(*given, choices));
  return fallback;
}

const Value* Section::table(const std::string& key) {
  const Value* value = find(key);
  if (value && !value->is_table()) {
    wrong_type(*value, key, "a table");
    return nullptr;
  }
  return value;
}

std::vector<const Value*> Section::tables(const std::string& key) {
  std::vector<const Value*> all;
  const Value* value = find(key);
  if (!value) return all;
  if (!value->is_array()) {
    wrong_type(*value, key, "an array of tables, written [[" + key + "]]");
    return all;
  }
  for (const Value& item : value->items) {
    if (item.is_table())
      all.push_back(&item);
    else
      wrong_type(item, key, "an array of tables, written [[" + key + "]]");
  }
  return all;
}

void Section::finish() {
  for (const Key& key : table_.keys)
    if (std::find(known_.begin(), known_.end(), key.text) == known_.end())
      diagnostics_.report(
          key.place, "unknown key '" + key.text + "' in " + name_ + suggestion(key.text, known_));
}

}  // namespace taut
