#include <algorithm>
#include <cctype>
#include <cstdio>

#include "core/io/document.hpp"
#include "core/model/shortest.hpp"

namespace taut {

namespace {

std::string quoted(const std::string& text) {
  std::string all = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      all += '\\', all += c;
    } else if (code < 0x20 || code == 0x7f) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\u%04X", code);
      all += escape;
    } else {
      all += c;
    }
  }
  return all + '"';
}

std::string key_text(const std::string& key) {
  const bool bare = !key.empty() && std::ranges::all_of(key, [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
  });
  return bare ? key : quoted(key);
}

/// A value on one line; tables as inline tables.
std::string inline_text(const Value& value) {
  switch (value.kind) {
    case Value::Kind::boolean:
      return value.boolean ? "true" : "false";
    case Value::Kind::integer:
    case Value::Kind::real:
      return shortest(value.number);
    case Value::Kind::string:
      return quoted(value.string);
    case Value::Kind::date:
      throw InputError("a date or time cannot be written");
    case Value::Kind::array:
    case Value::Kind::table:
      break;
  }
  std::string all;
  for (std::size_t i = 0; i < value.items.size(); ++i)
    all += (i == 0 ? "" : ", ") +
           (value.is_table() ? key_text(value.keys[i].text) + " = " : std::string()) +
           inline_text(value.items[i]);
  return value.is_table() ? "{ " + all + " }" : "[" + all + "]";
}

/// Whether a top-level value is written as [[key]] tables.
bool is_tables(const Value& value) {
  return value.is_array() && !value.items.empty() &&
         std::ranges::all_of(value.items, &Value::is_table);
}

std::string lines(const Value& table) {
  std::string all;
  for (std::size_t i = 0; i < table.items.size(); ++i)
    all += key_text(table.keys[i].text) + " = " + inline_text(table.items[i]) + '\n';
  return all;
}

}  // namespace

std::string to_toml(const Value& root) {
  std::string all;
  const auto each = [&](const auto& write) {
    for (std::size_t i = 0; i < root.items.size(); ++i)
      write(key_text(root.keys[i].text), root.items[i]);
  };
  each([&](const std::string& key, const Value& value) {
    if (!value.is_table() && !is_tables(value)) all += key + " = " + inline_text(value) + '\n';
  });
  each([&](const std::string& key, const Value& value) {
    if (value.is_table()) all += "\n[" + key + "]\n" + lines(value);
    if (!is_tables(value)) return;
    for (const Value& one : value.items) all += "\n[[" + key + "]]\n" + lines(one);
  });
  return all;
}

}  // namespace taut
