#pragma once

#include <map>
#include <string>
#include <vector>

#include "experiments/case/question.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/input.hpp"

namespace taut::report {

/// One solver with the settings under which it is compared: of several choices the one with most
/// cases, so that its name means one thing in every sentence.
struct ComparedSolver {
  std::string name;
  std::string label;  ///< "Bullet", or "Bullet float" if other choices were run too
  std::vector<const Record*> cases;
  Work work = {};  ///< at which single values are quoted: the same for all, or its own
};

/// The cases of which single values are quoted: the same question for all, each at its work.
struct QuotedScene {
  Question question;
  std::string title;  ///< the scene's name, with the settings that not all of its cases share
  std::vector<const Record*> cases;  ///< of each solver compared; nullptr: was not run like this
};

/// Who is compared, and at which work single values are quoted. Points into the input.
struct ComparedSolvers {
  std::vector<ComparedSolver> all;  ///< in order of appearance
  std::vector<QuotedScene> scenes;  ///< every scene that a study ran
  std::vector<std::string> studies;

  const QuotedScene* quoted(const std::string& scene_or_title) const;
  /// Every case of every solver and choice, each once.
  std::map<std::string, std::vector<const Record*>> by_solver;
  /// "1 × 16 (substeps × sweeps)", or that it is unequal and what it is of each.
  std::string work_text() const;
};
ComparedSolvers compared_solvers_of(const ReportInput&);

}  // namespace taut::report
