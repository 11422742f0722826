#pragma once

#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/model/input_error.hpp"
#include "core/model/scene_keys.hpp"
#include "core/model/scene_setting.hpp"
#include "core/model/vec3.hpp"

namespace taut {

/// Where a value is written.
struct SourceLocation {
  int line = 0;      ///< 1-based; 0: unknown
  int column = 0;    ///< 1-based; 0: unknown
  int setting = -1;  ///< index into Document::settings; -1: the file itself
  bool operator==(const SourceLocation&) const = default;
};

/// A key of a table.
struct Key {
  std::string text;
  SourceLocation place;
};

/// A value of a TOML document, with its place in the document.
struct Value {
  enum class Kind { boolean, integer, real, string, array, table, date };
  Kind kind = Kind::table;
  SourceLocation place;
  bool boolean = false;
  double number = 0;         ///< of integers, too
  std::string string;        ///< strings only
  std::vector<Value> items;  ///< of an array, or of a table, where items[i] belongs to keys[i]
  std::vector<Key> keys;     ///< of a table, in the order of the document

  bool is_table() const { return kind == Kind::table; }
  bool is_array() const { return kind == Kind::array; }
  bool is_string() const { return kind == Kind::string; }
  bool is_number() const { return kind == Kind::integer || kind == Kind::real; }
  /// Nullptr if this is not a table or does not have the key.
  const Value* find(const std::string& key) const;
  /// Index of the last setting that set a part of the value; -1: all of it is from the file.
  int latest_setting() const;
};

/// "a table", "a whole number", ...
std::string describe(const Value&);

/// A TOML file with settings applied.
struct Document {
  std::string file;  ///< as the user named it
  SceneSettings settings;
  Value root;

  Diagnostic diagnostic(const SourceLocation&, const std::string& message) const;
};

/// Reads a TOML file. A setting is a TOML assignment with a dotted key (time.dt="1/120"), which
/// replaces or adds a value; a number selects an element of an array ("collider.0.radius=0.4").
/// Throws InputError with every malformed part: the file's first syntax error (including duplicate
/// keys) and each malformed setting.
Document read_document(const std::filesystem::path&, const SceneSettings&);

/// read_document() for text in memory.
Document parse_document(const std::string& file, const std::string& text, const SceneSettings&);

/// Writes the document as TOML, without comments; it reads back as the same values. Throws
/// InputError for a date or time, which no document of taut has.
std::string to_toml(const Value& root);

/// Collects all errors of a document.
class Diagnostics {
 public:
  explicit Diagnostics(const Document& document) : document_(document) {}
  void report(const SourceLocation& place, const std::string& message) {
    found_.push_back(document_.diagnostic(place, message));
  }
  void report(std::vector<Diagnostic> more) {
    for (Diagnostic& d : more) found_.push_back(std::move(d));
  }
  bool clean() const { return found_.empty(); }
  /// Adds a sentence for the user about something that is not wrong, but not used either, or was
  /// changed. `place`: what is reported of that place repeats it.
  void remark(const std::string& sentence, const SourceLocation& place = {}) {
    remarks_.push_back(sentence);
    if (place.line > 0 || place.setting >= 0) remarks_at_.emplace_back(place, sentence);
  }
  const std::vector<std::string>& remarks() const { return remarks_; }
  /// "; " and a sentence, for each remark of that place.
  std::string remarks_at(const SourceLocation&) const;
  /// Throws InputError with everything that was reported, in the order of the file, if anything
  /// was.
  void throw_if_any();

 private:
  const Document& document_;
  std::vector<Diagnostic> found_;
  std::vector<std::string> remarks_;
  std::vector<std::pair<SourceLocation, std::string>> remarks_at_;
};

/// Reads the keys of one table. Every key that is asked for becomes known; finish() reports the
/// others. A wrong value is reported and then treated as absent, so that reading goes on.
class Section {
 public:
  /// name: as messages print it, "[cloth]". scene_section: section of scene_keys(), "cloth", whose
  /// units messages name; "": none.
  Section(Diagnostics& diagnostics, const Value& table, std::string name,
          std::string scene_section = "");
  Section(Section&&) = default;

  const SourceLocation& place() const { return table_.place; }
  const std::string& name() const { return name_; }
  const std::string& scene_section() const { return scene_section_; }
  Diagnostics& diagnostics() { return diagnostics_; }
  /// The raw value; nullptr if absent.
  const Value* find(const std::string& key);
  /// Place of the key, or of the section if the key is absent.
  SourceLocation place(const std::string& key) const;
  /// Marks every key of its section of a scene as known.
  void know();
  void missing(const std::string& key);
  /// Reports those of the keys that are absent.
  void need(std::initializer_list<std::string_view> keys);
  void report(const std::string& key, const std::string& message);

  std::optional<double> number(const std::string& key, const Range&);
  double number(const std::string& key, const Range& range, double fallback) {
    return number(key, range).value_or(fallback);
  }
  /// range: of each component.
  std::optional<Vec3> vec3(const std::string& key, const Range&);
  Vec3 vec3(const std::string& key, const Range& range, const Vec3& fallback) {
    return vec3(key, range).value_or(fallback);
  }
  /// A direction of any length but zero, returned as a unit vector.
  Vec3 direction(const std::string& key, const Vec3& fallback);
  /// An array of `count` numbers.
  std::optional<std::vector<double>> numbers(const std::string& key, std::size_t count,
                                             const Range&);
  bool boolean(const std::string& key, bool fallback);
  std::optional<std::string> string(const std::string& key);
  /// A list of strings; empty optional if it is absent or not a list.
  std::optional<std::vector<std::string>> strings(const std::string& key);
  std::string choice(const std::string& key, const std::vector<std::string>& choices,
                     const std::string& fallback);
  /// A table; nullptr if absent.
  const Value* table(const std::string& key);
  /// The elements of an array of tables.
  std::vector<const Value*> tables(const std::string& key);

  /// Reports every unknown key, with a guess at what was meant: another key, or one of the paths
  /// `elsewhere` that ends in it.
  void finish(const std::vector<std::string>& elsewhere = {});

 private:
  std::optional<double> judged(const Value&, const std::string& key, const Range&);
  void wrong_type(const Value&, const std::string& key, const std::string& wanted);
  /// " in s"; "" if the unit is not known.
  std::string in_unit(const std::string& key) const;

  Diagnostics& diagnostics_;
  const Value& table_;
  std::string name_, scene_section_;
  std::vector<std::string> known_;
};

/// The value of a number or of a fraction such as "1/64"; empty if it is neither. May be
/// non-finite.
std::optional<double> as_number(const Value&);

}  // namespace taut
