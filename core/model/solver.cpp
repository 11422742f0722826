#include "core/model/solver.hpp"

#include "core/model/input_error.hpp"

namespace taut {

std::size_t projections_per_step(const Solver& solver) {
  std::size_t sum = 0;
  for (const PassCost& cost : solver.step_cost())
    if (cost.projections) sum += cost.items * cost.repeats;
  return sum;
}

const SolverEntry& find_solver(std::string_view name) {
  std::vector<std::string> names;
  for (const SolverEntry* entry : solvers()) {
    if (entry->name == name) return *entry;
    names.emplace_back(entry->name);
  }
  throw InputError("unknown solver '" + std::string(name) + "'" +
                   suggestion(std::string(name), names) + " (`taut list solvers` names all)");
}

SolverChoice parse_solver(std::string_view text) {
  const auto colon = text.find(':');
  const SolverEntry& entry = find_solver(text.substr(0, colon));
  if (colon == std::string_view::npos) return {&entry, Params(entry.name, entry.params, {})};
  try {
    if (colon + 1 == text.size())
      throw InputError({{{}, 0, 1, "expected key=value after the colon"}});
    return {&entry, Params(entry.name, entry.params, text.substr(colon + 1))};
  } catch (const InputError& error) {  // columns count from the start of the whole text
    std::vector<Diagnostic> all = error.diagnostics();
    for (Diagnostic& d : all) {
      d.column += static_cast<int>(colon) + 1;
      d.file = text;
    }
    throw InputError(all);
  }
}

std::string SolverChoice::canonical() const {
  const std::string params_text = params.canonical();
  return std::string(entry->name) + (params_text.empty() ? "" : ":" + params_text);
}

std::string SolverChoice::brief() const {
  const std::string params_text = params.brief();
  return std::string(entry->name) + (params_text.empty() ? "" : ":" + params_text);
}

}  // namespace taut
