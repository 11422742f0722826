// What a run does not show.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/model/parts.hpp"
#include "experiments/report/questions/links.hpp"
#include "experiments/system/distinct.hpp"

namespace taut::report {

std::vector<std::string> limits_of(const ReportInput& input, const CaseList& refs) {
  std::set<double> steps, sweeps, substeps, ends;
  std::vector<std::string> scenes;
  for (const Record* r : refs.cases()) {
    push_unique(scenes, r->scene);
    steps.insert(r->dt);
    ends.insert(std::round(r->steps * r->dt * 100) / 100);
    if (const Work work = work_of(*r); work.sweeps > 0) {
      sweeps.insert(work.sweeps);
      substeps.insert(work.substeps);
    }
  }
  const auto range = [](const std::set<double>& values, const char* name) {
    return range_text(values, quantity(name));
  };
  std::vector<std::string> points{
      "Other scenes than " + joined(scenes) + ", simulated for " + range(ends, "t") + ".",
      "Other time steps than " + range(steps, "dt") +
          (sweeps.empty() ? ""
                          : ", other work than " + range(substeps, kSubsteps) + " substeps of " +
                                range(sweeps, kSweeps) + " sweeps") +
          "; not all combinations were run."};
  points.push_back(input.bench
                       ? "Cost on another machine than " + input.bench->machine +
                             ", or at settings between those timed (taut advise searches them)."
                       : "Cost: no CPU time was measured; equal sweeps are equal work, not equal "
                         "time.");
  std::map<std::string, std::vector<std::string>> computing;  // solver titles by arithmetic
  std::set<std::string> shown;
  for (const Record* r : refs.cases()) {
    shown.insert(r->solver);
    push_unique(computing[arithmetic_of(*r, input.vectors).text()], solver_title(r->solver));
  }
  if (computing.size() > 1)
    points.push_back(
        "Equal arithmetic: links are computed in " +
        join(computing, "; in ",
             [](const auto& one) { return one.first + " by " + joined(one.second); }) +
        ". CPU times compare programs, not algorithms (simd=scalar and precision=double "
        "make Jakobsen, XPBD, VBD and AVBD alike).");
  std::vector<std::string> absent;
  for (const SolverEntry* entry : solvers())
    if (!shown.contains(std::string(entry->name))) absent.push_back(solver_title(entry->name));
  if (!absent.empty()) {
    std::string& text =
        points.emplace_back("Solvers that were not run here: " + joined(absent) + ".");
    if (!shown.contains("implicit"))
      text +=
          " Each iteration of implicit Euler factors the whole system anew, so that no number "
          "of them is the work of " +
          std::to_string(kQuotedWork.sweeps) +
          " sweeps. Projective Dynamics and VBD approach its converged step (Inside one "
          "step), and taut run elastic compares it where links are elastic.";
  }
  points.emplace_back(
      "Real cloth: errors are distances from constraints, a reference or a closed form, not from a "
      "measured fabric.");
  std::size_t records = 0, planned = 0;
  for (const StudyResult& study : input.studies) {
    records += study.records.size();
    planned += std::max(study.planned, study.records.size());
  }
  if (records < planned)
    points.push_back("The " + std::to_string(planned - records) +
                     " planned cases that have not been run.");
  return points;
}

}  // namespace taut::report
