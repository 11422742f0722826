#include "core/io/document.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <locale>
#include <sstream>
#include <string_view>
#include <tuple>
#include <utility>

#include "core/io/scene_io.hpp"
#include "core/io/text_file.hpp"
#include "core/model/scene_keys.hpp"
#include "core/model/text.hpp"

namespace taut {

namespace {

SourceLocation place_of(const toml::source_region& region, int setting) {
  return {static_cast<int>(region.begin.line), static_cast<int>(region.begin.column), setting};
}

/// Most parts of a dotted key. The TOML library recurses for each part and has no limit of its own.
constexpr int kMostKeyParts = 16;
/// Most levels of a document; no key is deeper.
constexpr int kMostLevels = 64;

/// Offset of the first dotted key with more parts than kMostKeyParts; npos if there is no such key.
std::size_t too_long_key(std::string_view text) {
  const auto bare = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
  };
  const auto after_part = [&](std::size_t at) {  // returns `at` if no part of a key begins there
    if (at < text.size() && (text[at] == '"' || text[at] == '\'')) {
      const std::size_t end = text.find_first_of(std::string{text[at], '\n'}, at + 1);
      return end != text.npos && text[end] == text[at] ? end + 1 : at;
    }
    while (at < text.size() && bare(text[at])) ++at;
    return at;
  };
  const auto after_blanks = [&](std::size_t at) {
    return std::min(text.find_first_not_of(" \t", at), text.size());
  };
  for (std::size_t begin = 0; begin < text.size();) {
    std::size_t at = begin;
    for (int parts = 1;; ++parts) {
      const std::size_t end = after_part(at);
      if (end == at) break;
      if (parts > kMostKeyParts) return begin;
      at = after_blanks(end);
      if (at == text.size() || text[at] != '.') break;
      at = after_blanks(at + 1);
    }
    begin = std::max(at, begin + 1);
  }
  return text.npos;
}

toml::table parse_bounded(std::string_view text) {
  if (const std::size_t at = too_long_key(text); at != text.npos) {
    const auto line =
        std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    const std::size_t start = text.rfind('\n', at) + 1;  // npos + 1 is 0
    const toml::source_position place{static_cast<toml::source_index>(line + 1),
                                      static_cast<toml::source_index>(at - start + 1)};
    throw toml::parse_error("a key of more than 16 parts", place, nullptr);
  }
  return toml::parse(text);
}

Value convert(const toml::node& node, int setting, int level = 0) {
  if (level > kMostLevels)
    throw toml::parse_error("nested more than 64 levels deep", node.source());
  Value value;
  value.place = place_of(node.source(), setting);
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, child] : *table) {
      value.keys.push_back({std::string(key.str()), place_of(key.source(), setting)});
      value.items.push_back(convert(child, setting, level + 1));
    }
  } else if (const toml::array* array = node.as_array()) {
    value.kind = Value::Kind::array;
    for (const toml::node& child : *array)
      value.items.push_back(convert(child, setting, level + 1));
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

/// The element of an array that a dotted key names by its index; nullptr if there is no such
/// element.
Value* element(Value& array, const std::string& key) {
  const auto index = whole<std::size_t>(key);
  return index && *index < array.items.size() ? &array.items[*index] : nullptr;
}

/// Applies the values of a setting. Tables written with dotted keys merge; everything else is
/// replaced.
void assign(Value& target, const toml::table& from, int setting,
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
      if (!target.is_table()) target = Value{};  // reported later: the schema wants another type
      slot = const_cast<Value*>(target.find(name));
      if (!slot) {
        target.keys.push_back({name, place_of(key.source(), setting)});
        target.items.push_back({});
        slot = &target.items.back();
        slot->place = place_of(key.source(), setting);
      }
    }
    const toml::table* table = child.as_table();
    if (table && !table->is_inline())
      assign(*slot, *table, setting, problems);
    else
      *slot = convert(child, setting);
  }
}

