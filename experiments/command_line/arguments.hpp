#pragma once

#include <initializer_list>
#include <string>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace taut {

/// What is demanded of an option; calls chain.
class Option {
 public:
  explicit Option(CLI::Option& option) : option_(&option) {}
  Option& required();
  Option& positive();
  Option& range(double lowest, double highest);
  Option& one_of(std::initializer_list<const char*> words);
  /// One value at a time: more of them repeat the option.
  Option& repeated();
  Option& values(int count);
  /// Several values in one word, as in 32,64.
  Option& separated_by(char);
  /// --help does not show it.
  Option& hidden();

 private:
  CLI::Option* option_;
};

/// The options of a verb. What a value holds before parsing is its default. CLI11 does the work, in
/// one translation unit instead of in every verb's.
class Arguments {
 public:
  explicit Arguments(CLI::App& app) : app_(&app) {}
  /// `name`: "-j,--jobs", or "STUDY" for a position. Value: a string, int, double, or a vector or
  /// optional of them.
  template <class Value>
  Option option(const std::string& name, Value& value, const std::string& help);
  Option flag(const std::string& name, bool& value, const std::string& help);
  /// A verb of the verb, such as `taut baseline update`; one of them has to be named.
  Arguments subverb(const std::string& name, const std::string& summary);
  /// Whether the user named this subverb. Precondition: parsing is done.
  bool named() const;

 private:
  CLI::App* app_;
};

}  // namespace taut
