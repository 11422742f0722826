#include "experiments/verbs/invoke.hpp"

#include <algorithm>

#include "core/model/input_error.hpp"
#include "experiments/verbs/verb.hpp"

namespace taut {

namespace {

const VerbEntry* find_verb(const std::string& name) {
  for (const VerbEntry* verb : verbs())
    if (verb->name == name) return verb;
  return nullptr;
}

}  // namespace

bool has_verb(const std::string& name) { return find_verb(name) != nullptr; }

int invoke(const std::string& name, std::vector<std::string> arguments) {
  const VerbEntry* verb = find_verb(name);
  if (!verb) throw InputError("this program has no verb '" + name + "'");
  CLI::App app(std::string(verb->summary), name);
  const std::function<int()> run = verb->bind(app);
  std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the back
  try {
    app.parse(arguments);
  } catch (const CLI::ParseError& error) {
    throw InputError(name + ": " + error.what());
  }
  return run();
}

}  // namespace taut
