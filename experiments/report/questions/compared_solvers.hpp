#pragma once

#include <set>
#include <string>
#include <vector>

#include "experiments/case/task.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/input.hpp"

namespace taut::report {

/// A solver with the settings under which it is compared. If several choices of settings were run,
/// the choice with most cases is taken, so that the name means the same in every table.
struct ComparedSolver {
  std::string name;
  std::string label;  ///< "Bullet", or "Bullet float" if other choices were run too
  std::vector<const Record*> cases;
  Work work = {};  ///< work at which single values are quoted: common to all, or its own
};

/// The cases whose single values are quoted: the same task for all solvers, each at its own work.
struct QuotedScene {
  Task task;
  std::string title;  ///< the scene's name, and the settings that not all of its cases share
  std::vector<const Record*> cases;  ///< by compared solver; nullptr: not run like this
};

/// The compared solvers, and the works at which single values are quoted. Points into the input.
struct ComparedSolvers {
  std::vector<ComparedSolver> all;  ///< in order of appearance
  std::vector<QuotedScene> scenes;  ///< every scene that a study ran
  std::vector<std::string> studies;

  const QuotedScene* quoted(const std::string& scene) const;
  /// "1 × 16 (substeps × sweeps)"; "" if not all solvers have the same.
  std::string common_work() const;
  /// The scene's name, and the settings that not all tasks on it share, except for times.
  std::string title(Task) const;

  std::set<Task> asked;  ///< for titles
};
ComparedSolvers compared_solvers_of(const ReportInput&);

}  // namespace taut::report
