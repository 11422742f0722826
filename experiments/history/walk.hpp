#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/history/checkout.hpp"
#include "experiments/history/history.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/timing/timing.hpp"

namespace taut {

/// The commits that run a study, and how they do.
struct Walk {
  std::string study, preset;
  std::string repository, range;  ///< a folder, "A..B"
  std::string build;              ///< a shell command, run in the checkout; "": nothing is built
  /// Solver in the checkout: "python3 mine.py" or "mine:cmd='python3 mine.py',..."
  std::string solver;
  std::string taut = "build/default/taut";  ///< program of the commit, used if there is no solver
  std::string bisect;  ///< a metric's value, "cpu.per_step" or "wall.per_step"; "": all commits
  bool speed = false;  ///< also time neighbouring commits in turns
  bool again = false;  ///< retry commits that were gaps
  BuildLimits limits;
  Limits case_limits;
  int jobs = 1;
  TimingOptions timing;
  /// Runs the cases that the store lacks, in a session with this command.
  std::function<CampaignProgress(const std::vector<StudyCases>&, Store&, const std::string& command,
                                 CampaignOptions)>
      run;
  /// Why a solver's program does not introduce itself, which leaves its cases unknown; "" if it
  /// does.
  std::function<std::string(const SolverEntry&)> silence;
  std::function<void(const std::string&)> say;  ///< receives news for people, one line at a time
};

struct Walked {
  std::string study;          ///< its name
  std::vector<Build> builds;  ///< visited builds in the order of the range, including gaps
  std::size_t built = 0;      ///< commits that were built now
  std::string named;          ///< result of a bisection: one sentence
  bool found = false;         ///< whether the bisection narrowed it down to one commit
};

/// Checks out the commits one after another in folders below the store's, builds them, and runs the
/// cases that the store lacks. A commit that cannot be built or run is a gap with a reason. Throws
/// InputError (bad input, a full disk, another process uses the folder) or Interrupted; results
/// found before that are stored.
Walked walk(const Walk&, Store&);

}  // namespace taut
