#pragma once

#include <string>
#include <vector>

#include "experiments/results/session.hpp"
#include "experiments/study/main_job.hpp"

namespace taut {

/// What the main job will do, on stderr, and that its first part begins.
void tell_main_job(const std::vector<StudyCases>&);

struct MainJobEnd {
  std::string preset, results;
  int jobs = 1;
  bool print_check = true;  ///< how the committed baselines compare, on standard output
};

/// Parts 2 to 6: what accuracy costs, exclusive and so after all cases have ended; one step;
/// truths; baselines; the page, report.html. Numbers of a machine too noisy to judge are kept, for
/// the page shows how noisy it was, and a truth that fails ends nothing, for the page says which.
/// Returns the answer in a few lines, and where the page is. Throws Interrupted.
std::string end_main_job(const MainJob&, const MainJobEnd&);

}  // namespace taut
