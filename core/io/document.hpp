#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/model/input_error.hpp"

namespace taut {

/// Where a value was written.
struct SourceLocation {
  int line = 0;       ///< 1-based; 0: unknown
  int column = 0;     ///< 1-based; 0: unknown
  int override = -1;  ///< index into Document::overrides; -1: the file itself
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
};

/// "a table", "a whole number", ...
std::string describe(const Value&);

/// A TOML file whose values were replaced by the overrides.
struct Document {
  std::string file;  ///< as the user named it
  std::vector<std::string> overrides;
  Value root;

  Diagnostic diagnostic(const SourceLocation&, const std::string& message) const;
};

/// Reads a TOML file. An override is a TOML assignment with a dotted key ("time.dt=\"1/120\""); it
/// replaces the value or adds it; a number selects an element of an array
/// ("collider.0.radius=0.4"). Throws InputError with every malformed part: the file's first syntax
/// error (duplicate keys are one) and each malformed override.
Document read_document(const std::filesystem::path&, const std::vector<std::string>& overrides);

/// The same for text that is already in memory.
Document parse_document(const std::string& file, const std::string& text,
                        const std::vector<std::string>& overrides);

/// The document as TOML, without comments: it reads back as the same values. Throws InputError for
/// a date or time, which no document of ours has.
std::string to_toml(const Value& root);

}  // namespace taut
