#pragma once

#include <string>
#include <vector>

#include "experiments/results/session.hpp"
#include "experiments/study/main_job.hpp"

namespace taut {

/// Reports on stderr what the main job will do, and that its first part begins.
void tell_main_job(const std::vector<StudyCases>&);

struct MainJobEnd {
  std::string preset, results;
  int jobs = 1;
  /// Whether to print the comparison with the committed baselines on standard output.
  bool print_check = true;
};

/// Runs parts 2 to 6: the cost of accuracy, which is timed after all cases have ended; one step;
/// truths; baselines; the page, report.html. Times from a machine too noisy to judge are kept, and
/// a failed truth ends nothing, since the page shows both. Returns the answer in a few lines, and
/// where the page is. Throws Interrupted.
std::string end_main_job(const MainJob&, const MainJobEnd&);

}  // namespace taut
