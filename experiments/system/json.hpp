#pragma once

#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/io/text_file.hpp"
#include "experiments/system/json_type.hpp"

namespace taut {

// The library is large: keep this header out of headers that many files include. The writer and the
// parser are compiled once, in json.cpp.

/// Writes JSON text; a negative indent puts it on one line. Bytes that are not UTF-8 become U+FFFD.
std::string to_text(const Json&, int indent = -1);
/// Throws Json::exception.
Json parse_json(std::string_view);

/// A number, or null if it is not finite.
Json json_number(double);
/// Appends a field unless it is null or empty.
void add_if(Json& object, const char* name, Json value);
/// An array with json_of(item) for each item.
template <class Range, class JsonOf>
Json json_array(const Range& items, const JsonOf& json_of) {
  Json all = Json::array();
  for (const auto& item : items) all.push_back(json_of(item));
  return all;
}
/// Prints JSON to standard output, followed by a line feed.
void print_json(const Json&, int indent = 1);

/// A value in a JSON text that a program wrote and this one reads. If a part is missing or of
/// another type, throws InputError with the file, the line and the place in the text
/// ("scenes[0].cases").
class JsonReader {
 public:
  JsonReader(const Json& json, std::string file, int line = 0)
      : json_(&json), file_(std::move(file)), line_(line) {}

  JsonReader at(const char* key) const;  ///< throws if the object lacks the key
  std::optional<JsonReader> find(const char* key) const;
  std::vector<JsonReader> items() const;  ///< throws unless it is an array
  /// The items of an array; throws unless there are `count` of them.
  std::vector<JsonReader> items(std::size_t count) const;
  /// Throws unless it is an object.
  std::vector<std::pair<std::string, JsonReader>> members() const;

  bool is_null() const { return json_->is_null(); }
  bool is_text() const { return json_->is_string(); }
  bool is_flag() const { return json_->is_boolean(); }
  bool is_array() const { return json_->is_array(); }
  std::string text() const;
  bool flag() const;
  double number() const;          ///< finite
  double number_or_null() const;  ///< NaN for null
  /// A whole number within the bounds.
  int integer(int least = std::numeric_limits<int>::min(),
              int most = std::numeric_limits<int>::max()) const;
  std::size_t count() const;  ///< a whole number from 0 to 2^53
  std::vector<std::string> texts() const;
  std::vector<double> numbers() const;
  /// Throws unless the value of `schema` is this one.
  void require_schema(const Json& schema) const;
  [[noreturn]] void fail(const std::string& why) const;

 private:
  JsonReader part(const Json& json, const std::string& step) const;
  const Json* json_;
  std::string file_, path_;
  int line_;
};

/// Read a value of each type. Null is read as NaN into a number that was NaN before, and into a map
/// of numbers; an integer must be at least what the variable held before.
void read_into(const JsonReader&, std::string&);
void read_into(const JsonReader&, bool&);
void read_into(const JsonReader&, double&);
void read_into(const JsonReader&, std::size_t&);
void read_into(const JsonReader&, int&);
void read_into(const JsonReader&, std::vector<std::string>&);
void read_into(const JsonReader&, std::map<std::string, std::string>&);
void read_into(const JsonReader&, std::map<std::string, double>&);

/// A member of a struct and its name in JSON. A tuple of these writes and reads the struct.
template <class Struct, class Value>
struct Field {
  const char* name;
  Value Struct::*member;
};
template <class Struct, class Value>
Field(const char*, Value Struct::*) -> Field<Struct, Value>;
/// A JSON object with these members of a struct, in the order of the tuple.
template <class Struct, class... Values>
Json json_of(const Struct& object, const std::tuple<Field<Struct, Values>...>& fields) {
  Json json;
  std::apply([&](const auto&... one) { ((json[one.name] = object.*one.member), ...); }, fields);
  return json;
}
/// Reads these members of a struct with read_into(). Throws InputError.
template <class Struct, class... Values>
void read_into(const JsonReader& json, Struct& object,
               const std::tuple<Field<Struct, Values>...>& fields) {
  std::apply([&](const auto&... one) { (read_into(json.at(one.name), object.*one.member), ...); },
             fields);
}
template <class Struct, class... Values>
Struct read_as(const JsonReader& json, const std::tuple<Field<Struct, Values>...>& fields) {
  Struct object;
  read_into(json, object, fields);
  return object;
}

/// The parsed text; throws InputError that names the file.
Json parse_json_of(std::string_view text, const std::string& file, int line = 0);

/// Parses a text from that file and returns read(its root). Throws InputError.
template <class Read>
auto read_json(std::string_view text, const std::string& file, Read read, int line = 0) {
  const Json json = parse_json_of(text, file, line);
  return read(JsonReader(json, file, line));
}

/// Returns the results of `read` for each line of a file. Throws InputError with file and line.
template <class Read>
auto read_json_lines(const std::filesystem::path& file, Read read) {
  std::vector<decltype(read(std::declval<JsonReader>()))> all;
  std::istringstream lines(read_text(file));
  for (std::string line; std::getline(lines, line);)
    all.push_back(read_json(line, file.string(), read, static_cast<int>(all.size()) + 1));
  return all;
}

}  // namespace taut
