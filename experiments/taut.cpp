// The command line: `taut VERB ...`. Each verb is a file in experiments/verbs.
#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "core/model/input_error.hpp"
#include "experiments/verbs/verb.hpp"

namespace {

/// The first word, if it is neither an option nor a verb.
std::string unknown_verb(int argc, char** argv, std::vector<std::string>& names) {
  for (const taut::VerbEntry* verb : taut::verbs()) names.emplace_back(verb->name);
  if (argc < 2 || argv[1][0] == '-') return {};
  return std::find(names.begin(), names.end(), argv[1]) == names.end() ? argv[1] : "";
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> names;
  if (const std::string word = unknown_verb(argc, argv, names); !word.empty()) {
    std::cerr << "unknown verb '" << word << "'" << taut::suggestion(word, names)
              << " (`taut --help` names all)\n";
    return taut::kUsage;
  }
  CLI::App app("taut: runs cloth solvers side by side on identical scenes and measures them");
  app.require_subcommand(1);
  app.set_help_all_flag("--help-all", "Help of every verb");
  app.footer("`taut VERB --help` shows the options and an example of each verb.");
  int exit_code = taut::kPass;
  for (const taut::VerbEntry* verb : taut::verbs()) {
    CLI::App* sub = app.add_subcommand(std::string(verb->name), std::string(verb->summary));
    sub->footer("Example:\n  " + std::string(verb->example));
    sub->callback([&exit_code, run = verb->bind(*sub)] { exit_code = run(); });
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? taut::kPass : taut::kUsage;
  } catch (const taut::InputError& error) {
    std::cerr << error.what() << '\n';
    return taut::kUsage;
  }
  return exit_code;
}