/// The syntax error as a diagnostic. Its line is kept inside the text even if the end is missing.
Diagnostic syntax_error(const toml::parse_error& error, const Document& document,
                        const std::string& text, int setting) {
  SourceLocation place = place_of(error.source(), setting);
  const auto breaks = std::count(text.begin(), text.end(), '\n');
  const int lines = static_cast<int>(breaks) + (text.empty() || text.back() != '\n' ? 1 : 0);
  place.line = std::clamp(place.line, 1, std::max(1, lines));
  place.column = std::max(1, place.column);
  return document.diagnostic(place, std::string(error.description()));
}

/// Destination of a value in the library's tree: an array, or a key of a table.
struct Place {
  toml::array* array = nullptr;
  toml::table* table = nullptr;
  std::string key = {};
  template <class T>
  void put(T value) const {
    if (array)
      array->push_back(std::move(value));
    else
      table->insert(key, std::move(value));
  }
};

toml::table table_of(const Value& table);

void hand_over(const Value& value, const Place& to) {
  switch (value.kind) {
    case Value::Kind::boolean:
      return to.put(value.boolean);
    case Value::Kind::integer:
      return to.put(static_cast<std::int64_t>(value.number));
    case Value::Kind::real:
      return to.put(value.number);
    case Value::Kind::string:
      return to.put(value.string);
    case Value::Kind::table:
      return to.put(table_of(value));
    case Value::Kind::date:
      throw InputError("a date or time cannot be written");
    case Value::Kind::array:
      break;
  }
  toml::array array;
  for (const Value& item : value.items) hand_over(item, {.array = &array});
  to.put(std::move(array));
}

toml::table table_of(const Value& value) {
  toml::table table;
  for (std::size_t i = 0; i < value.items.size(); ++i)
    hand_over(value.items[i], {.table = &table, .key = value.keys[i].text});
  return table;
}

/// Hint at the end of a message about a value that does not parse: what the value should be.
std::string as_written(const SceneSetting& setting) {
  const std::string& path = setting.key();
  const SceneKey* key = find_scene_key(path);
  if (!key) return "; a text stands in quotes: key=\"text\"";
  return "; " + path + " is of type " + std::string(key->type) + ", as in " + path + "=" +
         std::string(key->example);
}

}  // namespace

const Value* Value::find(const std::string& key) const {
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (keys[i].text == key) return &items[i];
  return nullptr;
}

int Value::latest_setting() const {
  int latest = place.setting;
  for (const Value& item : items) latest = std::max(latest, item.latest_setting());
  return latest;
}

std::string describe(const Value& value) {
  using enum Value::Kind;
  if (value.kind == boolean) return value.boolean ? "true" : "false";
  if (value.kind == string) return "the string \"" + value.string + "\"";
  if (value.kind == array) return "an array of " + std::to_string(value.items.size());
  return value.kind == integer ? "a whole number"
         : value.kind == real  ? "a number"
         : value.kind == table ? "a table"
                               : "a date or time";
}

Diagnostic Document::diagnostic(const SourceLocation& place, const std::string& message) const {
  if (place.setting < 0) return {file, place.line, place.column, message};
  const std::string& text = settings[static_cast<std::size_t>(place.setting)].written();
  return {text, 0, place.column, message};
}

Document parse_document(const std::string& file, const std::string& text,
                        const SceneSettings& settings) {
  Document document{file, settings, {}};
  std::vector<Diagnostic> found;
  try {
    document.root = convert(parse_bounded(text), -1);
  } catch (const toml::parse_error& error) {
    found.push_back(syntax_error(error, document, text, -1));
  }
  for (int i = 0; i < static_cast<int>(settings.size()); ++i) {
    const SceneSetting& setting = settings[static_cast<std::size_t>(i)];
    try {
      std::vector<std::string> problems;
      assign(document.root, parse_bounded(setting.written()), i, problems);
      for (const std::string& problem : problems)
        found.push_back(document.diagnostic({1, 1, i}, problem));
    } catch (const toml::parse_error& error) {
      found.push_back(syntax_error(error, document, setting.written(), i));
      if (found.back().message.starts_with("Error while parsing"))  // the library's words
        found.back().message += as_written(setting);
    }
  }
  if (!found.empty()) throw InputError(found);
  return document;
}

Document read_document(const std::filesystem::path& path, const SceneSettings& settings) {
  return parse_document(path.string(), read_text(path, kMostSceneBytes), settings);
}

