#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/model/text.hpp"
#include "experiments/study/study_reading.hpp"

namespace taut {

namespace {

std::string in_quotes(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

std::string key_text(const std::string& key) {
  constexpr std::string_view kBare =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  return !key.empty() && key.find_first_not_of(kBare) == key.npos ? key : in_quotes(key);
}

}  // namespace

bool has_text(const Value& value, bool toml) {
  if (value.kind == Value::Kind::date || (value.is_table() && !toml)) return false;
  return std::ranges::all_of(value.items, [&](const Value& item) { return has_text(item, toml); });
}

std::string text_of(const Value& value, bool toml) {
  const auto text_of_item = [&](const Value& item) { return text_of(item, toml); };
  switch (value.kind) {
    case Value::Kind::boolean:
      return value.boolean ? "true" : "false";
    case Value::Kind::string:
      return toml ? in_quotes(value.string) : value.string;
    case Value::Kind::array:
      return "[" + join(value.items, ", ", text_of_item) + "]";
    case Value::Kind::table: {
      std::vector<std::string> items;
      for (std::size_t i = 0; i < value.items.size(); ++i)
        items.push_back(key_text(value.keys[i].text) + " = " + text_of_item(value.items[i]));
      return "{ " + join(items, ", ") + " }";
    }
    case Value::Kind::integer:  // 100000, not 1e+05
      if (std::abs(value.number) < 1e15) return std::to_string(std::lround(value.number));
      return shortest(value.number);
    case Value::Kind::real:
      return shortest(value.number);
    case Value::Kind::date:
      break;
  }
  assert(false && "a date has no text");
  return {};
}

}  // namespace taut
