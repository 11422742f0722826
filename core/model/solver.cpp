#include "core/model/solver.hpp"

#include <sys/resource.h>

#include <ctime>

#include "core/model/input_error.hpp"

namespace taut {

namespace {
SolverSource g_source;
}

double Solver::cpu_seconds() const {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::size_t Solver::peak_bytes() const {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

std::string Solver::time_remark() const { return {}; }
std::string Solver::log() const { return {}; }

void set_solver_source(SolverSource source) { g_source = source; }

std::vector<const SolverEntry*> all_solvers() {
  std::vector<const SolverEntry*> all(solvers().begin(), solvers().end());
  if (!g_source.all) return all;
  for (const SolverEntry* entry : g_source.all()) all.push_back(entry);
  return all;
}

std::size_t projections_per_step(const Solver& solver) {
  std::size_t sum = 0;
  for (const PassCost& cost : solver.step_cost())
    if (cost.projections) sum += cost.items * cost.repeats;
  return sum;
}

const SolverEntry& find_solver(std::string_view name, std::string_view params) {
  for (const SolverEntry* entry : solvers())
    if (entry->name == name) return *entry;
  if (const SolverEntry* entry = g_source.find ? g_source.find(name, params) : nullptr)
    return *entry;
  std::vector<std::string> names;
  for (const SolverEntry* entry : all_solvers()) names.emplace_back(entry->name);
  throw InputError("unknown solver '" + std::string(name) + "'" +
                   suggestion(std::string(name), names) + " (`taut list solvers` names all)");
}

SolverChoice parse_solver(std::string_view text) {
  const auto colon = text.find(':');
  const std::string_view name = text.substr(0, colon);
  if (colon == std::string_view::npos) {
    const SolverEntry& entry = find_solver(name);
    return {&entry, Params(entry.name, entry.params, {})};
  }
  try {
    if (colon + 1 == text.size())
      throw InputError({{{}, 0, 1, "expected key=value after the colon"}});
    const SolverEntry& entry = find_solver(name, text.substr(colon + 1));
    return {&entry, Params(entry.name, entry.params, text.substr(colon + 1))};
  } catch (const InputError& error) {  // columns count from the start of the whole text
    std::vector<Diagnostic> all = error.diagnostics();
    for (Diagnostic& d : all) {
      if (d.column == 0) continue;
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
