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

/// Where a value was written.
struct SourceLocation {
  int line = 0;      ///< 1-based; 0: unknown
  int column = 0;    ///< 1-based; 0: unknown
  int setting = -1;  ///< index into Document::settings; -1: the file itself
};

/// A key of a table.
struct Key {
  std::string text;
  SourceLocation place;
};

/// A value of a TOML document that remembers where it stands.
struct Value {
  enum class Kind { boolean, integer, real, string, array, table, date };
  Kind kind = Kind::table;
  SourceLocation place;
  bool boolean = false;
  double number = 0;         ///< integers too
  std::string string;        ///< strings only
  std::vector<Value> items;  ///< of an array, or of a table: items[i] belongs to keys[i]
  std::vector<Key> keys;     ///< tables only, in the order of the document

  bool is_table() const { return kind == Kind::table; }
  bool is_array() const { return kind == Kind::array; }
  bool is_string() const { return kind == Kind::string; }
  bool is_number() const { return kind == Kind::integer || kind == Kind::real; }
  const Value* find(const std::string& key) const;  ///< nullptr: a table without it, or no table
  /// The last setting that a part of it comes from; -1: all is from the file.
  int latest_setting() const;
};

/// "a table", "a whole number", ...
std::string describe(const Value&);

/// A TOML file whose values were replaced by the settings.
struct Document {
  std::string file;  ///< as the user named it
  SceneSettings settings;
  Value root;

  Diagnostic diagnostic(const SourceLocation&, const std::string& message) const;
};

/// Reads a TOML file. A setting is a TOML assignment with a dotted key (time.dt="1/120"); it
/// replaces the value or adds it; a number selects an element of an array
/// ("collider.0.radius=0.4"). Throws InputError with every malformed part: the file's first syntax
/// error (duplicate keys are one) and each malformed setting.
Document read_document(const std::filesystem::path&, const SceneSettings&);

/// The same for text that is already in memory.
Document parse_document(const std::string& file, const std::string& text, const SceneSettings&);

/// The document as TOML, without comments: it reads back as the same values. Throws InputError for
/// a date or time, which no document of ours has.
std::string to_toml(const Value& root);

/// Collects everything that is wrong with a document.
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
  /// What is not wrong, but not used either: a sentence for the user.
  void remark(const std::string& sentence) { remarks_.push_back(sentence); }
  const std::vector<std::string>& remarks() const { return remarks_; }
  /// Throws InputError with all that was reported, in the order of the file; returns if none was.
  void throw_if_any();

 private:
  const Document& document_;
  std::vector<Diagnostic> found_;
  std::vector<std::string> remarks_;
};

/// Reads the keys of one table. Every key that is asked for is known; finish() reports the others.
/// A value that is wrong is reported and then treated as absent, so that reading goes on.
class Section {
 public:
  /// `name` as messages print it: "[cloth]". `scene_section`: its section of scene_keys(), "cloth",
  /// whose units messages name; "": none.
  Section(Diagnostics& diagnostics, const Value& table, std::string name,
          std::string scene_section = "");
  Section(Section&&) = default;

  const SourceLocation& place() const { return table_.place; }
  const std::string& name() const { return name_; }
  Diagnostics& diagnostics() { return diagnostics_; }
  /// The raw value; nullptr if it is absent.
  const Value* find(const std::string& key);
  /// Where the key stands, or the section if it is absent.
  SourceLocation place(const std::string& key) const;
  /// Every key of its section of a scene is known.
  void know();
  void missing(const std::string& key);
  /// Reports those of the keys that are absent.
  void need(std::initializer_list<std::string_view> keys);
  void report(const std::string& key, const std::string& message);

  std::optional<double> number(const std::string& key, const Range&);
  double number(const std::string& key, const Range& range, double fallback) {
    return number(key, range).value_or(fallback);
  }
  /// The range is that of each component.
  std::optional<Vec3> vec3(const std::string& key, const Range&);
  Vec3 vec3(const std::string& key, const Range& range, const Vec3& fallback) {
    return vec3(key, range).value_or(fallback);
  }
  /// A direction: any length but zero; given back as a unit vector.
  Vec3 direction(const std::string& key, const Vec3& fallback);
  /// `count` numbers.
  std::optional<std::vector<double>> numbers(const std::string& key, std::size_t count,
                                             const Range&);
  bool boolean(const std::string& key, bool fallback);
  std::optional<std::string> string(const std::string& key);
  /// A list of strings; nothing if it is absent or no list.
  std::optional<std::vector<std::string>> strings(const std::string& key);
  std::string choice(const std::string& key, const std::vector<std::string>& choices,
                     const std::string& fallback);
  /// A table; nullptr if it is absent.
  const Value* table(const std::string& key);
  /// The elements of an array of tables.
  std::vector<const Value*> tables(const std::string& key);

  /// Reports every key that nobody asked for, with what may have been meant: another key, or one
  /// of those paths that ends in it.
  void finish(const std::vector<std::string>& elsewhere = {});

 private:
  std::optional<double> judged(const Value&, const std::string& key, const Range&);
  void wrong_type(const Value&, const std::string& key, const std::string& wanted);
  std::string in_unit(const std::string& key) const;  ///< " in s"; "": no unit is known

  Diagnostics& diagnostics_;
  const Value& table_;
  std::string name_, scene_section_;
  std::vector<std::string> known_;
};

/// The number that a value stands for: a number or a fraction such as "1/64"; nothing if it is
/// neither. May be non-finite.
std::optional<double> as_number(const Value&);

}  // namespace taut
