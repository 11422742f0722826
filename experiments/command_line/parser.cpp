#include "experiments/command_line/parser.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <locale>
#include <optional>
#include <span>
#include <sstream>
#include <type_traits>

#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/fingerprint.hpp"
#include "experiments/command_line/streams.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/system/data.hpp"

namespace taut {

namespace {

constexpr const char* kGroups[] = {"Studies", "One case", "Cost", "Trust", "Extremes"};

CLI::Validator validator(const Condition& condition) {
  return CLI::Validator(
      [complain = condition.complaint](std::string& word) { return complain(word); },
      condition.shown);
}

/// Lets a real be a quotient, such as 24000/1001. What is no number is left for the conditions.
std::string evaluated(std::string& word) {
  try {
    word = shortest(parse_number(word));
  } catch (const InputError&) {
  }
  return "";
}

template <class Value>
constexpr bool kIsReal =
    std::is_same_v<Value, double*> || std::is_same_v<Value, std::optional<double>*> ||
    std::is_same_v<Value, std::vector<double>*> ||
    std::is_same_v<Value, std::function<void(double)>>;

template <class Value>
CLI::Option* add(CLI::App& app, const Argument& one, Value* to) {
  if constexpr (std::is_same_v<Value, bool> || std::is_same_v<Value, std::string>)
    if (one.is_flag) return app.add_flag(one.names, *to, one.help);
  return app.add_option(one.names, *to, one.help);
}
template <class Value>
CLI::Option* add(CLI::App& app, const Argument& one, const std::function<void(Value)>& to) {
  return app.add_option_function<std::remove_cvref_t<Value>>(one.names, to, one.help);
}

void add_argument(CLI::App& app, const Argument& one) {
  CLI::Option* const option =
      std::visit([&](const auto& to) { return add(app, one, to); }, one.target);
  option->required(one.is_required);
  if (std::visit([](const auto& to) { return kIsReal<std::remove_cvref_t<decltype(to)>>; },
                 one.target))
    option->transform(CLI::Validator(evaluated, ""));
  for (const Condition& condition : one.conditions) option->check(validator(condition));
  if (one.separator) option->delimiter(one.separator);
  if (one.counts) option->expected(one.counts->first, one.counts->second);
  if (one.takes_one) option->allow_extra_args(false);
  if (one.is_repeated) option->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  if (one.heading_of_group) option->group(*one.heading_of_group);
  if (!one.default_text) return;
  if (one.default_text->empty())
    option->capture_default_str();
  else
    option->default_str(*one.default_text);
}

void add_arguments(CLI::App& app, const Arguments& args) {
  for (const Argument& one : args.all()) add_argument(app, one);
  const auto option = [&](const std::string& names) {
    return app.get_option(names.substr(names.find(',') + 1));
  };
  for (const Argument& one : args.all()) {
    for (const std::string& other : one.needed) option(one.names)->needs(option(other));
    for (const std::string& other : one.excluded) option(one.names)->excludes(option(other));
  }
}

/// A verb and its parser.
struct Verb {
  CLI::App* app;
  std::function<int()> run;
};

/// Adds the verb's options and --quiet to its parser. Returns the function to call once they are
/// parsed.
std::function<int()> bind(const VerbEntry& entry, CLI::App& app) {
  if (!entry.bind) app.require_subcommand(1);
  Arguments args;
  std::function<int()> run = entry.bind ? entry.bind(args) : [] { return int{kUsage}; };
  add_arguments(app, args);
  const auto quiet = std::make_shared<bool>(false);
  app.add_flag("--quiet", *quiet, "Print nothing but errors; the exit code says how it went");
  return [run = std::move(run), quiet] {
    std::optional<DiscardedOutput> discarded;
    if (*quiet) {
      discarded.emplace();
      show_progress(false);
    }
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

/// Adds the parser of one verb and its subverbs, or of all verbs if `only` is "", although most are
/// not needed then. Verbs come in the order of their groups, followed by subverbs.
std::vector<Verb> add_verbs(CLI::App& app, const std::string& only) {
  std::vector<const VerbEntry*> entries(verbs().begin(), verbs().end());
  if (!only.empty())
    std::erase_if(entries, [&](const VerbEntry* e) {
      return e->name != only && !e->name.starts_with(only + " ");
    });
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

std::string roff(const std::string& text) {
  std::string out;
  bool first = true;
  for (const char c : text) {
    if (first && (c == '.' || c == '\'')) out += "\\&";
    first = c == '\n';
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out;
}

std::vector<const CLI::Option*> visible_options(const CLI::App& app) {
  return app.get_options([](const CLI::Option* o) { return !o->get_group().empty(); });
}

void add_entry(std::string& out, const CLI::App& verb, const std::string& before) {
  const std::string name = before + verb.get_name();
  out += ".TP\n.B " + roff(name) + "\n" + roff(verb.get_description()) + "\n.RS\n";
  for (const CLI::Option* option : visible_options(verb)) {
    const bool positional = option->get_positional();
    out += ".TP\n\\fB" + roff(option->get_name(positional, !positional)) + "\\fR\n" +
           roff(option->get_description()) + "\n";
  }
  if (!verb.get_footer().empty()) out += ".PP\n.nf\n" + roff(verb.get_footer()) + "\n.fi\n";
  out += ".RE\n";
  for (const CLI::App* inner : verb.get_subcommands({})) add_entry(out, *inner, name + " ");
}

/// Words that may follow a verb: its subverbs, its options, and names for its positional arguments.
std::string words_after(const CLI::App& verb) {
  std::vector<std::string> words;
  for (const CLI::App* inner : verb.get_subcommands({})) words.push_back(inner->get_name());
  for (const CLI::Option* option : visible_options(verb)) {
    for (const std::string& name : option->get_lnames()) words.push_back("--" + name);
    const std::string position = option->get_name(true, false);
    if (position == "STUDY" || position == "WHAT") words.push_back(join(shipped("studies"), " "));
    if (position == "KIND") words.emplace_back("study scene");
    if (position == "SCENE" || position == "WHAT") words.push_back(join(shipped("scenes"), " "));
    if (position == "SOLVER" || option->check_lname("solver"))
      for (const SolverEntry* entry : solvers()) words.emplace_back(entry->name);
  }
  return join(words, " ");
}

void add_completion(std::string& out, const CLI::App& verb, const std::string& before) {
  for (const CLI::App* inner : verb.get_subcommands({}))  // longer names first
    add_completion(out, *inner, before + verb.get_name() + " ");
  out += "    '" + before + verb.get_name() + " '*) words='" + words_after(verb) + "' ;;\n";
}

/// A manual page in roff, with every verb, its options and its example.
std::string man_page(const CLI::App& app, const std::string& version) {
  std::string out = ".TH TAUT 1 \"\" \"taut " + version + "\"\n.SH NAME\ntaut \\- " +
                    roff(app.get_description()) +
                    "\n.SH SYNOPSIS\n.B taut\n.I VERB\n[\\fIARGUMENT\\fR ...]\n.SH VERBS\n";
  std::string group;
  for (const CLI::App* verb : app.get_subcommands({})) {
    if (verb->get_group() != group) out += ".SS " + (group = verb->get_group()) + "\n";
    add_entry(out, *verb, "");
  }
  return out + R"(.SH EXIT STATUS
0: passed. 1: a regression, a status change, a broken truth or an external program that failed. 2:
bad usage or input. 3: some cases are missing. 4: nothing was compared or found. 5: another environment. 6: another result under the
same key. 130: interrupted.
)";
}

/// A completion script for bash: verbs, their options, and names of scenes, studies and solvers.
std::string bash_completion(const CLI::App& app) {
  std::vector<std::string> verbs;
  std::string cases;
  for (const CLI::App* verb : app.get_subcommands({})) {
    verbs.push_back(verb->get_name());
    add_completion(cases, *verb, "");
  }
  return "_taut() {\n  local words='" + join(verbs, " ") +
         "'\n  ((COMP_CWORD == 1)) || case \"${COMP_WORDS[*]:1:COMP_CWORD-1} \" in\n" + cases +
         "    *) words= ;;\n  esac\n"
         "  COMPREPLY=($(compgen -W \"$words\" -- \"${COMP_WORDS[COMP_CWORD]}\"))\n}\n"
         "complete -o default -F _taut taut\n";
}

/// Refuses "--out=": CLI11 would take the next word for its value, even an option.
void refuse_empty_values(int argc, char** argv) {
  for (const std::string_view word : std::span(argv, static_cast<std::size_t>(argc)).subspan(1))
    if (word.starts_with("--") && word.find('=') == word.size() - 1)
      throw InputError(std::string(word) + ": a value is missing");
}

/// "'--jsno' is no option of this verb; did you mean '--json'?"; "" if every option is known or
/// none is near.
std::string meant(const CLI::App& app, int argc, char** argv) {
  const CLI::App* verb = &app;
  while (!verb->get_subcommands().empty()) verb = verb->get_subcommands().front();
  std::vector<std::string> known;
  for (const CLI::Option* option : verb->get_options())
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  for (const std::string_view word : std::span(argv, static_cast<std::size_t>(argc)).subspan(1)) {
    const std::string name(word.substr(0, word.find('=')));
    if (!name.starts_with("--") || std::ranges::count(known, name) > 0) continue;
    if (const std::string near = suggestion(name, known); !near.empty())
      return "'" + name + "' is no option of this verb" + near;
  }
  return "";
}

/// Admits every program and file that the command line names, in whichever option.
void admit_solvers(int argc, char** argv) {
  for (std::string_view word : std::span(argv, static_cast<std::size_t>(argc)).subspan(1)) {
    if (word.starts_with("--")) word.remove_prefix(std::min(word.size(), word.find('=') + 1));
    admit_solver(word);
  }
}

}  // namespace

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
  const bool has_verb = argc > 1 && argv[1][0] != '-';
  const std::vector<Verb> all = add_verbs(app, has_verb ? argv[1] : "");
  refuse_empty_values(argc, argv);
  admit_solvers(argc, argv);
  const std::string first = argc == 2 ? argv[1] : "";  // used by `cmake --install`
  if (first == "--man" || first == "--bash-completion") {
    std::cout << (first == "--man" ? man_page(app, TAUT_VERSION) : bash_completion(app));
    flush_output();
    return kPass;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream complaint;
    complaint.imbue(std::locale::classic());
    const int code = app.exit(error, std::cout, complaint);
    std::cerr << complaint.str();
    if (const std::string option = meant(app, argc, argv); code != 0 && !option.empty())
      std::cerr << option << '\n';
    if (code != 0) return kUsage;
    flush_output();
    return kPass;
  }
  const auto chosen = std::find_if(all.rbegin(), all.rend(),  // a subverb comes last
                                   [](const Verb& verb) { return verb.app->parsed(); });
  const int code = chosen->run();
  flush_output();
  return code;
}

}  // namespace taut
