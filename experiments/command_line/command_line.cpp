// The command line: options, verbs and what calls them. Only this file knows CLI11.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <optional>

#include "core/model/input_error.hpp"
#include "experiments/case/fingerprint.hpp"
#include "experiments/command_line/arguments.hpp"
#include "experiments/command_line/invoke.hpp"
#include "experiments/command_line/program.hpp"
#include "experiments/command_line/verb.hpp"

namespace taut {

Option& Option::required() { return option_->required(), *this; }
Option& Option::positive() { return option_->check(CLI::PositiveNumber), *this; }
Option& Option::range(double lowest, double highest) {
  return option_->check(CLI::Range(lowest, highest)), *this;
}
Option& Option::one_of(std::initializer_list<const char*> words) {
  return option_->check(CLI::IsMember(std::vector<std::string>(words.begin(), words.end()))), *this;
}
Option& Option::repeated() { return option_->allow_extra_args(false), *this; }
Option& Option::values(int count) { return option_->expected(count), *this; }
Option& Option::separated_by(char mark) { return option_->delimiter(mark), *this; }
Option& Option::hidden() { return option_->group(""), *this; }

template <class Value>
Option Arguments::option(const std::string& name, Value& value, const std::string& help) {
  return Option(*app_->add_option(name, value, help));
}
template Option Arguments::option(const std::string&, std::string&, const std::string&);
template Option Arguments::option(const std::string&, int&, const std::string&);
template Option Arguments::option(const std::string&, double&, const std::string&);
template Option Arguments::option(const std::string&, std::vector<std::string>&,
                                  const std::string&);
template Option Arguments::option(const std::string&, std::vector<int>&, const std::string&);
template Option Arguments::option(const std::string&, std::vector<double>&, const std::string&);
template Option Arguments::option(const std::string&, std::optional<double>&, const std::string&);

Option Arguments::flag(const std::string& name, bool& value, const std::string& help) {
  return Option(*app_->add_flag(name, value, help));
}

Arguments Arguments::subverb(const std::string& name, const std::string& summary) {
  app_->require_subcommand(1);
  return Arguments(*app_->add_subcommand(name, summary));
}

bool Arguments::named() const { return app_->parsed(); }

namespace {

const VerbEntry* find_verb(const std::string& name) {
  for (const VerbEntry* verb : verbs())
    if (verb->name == name) return verb;
  return nullptr;
}

/// Parses and runs what follows the program's name.
int run_verb(int argc, char** argv) {
  CLI::App app("taut: runs cloth solvers side by side on identical scenes and measures them");
  app.require_subcommand(1);
  app.set_help_all_flag("--help-all", "Help of every verb");
  app.set_version_flag("--version", [] {
    return "taut " TAUT_VERSION "\nprogram " + program_digest().substr(0, 10) + "\n" +
           std::string(toolchain());
  });
  app.footer("`taut VERB --help` shows the options and an example of each verb.");
  int exit_code = kPass;
  for (const VerbEntry* verb : verbs()) {
    CLI::App* sub = app.add_subcommand(std::string(verb->name), std::string(verb->summary));
    sub->footer("Example:\n  " + std::string(verb->example));
    Arguments arguments(*sub);
    sub->callback([&exit_code, run = verb->bind(arguments)] { exit_code = run(); });
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kPass : kUsage;
  }
  return exit_code;
}

/// "bench kernels" is the verb bench-kernels, with options of its own.
std::vector<char*> join_verb(int argc, char** argv, std::string& joined) {
  std::vector<char*> words(argv, argv + argc);
  if (argc < 3) return words;
  joined = std::string(argv[1]) + "-" + argv[2];
  if (!has_verb(joined)) return words;
  words.erase(words.begin() + 1);
  words[1] = joined.data();
  return words;
}

}  // namespace

int command_line(int argc, char** argv) {
  if (argc > 1 && argv[1][0] != '-' && !has_verb(argv[1])) {
    std::vector<std::string> names;
    for (const VerbEntry* verb : verbs()) names.emplace_back(verb->name);
    std::cerr << "unknown verb '" << argv[1] << "'" << suggestion(argv[1], names)
              << " (`taut --help` names all)\n";
    return kUsage;
  }
  try {
    std::string joined;
    std::vector<char*> words = join_verb(argc, argv, joined);
    const int code = run_verb(static_cast<int>(words.size()), words.data());
    if (std::cout.flush()) return code;
    std::cerr << "the output cannot be written\n";
  } catch (const Interrupted&) {
    return kInterrupted;
  } catch (const std::bad_alloc&) {
    std::cerr << "out of memory\n";
  } catch (const InputError& error) {
    std::cerr << error.what() << '\n';
  } catch (const std::filesystem::filesystem_error& error) {
    std::cerr << error.path1().string() << ": " << error.code().message() << '\n';
  }
  return kUsage;
}

bool has_verb(const std::string& name) { return find_verb(name) != nullptr; }

int invoke(const std::string& name, std::vector<std::string> words) {
  const VerbEntry* verb = find_verb(name);
  if (!verb) throw InputError("this program has no verb '" + name + "'");
  CLI::App app(std::string(verb->summary), name);
  Arguments arguments(app);
  const std::function<int()> run = verb->bind(arguments);
  std::reverse(words.begin(), words.end());  // CLI11 takes them from the back
  try {
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    throw InputError(name + ": " + error.what());
  }
  return run();
}

}  // namespace taut
