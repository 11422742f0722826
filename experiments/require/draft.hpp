#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/io/document.hpp"
#include "experiments/case/record.hpp"

namespace taut {

/// A scene and a solver as texts that can be edited before they become a case.
class Draft {
 public:
  /// Throws InputError as make_case() does.
  explicit Draft(const CaseSpec&);

  /// Sets [section] key of the scene to a value, given as TOML or as it was read.
  void set(const std::string& section, const std::string& key, const std::string& toml);
  void set(const std::string& section, const std::string& key, Value);
  /// Removes [section], or a key of it or of each [[section]]. Does nothing if it does not exist.
  void remove(const std::string& section);
  void remove(const std::string& section, const std::string& key);
  /// The array of tables [[section]]; nullptr if the scene has none. Tables that are left empty are
  /// not written, so that the indices of the others stay valid while several are changed.
  std::vector<Value>* tables(const std::string& section);
  bool has(const std::string& section) const { return scene_.root.find(section); }
  const Value* find(const std::string& section, const std::string& key) const;

  /// Sets a parameter of the solver. Precondition: the solver has it.
  void set_parameter(const std::string& name, const std::string& value);

  /// The spec of the case. It is unchanged if the scene is; otherwise the scene is written to a
  /// file of this name in `folder`. With a comment (lines that start with #) the file is always
  /// written. Throws InputError if it cannot be.
  CaseSpec write(const std::filesystem::path& folder, const std::string& name,
                 const std::string& comment = "") const;

 private:
  Value& section(const std::string& name);
  /// Replaces a fabric by the keys that it sets, so that each can be removed.
  void unfold_fabric();
  CaseSpec spec_;
  std::filesystem::path file_;  ///< file of the scene
  Document scene_;
  std::map<std::string, std::string> changed_;
  bool scene_changed_ = false;
};

/// The value of a TOML text. Throws InputError.
Value toml_value(const std::string& toml);

}  // namespace taut
