#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/model/mesh.hpp"

namespace taut {

/// A parameter of a solver: its name, range, default and one line of help.
struct ParamSpec {
  enum class Kind { integer, real, choice, text };
  std::string_view name;
  Kind kind = Kind::real;
  std::string_view unit;           ///< "" if it has none
  std::string_view default_value;  ///< as typed
  double min = 0, max = 0;         ///< inclusive; numbers only
  std::string_view choices;        ///< "exact|sqrt-free"; choices only
  std::string_view help;           ///< one line
  /// Another default where a choice holds: "method=global".
  struct Elsewhere {
    std::string_view where = {}, default_value = {};
  };
  std::array<Elsewhere, 2> elsewhere = {};  ///< the last one that holds counts
  std::optional<Family> family = {};        ///< of the links whose stiffness [N/m] it is
  bool is_compliance = false;               ///< [m/N] instead of a stiffness
  std::string_view rigid = {};              ///< choice with which all links are rigid; "": none
  /// What a parameter means, for code that knows no solver by name.
  enum class Role {
    none,
    precision,      ///< the scalar type: "float" or "double"
    instructions,   ///< the instruction set of the kernels, which changes no bits; "auto" chooses
    contact_share,  ///< share of a depth that one pass over the contacts corrects
    face_contact    ///< whether faces of the cloth touch bodies, not only vertices: "on"
  };
  Role role = Role::none;

  /// A copy that has another default where `where` holds, at most twice.
  constexpr ParamSpec but(std::string_view where, std::string_view default_) const {
    ParamSpec same = *this;
    same.elsewhere[elsewhere[0].where.empty() ? 0 : 1] = {where, default_};
    return same;
  }
  /// A copy that is the stiffness of the links of this family [N/m], or their compliance [m/N].
  constexpr ParamSpec stiffness_of(Family family_) const {
    ParamSpec same = *this;
    same.family = family_;
    return same;
  }
  constexpr ParamSpec compliance_of(Family family_) const {
    ParamSpec same = stiffness_of(family_);
    same.is_compliance = true;
    return same;
  }
  /// A copy with this choice for rigid links, whatever stiffness other parameters have.
  constexpr ParamSpec rigid_with(std::string_view choice_) const {
    ParamSpec same = *this;
    same.rigid = choice_;
    return same;
  }
  /// A copy with that role.
  constexpr ParamSpec as(Role role_) const {
    ParamSpec same = *this;
    same.role = role_;
    return same;
  }
  /// The default for people: "1", "1; 3 with method=global".
  std::string defaults() const {
    std::string text(default_value);
    for (const auto& [where, default_there] : elsewhere)
      if (!where.empty()) text.append("; ").append(default_there).append(" with ").append(where);
    return text;
  }
  static constexpr ParamSpec integer(std::string_view name, std::string_view default_value,
                                     double min, double max, std::string_view help) {
    return {name, Kind::integer, "", default_value, min, max, "", help};
  }
  static constexpr ParamSpec real(std::string_view name, std::string_view unit,
                                  std::string_view default_value, double min, double max,
                                  std::string_view help) {
    return {name, Kind::real, unit, default_value, min, max, "", help};
  }
  static constexpr ParamSpec choice(std::string_view name, std::string_view default_value,
                                    std::string_view choices, std::string_view help) {
    return {name, Kind::choice, "", default_value, 0, 0, choices, help};
  }
};

/// Name of the parameter with that role; "": there is none.
std::string_view parameter_with(ParamSpec::Role, std::span<const ParamSpec>);
/// Usual name of a parameter with that role, for solvers that declare no roles, such as external
/// programs; "": none is usual.
std::string_view usual_name(ParamSpec::Role);

/// An item "key=value" of a solver's text. A value in quotes ('a, b' or "a, b") may contain commas;
/// a quote in it is written twice.
struct ParamItem {
  std::string key, value;  ///< the value without its quotes
  std::size_t at = 0;      ///< where it begins in the text
  std::string problem;  ///< why it is not key=value, such as a quote that is not closed; "": it is
};
std::vector<ParamItem> param_items(std::string_view text);

/// Validated values of all parameters of a solver.
class Params {
 public:
  Params() = default;
  /// `text` is "key=value,key=value" or empty. Throws InputError, which names `owner`, the key, the
  /// given value and what is allowed.
  Params(std::string_view owner, std::span<const ParamSpec>, std::string_view text);

  int integer(std::string_view name) const;
  double real(std::string_view name) const;
  std::string_view choice(std::string_view name) const;
  bool is(std::string_view name, std::string_view value) const { return choice(name) == value; }
  /// The meaning of a choice, from pairs of a value's name and its meaning.
  template <class T, std::size_t n>
  T one_of(std::string_view name, const std::pair<std::string_view, T> (&choices)[n]) const {
    std::size_t i = 0;
    while (choices[i].first != choice(name)) ++i;  // Params accepts no other value
    return choices[i].second;
  }
  bool has(std::string_view name) const { return find(name) < specs_.size(); }
  /// Whether the text gave the parameter a value. Otherwise it has its default.
  bool given(std::string_view name) const { return has(name) && given_[find(name)]; }
  /// Name of the solver whose parameters they are.
  const std::string& owner() const { return owner_; }

  /// "key=value,..." in declared order, without those that `but` names, "cmd|build". canonical()
  /// has all of them, brief() those that differ from their defaults.
  std::string canonical(std::string_view but = "") const { return text(false, but); }
  std::string brief(std::string_view but = "") const { return text(true, but); }
  /// The text of the given parameters, with this value for one of them.
  std::string given_with(std::string_view name, const std::string& value) const;
  /// The value in canonical form, without quotes.
  std::string_view value(std::string_view name) const;
  std::span<const ParamSpec> specs() const { return specs_; }

 private:
  std::string text(bool only_changed, std::string_view but) const;
  /// Default of a parameter, given the values of the others.
  std::string default_of(const ParamSpec&) const;
  std::size_t find(std::string_view name) const;
  std::string owner_;
  std::span<const ParamSpec> specs_;
  std::vector<std::string> values_;  ///< canonical text
  std::vector<bool> given_;
};

}  // namespace taut
