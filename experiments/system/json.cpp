#include "experiments/system/json.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>

#include "core/model/input_error.hpp"
#include "experiments/system/text.hpp"

namespace taut {

namespace {

/// Escapes U+007F to U+009F, which the library leaves as they are and a terminal may interpret.
std::string with_escaped_controls(const std::string& json) {
  const auto is_control = [&](std::size_t i) {
    return json[i] == '\x7f' || (json[i] == '\xC2' && json[i + 1] < '\xA0');
  };
  std::string out;
  std::size_t kept = 0;
  for (std::size_t i = json.find_first_of("\x7f\xC2"); i != std::string::npos;
       i = json.find_first_of("\x7f\xC2", i + 1)) {
    if (!is_control(i)) continue;
    const bool two = json[i] == '\xC2';
    out.append(json, kept, i - kept);
    out += formatted("\\u%04x", static_cast<unsigned char>(json[i + (two ? 1 : 0)]));
    kept = i + (two ? 2 : 1);
  }
  return out.append(json, kept);
}

}  // namespace

std::string to_text(const Json& json, int indent) {
  return with_escaped_controls(json.dump(indent, ' ', false, Json::error_handler_t::replace));
}

void print_json(const Json& json, int indent) { std::cout << to_text(json, indent) << '\n'; }

Json parse_json(std::string_view text) {
  if (text.find('\0') == text.npos) return Json::parse(text);
  std::string shown(text);  // the library takes a NUL byte for the end of the text
  std::ranges::replace(shown, '\0', '\1');
  return Json::parse(shown);
}

Json json_number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

void add_if(Json& object, const char* name, Json value) {
  const bool blank = value.is_string() && value.get_ref<const std::string&>().empty();
  if (!blank && !value.is_null() && !(value.is_structured() && value.empty()))
    object[name] = std::move(value);
}

Json parse_json_of(std::string_view text, const std::string& file, int line) try {
  return parse_json(text);
} catch (const Json::exception& error) {
  throw InputError({{file, line, 0, std::string("is not JSON: ") + error.what()}});
}

void JsonReader::fail(const std::string& why) const {
  throw InputError({{file_, line_, 0, (path_.empty() ? "" : path_ + ": ") + why}});
}

JsonReader JsonReader::part(const Json& json, const std::string& step) const {
  JsonReader reader(json, file_, line_);
  reader.path_ = path_ + (path_.empty() && step.front() == '.' ? step.substr(1) : step);
  return reader;
}

std::optional<JsonReader> JsonReader::find(const char* key) const {
  if (!json_->is_object()) fail("expected an object");
  const auto found = json_->find(key);
  if (found == json_->end()) return {};
  return part(*found, std::string(".") + key);
}

JsonReader JsonReader::at(const char* key) const {
  auto found = find(key);
  if (!found) fail("has no '" + std::string(key) + "'");
  return *std::move(found);
}

std::vector<JsonReader> JsonReader::items() const {
  if (!json_->is_array()) fail("expected an array");
  std::vector<JsonReader> all;
  for (const Json& item : *json_) all.push_back(part(item, "[" + std::to_string(all.size()) + "]"));
  return all;
}

std::vector<JsonReader> JsonReader::items(std::size_t count) const {
  std::vector<JsonReader> all = items();
  if (all.size() != count)
    fail("has " + std::to_string(all.size()) + " items, not " + std::to_string(count));
  return all;
}

std::vector<std::pair<std::string, JsonReader>> JsonReader::members() const {
  if (!json_->is_object()) fail("expected an object");
  std::vector<std::pair<std::string, JsonReader>> all;
  for (const auto& [key, value] : json_->items()) all.emplace_back(key, part(value, "." + key));
  return all;
}

std::string JsonReader::text() const {
  if (!json_->is_string()) fail("expected a text");
  return json_->get<std::string>();
}

bool JsonReader::flag() const {
  if (!json_->is_boolean()) fail("expected true or false");
  return json_->get<bool>();
}

double JsonReader::number() const {
  if (!json_->is_number()) fail("expected a number");
  const auto value = json_->get<double>();
  if (!std::isfinite(value)) fail("expected a finite number");
  return value;
}

double JsonReader::number_or_null() const {
  return json_->is_null() ? std::numeric_limits<double>::quiet_NaN() : number();
}

int JsonReader::integer(int least, int most) const {
  const double value = number();
  if (value != std::floor(value) || value < least || value > most)
    fail("expected a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  return static_cast<int>(value);
}

std::size_t JsonReader::count() const {
  const double value = number();
  if (value != std::floor(value) || value < 0 || value > 9007199254740992.0)
    fail("expected a count");
  return static_cast<std::size_t>(value);
}

std::vector<std::string> JsonReader::texts() const {
  std::vector<std::string> all;
  for (const JsonReader& item : items()) all.push_back(item.text());
  return all;
}

std::vector<double> JsonReader::numbers() const {
  std::vector<double> all;
  for (const JsonReader& item : items()) all.push_back(item.number());
  return all;
}

void read_into(const JsonReader& json, std::string& text) { text = json.text(); }
void read_into(const JsonReader& json, bool& flag) { flag = json.flag(); }
void read_into(const JsonReader& json, std::size_t& count) { count = json.count(); }
void read_into(const JsonReader& json, int& number) { number = json.integer(number); }
void read_into(const JsonReader& json, std::vector<std::string>& all) { all = json.texts(); }
void read_into(const JsonReader& json, std::map<std::string, std::string>& all) {
  for (const auto& [name, value] : json.members()) all[name] = value.text();
}
void read_into(const JsonReader& json, std::map<std::string, double>& all) {
  for (const auto& [name, value] : json.members()) all[name] = value.number_or_null();
}
void read_into(const JsonReader& json, double& number) {
  number = std::isnan(number) ? json.number_or_null() : json.number();
}

void JsonReader::require_schema(const Json& schema) const {
  if (const JsonReader found = at("schema"); *found.json_ != schema)
    found.fail("is " + to_text(*found.json_) + "; this program reads " + to_text(schema));
}

}  // namespace taut
