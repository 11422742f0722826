#include "experiments/truths/conformance/conformance.hpp"

#include <cmath>

#include "core/model/solver.hpp"

namespace taut::conformance {

namespace {

std::string converged(const std::string& solver) {
  const SolverEntry* const entry = parse_solver(solver).entry;
  if (solver.find(':') != solver.npos || entry->foreign()) return solver;
  std::string text = solver;
  for (const ParamSpec& spec : entry->params) {
    if (spec.role == ParamSpec::Role::precision)
      text = with(text, std::string(spec.name) + "=double");
    if (!spec.name.empty() && spec.name == entry->accuracy.sweeps)
      text = with(text, std::string(spec.name) + "=1000");
  }
  return text;
}

}  // namespace

void for_each_solver(Findings& findings,
                     const std::function<void(const std::string& solver)>& check) {
  std::vector<std::string> all = findings.asked();
  if (all.empty())
    for (const SolverEntry* entry : solvers()) all.emplace_back(entry->name);
  std::erase(all, "reference");
  for (const std::string& asked : all) {
    const std::string solver = converged(asked);
    try {
      check(solver);
    } catch (const SolverFailure& failure) {
      findings.below(solver, std::string(to_string(failure.status)) + ": " + failure.what(), "1",
                     std::nan(""), 0);
    }
  }
}

Scene square() {
  Scene s = bare::sheet(2, 2);
  s.links.clear();
  s.mesh.mass = {0.3, 2, 0.7, 1.5};
  return s;
}

double own_stiffness(const std::string& solver, const Scene& scene) {
  const SolverChoice choice = parse_solver(solver);
  const ResolvedSettings settings = choice.entry->resolved_settings(scene, choice.params);
  const ResolvedSetting* const links = find_setting(settings, kLinksSetting);
  return links && std::isfinite(links->number) ? links->number : kRigid[0];
}

double first_passage(Simulation& sim, double seconds, const std::function<double()>& height) {
  const double dt = sim.scene().dt;
  double before = height();
  for (int n = 1; n * dt <= seconds; ++n) {
    sim.step();
    const double now = height();
    if (now <= 0) return (n - 1 + before / (before - now)) * dt;
    before = now;
  }
  return std::nan("");
}

}  // namespace taut::conformance
