#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/io/section.hpp"
#include "experiments/case/case.hpp"

namespace taut {

/// A scene and a solver as texts that can be changed before they become a case.
class Draft {
 public:
  /// Throws InputError as make_case() does.
  explicit Draft(const CaseSpec&);

  /// Replaces or adds [section] key of the scene; the value as TOML, or as it was read.
  void set(const std::string& section, const std::string& key, const std::string& toml);
  void set(const std::string& section, const std::string& key, Value);
  /// Takes away [section] or its key; what is not there stays away.
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
  CaseSpec spec_;
  std::filesystem::path file_;  ///< of the scene
  Document scene_;
  std::string solver_;  ///< the entry's name
  std::map<std::string, std::string> changed_;
  bool scene_changed_ = false;
};

/// Takes a key out of a table; one that it does not have is none the less gone.
void erase_key(Value& table, const std::string& key);

/// The value that a text is in TOML. Throws InputError.
Value toml_value(const std::string& toml);

/// One step towards less: what it does, in words, and to a draft.
struct Reduction {
  std::string change;  ///< "gone", "5 -> 2"
  std::function<void(Draft&)> apply;
};

/// A part of a model that may not be needed, or a number that may be coarser than it is.
struct Effect {
  std::string name;                   ///< "bend links", "substeps"
  std::vector<Reduction> reductions;  ///< from the weakest to the strongest; one at least
};

/// What there is to take away or to coarsen in a case: bend and shear links, wind and its law,
/// damping, friction, each collider, self-collision, contact of faces, continuous detection,
/// thickness, tethers, levels, substeps, sweeps, precision, resolution, duration. What the case
/// does not have is not listed.
std::vector<Effect> effects_of(const Case&);

/// The same simulation with differences that mean nothing: what it moves by under them is noise.
struct Perturbations {
  std::vector<CaseSpec> rounding;  ///< one free vertex starts off by 2^-23 of the cloth's extent
  std::vector<CaseSpec> order;     ///< the links in another order; empty: the solver offers none
};

/// Scenes that are made for it are written to `folder`. Throws InputError if they cannot be.
Perturbations perturbations(const Case&, const std::filesystem::path& folder);

}  // namespace taut
