#include "experiments/command_line/manual.hpp"

#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/system/data.hpp"

namespace taut {

namespace {

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

void add_verb(std::string& out, const CLI::App& verb, const std::string& before) {
  const std::string name = before + verb.get_name();
  out += ".TP\n.B " + roff(name) + "\n" + roff(verb.get_description()) + "\n.RS\n";
  for (const CLI::Option* option : visible_options(verb)) {
    const bool positional = option->get_positional();
    out += ".TP\n\\fB" + roff(option->get_name(positional, !positional)) + "\\fR\n" +
           roff(option->get_description()) + "\n";
  }
  if (!verb.get_footer().empty()) out += ".PP\n.nf\n" + roff(verb.get_footer()) + "\n.fi\n";
  out += ".RE\n";
  for (const CLI::App* inner : verb.get_subcommands({})) add_verb(out, *inner, name + " ");
}

/// What may follow a verb: its verbs, its options, and names that its positions take.
std::string words_after(const CLI::App& verb) {
  std::vector<std::string> words;
  for (const CLI::App* inner : verb.get_subcommands({})) words.push_back(inner->get_name());
  for (const CLI::Option* option : visible_options(verb)) {
    for (const std::string& name : option->get_lnames()) words.push_back("--" + name);
    const std::string position = option->get_name(true, false);
    if (position == "STUDY" || position == "WHAT") words.push_back(join(shipped("studies"), " "));
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

}  // namespace

std::string man_page(const CLI::App& app, const std::string& version) {
  std::string out = ".TH TAUT 1 \"\" \"taut " + version + "\"\n.SH NAME\ntaut \\- " +
                    roff(app.get_description()) +
                    "\n.SH SYNOPSIS\n.B taut\n.I VERB\n[\\fIARGUMENT\\fR ...]\n.SH VERBS\n";
  std::string group;
  for (const CLI::App* verb : app.get_subcommands({})) {
    if (verb->get_group() != group) out += ".SS " + (group = verb->get_group()) + "\n";
    add_verb(out, *verb, "");
  }
  return out + R"(.SH EXIT STATUS
0: passed. 1: a regression, a status change or a broken truth. 2: bad usage or input. 3: some cases
are missing. 4: nothing was compared or found. 5: another environment. 6: another result under the
same key. 130: interrupted.
)";
}

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

}  // namespace taut
