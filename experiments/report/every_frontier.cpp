#include "experiments/report/every_frontier.hpp"

#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/report/plot/plot.hpp"
#include "experiments/study/frontier/parameter_frontier.hpp"
#include "experiments/system/text.hpp"

namespace taut::report {

namespace {

/// The solvers without default parameters. Throws InputError if one is unknown or named twice.
std::vector<std::string> brief_names(const std::vector<std::string>& texts) {
  std::vector<std::string> solvers;
  for (const std::string& text : texts) solvers.push_back(parse_solver(text).brief());
  if (solvers.size() == 2 && solvers[0] == solvers[1])
    throw InputError("--all: " + solvers[0] + " twice");
  return solvers;
}

}  // namespace

std::optional<EveryFrontier> find_every_frontier(const EveryFrontierWanted& wanted, Store& store) {
  const std::vector<std::string> solvers = brief_names(wanted.solvers);
  store.prepare();
  store.begin_session("taut frontier --all");
  std::vector<FrontierCheck> checks;
  std::vector<ParameterFrontier> found;
  for (const std::string& solver : solvers) {
    const auto frontiers = find_frontiers(solver, store, {.jobs = wanted.jobs, .frames = true},
                                          wanted.countdown(solver));
    if (!frontiers) return {};
    Answer answer = answer_of(*frontiers);
    answer.subject = solver;
    store.keep(answer);
    if (wanted.baseline != Baseline::ignore)
      checks.push_back(
          check_frontiers(answer, solver, wanted.baselines, wanted.baseline == Baseline::update));
    found.insert(found.end(), frontiers->begin(), frontiers->end());
  }
  EveryFrontier all{.answer = answer_of(found), .checks = std::move(checks), .no_picture = {}};
  all.answer.subject = join(solvers, " ");
  all.answer.add(commands_of(found));
  try {
    std::string stem = slug(solvers[0]);
    if (solvers.size() == 2) stem += "-and-" + slug(solvers[1]);
    all.answer.add({"picture"},
                   plot_frontiers(found, store.root() / kFrontiersFolder, stem).string());
  } catch (const PlotError& error) {
    all.no_picture = error.what();
  }
  return all;
}

}  // namespace taut::report
