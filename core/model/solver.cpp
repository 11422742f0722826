#include "core/model/solver.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <ctime>
#include <iterator>

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

void Solver::go_on(const Solver& before) {
  State state;
  before.store(state);
  load(state);
}

void Solver::displace(const std::vector<Vec3>& ways) {
  State state;
  store(state);
  for (std::size_t i = 0; i < ways.size(); ++i) state.x[i] += ways[i];
  load(state);
}

void set_solver_source(SolverSource source) { g_source = source; }

void admit_solver(std::string_view text) {
  const std::string name = solver_name(text);
  if (g_source.admit) g_source.admit(name, text.substr(std::min(text.size(), name.size() + 1)));
}

const ResolvedSetting* find_setting(const ResolvedSettings& all, std::string_view name) {
  const auto at = std::ranges::find(all, name, &ResolvedSetting::name);
  return at == all.end() ? nullptr : &*at;
}

std::vector<const SolverEntry*> all_solvers() {
  std::vector<const SolverEntry*> all(solvers().begin(), solvers().end());
  if (!g_source.names) return all;
  for (const std::string& name : g_source.names()) {
    admit_solver(name);
    all.push_back(&find_solver(name));
  }
  return all;
}

Stiffness stiffness_of(const Scene& scene, const Params& params) {
  if (params.has(kMaterial.name) && takes_stiffness(scene, params)) return scene.stiffness;
  Stiffness all = kRigid;
  for (const ParamSpec& spec : params.specs()) {
    if (!spec.rigid.empty() && params.is(spec.name, spec.rigid)) return kRigid;
    if (!spec.family) continue;
    double& k = all[static_cast<std::size_t>(*spec.family)];
    const double value = params.real(spec.name);
    if (!spec.is_compliance)
      k = value;
    else if (value > 0)
      k = 1 / value;
  }
  return all;
}

DeclaredStep implicit_euler_of_a_frame(const Scene& scene, const Params&) {
  DeclaredStep step{.stiffness = scene.stiffness, .of = "a frame"};
  if (scene.self_collision) step.none = "the exact step leaves out self-collision";
  return step;
}

DeclaredStep declared_step(const SolverEntry& entry, const Scene& scene, const Params& params) {
  if (entry.declared_step) return entry.declared_step(scene, params);
  return {.none = std::string(entry.name) + " declares no step"};
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
  for (const SolverEntry* entry : solvers()) names.emplace_back(entry->name);
  if (g_source.names) std::ranges::move(g_source.names(), std::back_inserter(names));
  throw InputError("unknown solver '" + std::string(name) + "'" +
                   suggestion(std::string(name), names) + " (`taut list solvers` names all)");
}

SolverChoice parse_solver(std::string_view text) {
  const std::size_t colon = text.find(':'),
                    params_at = colon == text.npos ? text.size() : colon + 1;
  const std::string_view params = text.substr(params_at);
  std::vector<Diagnostic> wrong;
  const auto report = [&](std::size_t at, const std::string& message) {
    wrong.push_back({std::string(text), 0, static_cast<int>(at) + 1, message});
  };
  SolverChoice choice;
  try {
    choice.entry = &find_solver(solver_name(text), params);
  } catch (const InputError& error) {
    for (const Diagnostic& d : error.diagnostics())
      d.line > 0 ? wrong.push_back(d) : report(0, d.message);
    for (const ParamItem& item : param_items(params))
      if (!item.problem.empty()) report(params_at + item.at, item.problem);
  }
  if (colon != text.npos && params.empty()) report(params_at, "expected key=value after the colon");
  if (choice.entry) try {
      choice.params = Params(choice.entry->name, choice.entry->params, params);
      // Turn columns of the parameters into columns of the whole text.
    } catch (const InputError& error) {
      for (const Diagnostic& d : error.diagnostics())
        report(params_at + static_cast<std::size_t>(d.column) - 1, d.message);
    }
  if (!wrong.empty()) throw InputError(wrong);
  return choice;
}

std::string solver_name(std::string_view text) {
  return std::string(text.substr(0, text.find(':')));
}

std::string with(std::string_view solver, std::string_view more) {
  std::string text(solver);
  if (more.empty()) return text;
  text += text.find(':') == std::string::npos ? ':' : ',';
  return text.append(more);
}

SolverChoice SolverChoice::with(std::string_view name, const std::string& value) const {
  return parse_solver(taut::with(entry->name, params.given_with(name, value)));
}

std::string SolverChoice::canonical() const { return with_params(false, ""); }

std::string SolverChoice::brief() const { return with_params(true, ""); }

std::string SolverChoice::with_params(bool only_changed, std::string_view but) const {
  return taut::with(entry->name, only_changed ? params.brief(but) : params.canonical(but));
}

}  // namespace taut
