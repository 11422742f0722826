#pragma once

#include <algorithm>
#include <concepts>
#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace taut {

/// A condition on each word that an option gets.
struct Condition {
  std::string shown;  ///< in the help, after the type of the option
  std::function<std::string(const std::string& word)> complaint;  ///< "" if the word is right
};

/// An option, a flag or a positional argument of a verb, as data.
struct Argument {
  /// What is set: a variable, or a function that gets the value.
  using Target = std::variant<bool*, int*, double*, std::optional<double>*, std::string*,
                              std::filesystem::path*, std::vector<int>*, std::vector<double>*,
                              std::vector<std::string>*, std::function<void(double)>,
                              std::function<void(const std::string&)>,
                              std::function<void(const std::vector<std::string>&)>>;

  Argument& required(bool yes = true) { return set(is_required, yes); }
  Argument& check(Condition one) {
    conditions.push_back(std::move(one));
    return *this;
  }
  Argument& delimiter(char between) { return set(separator, between); }
  Argument& expected(int least, int most) { return set(counts, std::pair(least, most)); }
  /// A word each time that the option is given; without this a list takes all words that follow.
  Argument& one_each() { return set(takes_one, true); }
  /// Takes all words that follow, although the help shows one.
  Argument& repeated() { return set(is_repeated, true); }
  Argument& needs(const char* other) { return add(needed, other); }
  Argument& excludes(const char* other) { return add(excluded, other); }
  Argument& group(const char* heading) { return set(heading_of_group, heading); }
  Argument& hidden() { return group(""); }
  /// Shows this default in the help, or else the value that the target has now.
  Argument& shows_default(const char* text = "") { return set(default_text, text); }

  std::string names;  ///< "-o,--output"; "SCENE": by its position
  Target target;
  std::string help;
  bool is_flag = false;
  bool is_required = false, takes_one = false, is_repeated = false;
  char separator = 0;  ///< between the values in a word; 0: a word is a value
  std::optional<std::pair<int, int>> counts = {};  ///< fewest and most words
  std::vector<Condition> conditions = {};
  std::vector<std::string> needed = {}, excluded = {};  ///< names of other arguments
  std::optional<std::string> heading_of_group = {}, default_text = {};

 private:
  template <class Member, class Value>
  Argument& set(Member& member, const Value& value) {
    member = value;
    return *this;
  }
  Argument& add(std::vector<std::string>& others, const char* other) {
    others.emplace_back(other);
    return *this;
  }
};

/// What a verb accepts. The verb describes it here, and parser.cpp alone compiles CLI11, of which a
/// file takes six seconds.
class Arguments {
 public:
  Argument& add_option(std::string names, Argument::Target target, std::string help) {
    all_.push_back({std::move(names), std::move(target), std::move(help)});
    return all_.back();
  }
  template <class Value>
  requires std::constructible_from<Argument::Target, Value*> Argument& add_option(
      std::string names, Value& value, std::string help) {
    return add_option(std::move(names), Argument::Target(&value), std::move(help));
  }
  /// A flag of type string gets "true", or TEXT from --flag=TEXT.
  template <class Value>
  Argument& add_flag(std::string names, Value& value, std::string help) {
    Argument& one = add_option(std::move(names), value, std::move(help));
    one.is_flag = true;
    return one;
  }
  /// Precondition: it was added under this name alone.
  Argument& at(const std::string& name) { return *std::ranges::find(all_, name, &Argument::names); }
  const std::deque<Argument>& all() const { return all_; }

 private:
  std::deque<Argument> all_;  // references stay valid
};

}  // namespace taut
