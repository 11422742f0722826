#pragma once

#include <set>
#include <string>
#include <vector>

#include "experiments/case/task.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/input.hpp"

namespace taut::report {

/// One solver with the settings under which it is compared: of several choices the one with most
/// cases, so that its name means one thing in every table.
struct ComparedSolver {
  std::string name;
  std::string label;  ///< "Bullet", or "Bullet float" if other choices were run too
  std::vector<const Record*> cases;
  Work work = {};  ///< at which single values are quoted: the same for all, or its own
};

/// The cases of which single values are quoted: the same task for all solvers, each at its work.
struct QuotedScene {
  Task task;
  std::string title;  ///< the scene's name, with the settings that not all of its cases share
  std::vector<const Record*> cases;  ///< of each solver compared; nullptr: was not run like this
};

/// Who is compared, and at which work single values are quoted. Points into the input.
struct ComparedSolvers {
  std::vector<ComparedSolver> all;  ///< in order of appearance
  std::vector<QuotedScene> scenes;  ///< every scene that a study ran
  std::vector<std::string> studies;

  const QuotedScene* quoted(const std::string& scene) const;
  /// "1 × 16 (substeps × sweeps)"; "": it is not the same for all.
  std::string common_work() const;
  /// The scene's name with the settings that not all tasks on it share; times do not count.
  std::string title(Task) const;

  std::set<Task> asked;  ///< for titles
};
ComparedSolvers compared_solvers_of(const ReportInput&);

}  // namespace taut::report