std::string to_toml(const Value& root) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << table_of(root) << '\n';
  return out.str();
}

std::string Diagnostics::remarks_at(const SourceLocation& place) const {
  std::string all;
  for (const auto& [at, sentence] : remarks_at_)
    if (at == place) all += "; " + sentence;
  return all;
}

void Diagnostics::throw_if_any() {
  if (found_.empty()) return;
  // Settings have no line and come last, in the order of the command line.
  std::stable_sort(found_.begin(), found_.end(), [](const Diagnostic& a, const Diagnostic& b) {
    return std::tuple(a.line == 0, a.file, a.line, a.column) <
           std::tuple(b.line == 0, b.file, b.line, b.column);
  });
  throw InputError(found_);
}

double parse_number(const std::string& text) {
  const auto part = [&](std::string_view s) {
    const auto value = whole<double>(s);
    if (!value || !std::isfinite(*value))
      throw InputError("'" + text + "' is not a number; write 0.015625 or \"1/64\"");
    return *value;
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

Section::Section(Diagnostics& diagnostics, const Value& table, std::string name,
                 std::string scene_section)
    : diagnostics_(diagnostics),
      table_(table),
      name_(std::move(name)),
      scene_section_(std::move(scene_section)) {}

const Value* Section::find(const std::string& key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.push_back(key);
  return table_.find(key);
}

void Section::know() {
  for (const SceneKey& key : scene_keys())
    if (key.section() == scene_section_) find(std::string(key.name()));
}

SourceLocation Section::place(const std::string& key) const {
  const Value* value = table_.find(key);
  return value ? value->place : table_.place;
}

void Section::missing(const std::string& key) {
  diagnostics_.report(table_.place, "missing key '" + key + "' in " + name_);
}

void Section::need(std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys)
    if (!find(std::string(key))) missing(std::string(key));
}

void Section::report(const std::string& key, const std::string& message) {
  diagnostics_.report(place(key), "'" + key + "' in " + name_ + " " + message);
}

void Section::wrong_type(const Value& value, const std::string& key, const std::string& wanted) {
  diagnostics_.report(
      value.place, "'" + key + "' in " + name_ + " must be " + wanted + ", not " + describe(value));
}

std::string Section::in_unit(const std::string& key) const {
  const auto known = std::ranges::find(scene_keys(), scene_section_ + "." + key, &SceneKey::path);
  if (known == scene_keys().end() || known->unit.empty() || known->unit == "1") return "";
  return " in " + std::string(known->unit);
}

std::optional<double> Section::judged(const Value& value, const std::string& key,
                                      const Range& range) {
  const auto number = as_number(value);
  if (!number) {
    wrong_type(value, key, "a number" + in_unit(key) + " or a fraction such as \"1/64\"");
  } else if (!std::isfinite(*number)) {
    diagnostics_.report(value.place, "'" + key + "' in " + name_ + " must be finite");
  } else if (!range.holds(*number)) {
    diagnostics_.report(value.place, "'" + key + "' in " + name_ + " must be " + range.text() +
                                         ", not " + as_typed(*number));
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

std::optional<Vec3> Section::vec3(const std::string& key, const Range& range) {
  const auto all = numbers(key, 3, range);
  if (!all) return std::nullopt;
  return Vec3((*all)[0], (*all)[1], (*all)[2]);
}

Vec3 Section::direction(const std::string& key, const Vec3& fallback) {
  const auto given = vec3(key, Range::within(1e6));
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
  if (!value->is_array()) {
    wrong_type(*value, key, "a list of strings");
    return std::nullopt;
  }
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

void Section::finish(const std::vector<std::string>& elsewhere) {
  for (const Key& key : table_.keys) {
    if (std::find(known_.begin(), known_.end(), key.text) != known_.end()) continue;
    std::string meant;  // the same key elsewhere is a better guess than another key here
    for (const std::string& path : elsewhere)
      if (meant.empty() && path.ends_with("." + key.text)) meant = "; did you mean '" + path + "'?";
    if (meant.empty()) meant = suggestion(key.text, known_);
    diagnostics_.report(key.place, "unknown key '" + key.text + "' in " + name_ + meant);
  }
}

}  // namespace taut
