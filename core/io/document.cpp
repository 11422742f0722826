#include "core/io/document.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <fstream>
#include <iterator>

namespace taut {

namespace {

SourceLocation place_of(const toml::source_region& region, int override) {
  return {static_cast<int>(region.begin.line), static_cast<int>(region.begin.column), override};
}

Value convert(const toml::node& node, int override) {
  Value value;
  value.place = place_of(node.source(), override);
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, child] : *table) {
      value.keys.push_back({std::string(key.str()), place_of(key.source(), override)});
      value.items.push_back(convert(child, override));
    }
  } else if (const toml::array* array = node.as_array()) {
    value.kind = Value::Kind::array;
    for (const toml::node& child : *array) value.items.push_back(convert(child, override));
  } else if (node.is_string()) {
    value.kind = Value::Kind::string;
    value.string = node.value_or(std::string());
  } else if (node.is_boolean()) {
    value.kind = Value::Kind::boolean;
    value.boolean = node.value_or(false);
  } else if (node.is_number()) {
    value.kind = node.is_integer() ? Value::Kind::integer : Value::Kind::real;
    value.number = node.value_or(0.0);
  } else {
    value.kind = Value::Kind::date;
  }
  return value;
}

/// The element of an array that a dotted key names by its number; nullptr: none such.
Value* element(Value& array, const std::string& key) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), index);
  if (error != std::errc() || end != key.data() + key.size()) return nullptr;
  return index < array.items.size() ? &array.items[index] : nullptr;
}

/// Puts what the override says over what is there. Tables that were written with dotted keys merge;
/// everything else is replaced.
void assign(Value& target, const toml::table& from, int override,
            std::vector<std::string>& problems) {
  for (const auto& [key, child] : from) {
    const std::string name(key.str());
    Value* slot = nullptr;
    if (target.is_array()) {
      slot = element(target, name);
      if (!slot) {
        problems.push_back("no element '" + name + "' among the " +
                           std::to_string(target.items.size()) + " of this array");
        continue;
      }
    } else {
      if (!target.is_table()) target = Value{};  // judged later: the schema wants another type
      slot = const_cast<Value*>(target.find(name));
      if (!slot) {
        target.keys.push_back({name, place_of(key.source(), override)});
        target.items.push_back({});
        slot = &target.items.back();
        slot->place = place_of(key.source(), override);
      }
    }
    const toml::table* table = child.as_table();
    if (table && !table->is_inline())
      assign(*slot, *table, override, problems);
    else
      *slot = convert(child, override);
  }
}

/// The syntax error as ours; its line is kept inside the text even if the end is what is missing.
Diagnostic syntax_error(const toml::parse_error& error, const Document& document,
                        const std::string& text, int override) {
  SourceLocation place = place_of(error.source(), override);
  const auto breaks = std::count(text.begin(), text.end(), '\n');
  const int lines = static_cast<int>(breaks) + (text.empty() || text.back() != '\n' ? 1 : 0);
  place.line = std::clamp(place.line, 1, std::max(1, lines));
  place.column = std::max(1, place.column);
  return document.diagnostic(place, std::string(error.description()));
}

}  // namespace

const Value* Value::find(const std::string& key) const {
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (keys[i].text == key) return &items[i];
  return nullptr;
}

std::string describe(const Value& value) {
  switch (value.kind) {
    case Value::Kind::boolean:
      return value.boolean ? "true" : "false";
    case Value::Kind::integer:
      return "a whole number";
    case Value::Kind::real:
      return "a number";
    case Value::Kind::string:
      return "the string \"" + value.string + "\"";
    case Value::Kind::array:
      return "an array of " + std::to_string(value.items.size());
    case Value::Kind::table:
      return "a table";
    case Value::Kind::date:
      return "a date or time";
  }
  return "";
}

Diagnostic Document::diagnostic(const SourceLocation& place, const std::string& message) const {
  if (place.override < 0) return {file, place.line, place.column, message};
  const std::string& text = overrides[static_cast<std::size_t>(place.override)];
  return {{}, 0, 0, "override '" + text + "': " + message};
}

Document parse_document(const std::string& file, const std::string& text,
                        const std::vector<std::string>& overrides) {
  Document document{file, overrides, {}};
  std::vector<Diagnostic> found;
  try {
    document.root = convert(toml::parse(text), -1);
  } catch (const toml::parse_error& error) {
    found.push_back(syntax_error(error, document, text, -1));
  }
  for (int i = 0; i < static_cast<int>(overrides.size()); ++i) {
    const std::string& assignment = overrides[static_cast<std::size_t>(i)];
    try {
      std::vector<std::string> problems;
      assign(document.root, toml::parse(assignment), i, problems);
      for (const std::string& problem : problems)
        found.push_back(document.diagnostic({1, 1, i}, problem));
    } catch (const toml::parse_error& error) {
      found.push_back(syntax_error(error, document, assignment, i));
    }
  }
  if (!found.empty()) throw InputError(found);
  return document;
}

Document read_document(const std::filesystem::path& path,
                       const std::vector<std::string>& overrides) {
  const auto fail = [&](const std::string& why) {
    throw InputError(std::vector{Diagnostic{path.string(), 0, 0, why}});
  };
  if (std::filesystem::is_directory(path)) fail("is a folder, not a file");
  std::ifstream in(path, std::ios::binary);
  if (!in) fail(std::string("cannot be read: ") + std::strerror(errno));
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  return parse_document(path.string(), text, overrides);
}

}  // namespace taut
