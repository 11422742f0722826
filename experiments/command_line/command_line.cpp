#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>

#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/fingerprint.hpp"
#include "experiments/command_line/manual.hpp"
#include "experiments/command_line/progress.hpp"
#include "experiments/command_line/verb.hpp"

namespace taut {

namespace {

constexpr const char* kGroups[] = {"Studies", "One case", "Cost", "Trust", "Extremes"};

/// Discards what is written to stdout for as long as it lives.
class DiscardedOutput {
 public:
  DiscardedOutput() : stdout_(dup(1)) {
    std::cout << std::flush;
    std::fflush(stdout);
    const int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
    dup2(nothing, 1);
    close(nothing);
  }
  ~DiscardedOutput() {
    std::cout << std::flush;
    std::fflush(stdout);
    dup2(stdout_, 1);
    close(stdout_);
  }
  DiscardedOutput(const DiscardedOutput&) = delete;
  DiscardedOutput& operator=(const DiscardedOutput&) = delete;

 private:
  int stdout_;
};

/// A verb with its parser.
struct Verb {
  CLI::App* app;
  std::function<int()> run;
};

/// Adds the verb's options and --quiet to its parser and those within it; gives what to do once
/// they are parsed.
std::function<int()> bind(const VerbEntry& entry, CLI::App& app) {
  std::function<int()> run = entry.bind(app);
  const auto quiet = std::make_shared<bool>(false);
  std::vector<CLI::App*> parsers = app.get_subcommands({});  // of `baseline`: update and diff
  parsers.push_back(&app);
  for (CLI::App* parser : parsers)
    parser->add_flag("--quiet", *quiet, "Print nothing but errors; the exit code says how it went");
  return [run = std::move(run), quiet] {
    std::optional<DiscardedOutput> discarded;
    if (*quiet) discarded.emplace(), show_progress(false);
    return run();
  };
}

void add_verb(CLI::App& parent, const VerbEntry& entry, std::vector<Verb>& all) {
  const std::string_view name = entry.name.substr(entry.name.rfind(' ') + 1);
  CLI::App* app = parent.add_subcommand(std::string(name), std::string(entry.summary));
  app->formatter(std::make_shared<CLI::Formatter>());
  app->footer("Example:\n  " + std::string(entry.example));
  all.push_back({app, bind(entry, *app)});
}

/// The whole parser: verbs in the order of their groups, then verbs of verbs.
std::vector<Verb> add_verbs(CLI::App& app) {
  std::vector<const VerbEntry*> entries(verbs().begin(), verbs().end());
  const auto inner = [](const VerbEntry* e) { return e->name.find(' ') != std::string::npos; };
  std::ranges::stable_sort(entries, {},
                           [&](const VerbEntry* e) { return std::pair(inner(e), e->group); });
  std::vector<Verb> all;
  for (const VerbEntry* entry : entries)
    if (inner(entry)) {
      add_verb(*app.get_subcommand(std::string(entry->name.substr(0, entry->name.find(' ')))),
               *entry, all);
    } else {
      add_verb(app, *entry, all);
      all.back().app->group(kGroups[static_cast<int>(entry->group)]);
    }
  return all;
}

int parse_and_run(int argc, char** argv) {
  CLI::App app("taut: runs cloth solvers side by side on identical scenes and measures them");
  app.require_subcommand(1);
  app.get_formatter()->column_width(14);
  app.set_help_all_flag("--help-all", "Help of every verb");
  app.set_version_flag("--version", [] {
    return "taut " TAUT_VERSION "\nprogram " + program_digest().substr(0, 10) + "\n" +
           std::string(toolchain());
  });
  app.footer("`taut VERB --help` shows the options and an example of each verb.");
  const std::vector<Verb> all = add_verbs(app);
  const std::string first = argc == 2 ? argv[1] : "";  // for `cmake --install`
  if (first == "--man") return std::cout << man_page(app, TAUT_VERSION), kPass;
  if (first == "--bash-completion") return std::cout << bash_completion(app), kPass;
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream complaint;
    const int code = app.exit(error, std::cout, complaint);
    std::cerr << printable(complaint.str());
    return code == 0 ? kPass : kUsage;
  }
  const auto chosen = std::find_if(all.rbegin(), all.rend(),  // a verb of a verb is the last
                                   [](const Verb& verb) { return verb.app->parsed(); });
  const int code = chosen->run();
  if (!(std::cout << std::flush) || std::fflush(stdout) != 0)
    throw InputError("standard output cannot be written");
  return code;
}

const VerbEntry* find_verb(const std::string& name) {
  const auto found = std::ranges::find(verbs(), name, &VerbEntry::name);
  return found == verbs().end() ? nullptr : *found;
}

}  // namespace

int command_line(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // beyond a limit on files a write fails, and says so
  if (argc > 1 && argv[1][0] != '-' && !find_verb(argv[1])) {
    std::vector<std::string> names;
    for (const VerbEntry* verb : verbs()) names.emplace_back(verb->name);
    std::cerr << "unknown verb '" << printable(argv[1]) << "'" << suggestion(argv[1], names)
              << " (`taut --help` names all)\n";
    return kUsage;
  }
  try {
    return parse_and_run(argc, argv);
  } catch (const Interrupted&) {
    return kInterrupted;
  } catch (const std::bad_alloc&) {
    std::cerr << "out of memory\n";
  } catch (const InputError& error) {
    std::cerr << error.what() << '\n';
  } catch (const SolverFailure& failure) {
    std::cerr << failure.status << ": " << failure.what() << '\n' << failure.log;
  } catch (const std::filesystem::filesystem_error& error) {
    std::cerr << error.path1().string() << ": " << error.code().message() << '\n';
  }
  return kUsage;
}

int invoke(const std::string& name, std::vector<std::string> words, Output output) {
  const VerbEntry* verb = find_verb(name);
  if (!verb) throw InputError("this program has no verb '" + name + "'");
  CLI::App app(std::string(verb->summary), name);
  const std::function<int()> run = bind(*verb, app);
  std::reverse(words.begin(), words.end());  // CLI11 takes them from the back
  try {
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    throw InputError(name + ": " + error.what());
  }
  std::optional<DiscardedOutput> discarded;
  if (output == Output::discarded) discarded.emplace();
  return run();
}

}  // namespace taut
