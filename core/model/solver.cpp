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
  const auto params = colon == std::string_view::npos ? std::string_view{} : text.substr(colon + 1);
  return {&entry, Params(entry.name, entry.params, params)};
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
