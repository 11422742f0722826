#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/io/document.hpp"
#include "experiments/case/record.hpp"

namespace taut {

/// A scene and a solver as texts that can be changed before they become a case.
class Draft {
 public:
  /// Throws InputError as make_case() does.
  explicit Draft(const CaseSpec&);

  /// Replaces or adds [section] key of the scene; the value as TOML, or as it was read.
  void set(const std::string& section, const std::string& key, const std::string& toml);
  void set(const std::string& section, const std::string& key, Value);
  /// Takes away [section], or a key of it or of each [[section]]; what is not there stays away.
  void remove(const std::string& section);
  void remove(const std::string& section, const std::string& key);
  /// The array of tables [[section]]; nullptr: the scene has none. A table that is left empty is
  /// not written: the numbers of the others stay while several change.
  std::vector<Value>* tables(const std::string& section);
  bool has(const std::string& section) const { return scene_.root.find(section); }
  const Value* find(const std::string& section, const std::string& key) const;

  /// Replaces a parameter of the solver. Precondition: it has one of this name.
  void set_parameter(const std::string& name, const std::string& value);

  /// The case's spec: as it was given if the scene is unchanged, else the scene as a file of this
  /// name in `folder`, which is written. With a comment, in lines with #, it is written anyway.
  /// Throws InputError if it cannot be.
  CaseSpec write(const std::filesystem::path& folder, const std::string& name,
                 const std::string& comment = "") const;

 private:
  Value& section(const std::string& name);
  /// What a fabric sets, key by key, so that each may go.
  void unfold_fabric();
  CaseSpec spec_;
  std::filesystem::path file_;  ///< of the scene
  Document scene_;
  std::map<std::string, std::string> changed_;
  bool scene_changed_ = false;
};

/// The value that a text is in TOML. Throws InputError.
Value toml_value(const std::string& toml);

}  // namespace taut
