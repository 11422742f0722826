#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/history/checkout.hpp"
#include "experiments/history/history.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/timing/timing.hpp"

namespace taut {

/// Which commits run a study, and how.
struct Walk {
  std::string study, preset;
  std::string repository, range;  ///< a folder, "A..B"
  std::string build;              ///< a command of the shell, in the checkout; "": nothing is built
  std::string solver;  ///< "python3 mine.py" or "mine:cmd='python3 mine.py',...", in the checkout
  std::string taut = "build/default/taut";  ///< without a solver: the commit's own program
  std::string bisect;  ///< a metric's value, "cpu.per_step" or "wall.per_step"; "": all commits
  bool speed = false;  ///< also time neighbours in turns
  bool again = false;  ///< try again what did not build
  BuildLimits limits;
  Limits case_limits;
  int jobs = 1;
  TimingOptions timing;
  /// Runs what the store lacks, in a session of this command.
  std::function<CampaignProgress(const std::vector<StudyCases>&, Store&, const std::string& command,
                                 CampaignOptions)>
      run;
  /// Why a solver's program does not introduce itself, so that nobody knows which cases it would
  /// have; "": it does.
  std::function<std::string(const SolverEntry&)> silence;
  std::function<void(const std::string&)> say;  ///< gets news for people, a line each
};

struct Walked {
  std::string study;          ///< its name
  std::vector<Build> builds;  ///< that were looked at, in the order of the range, gaps included
  std::size_t built = 0;      ///< commits that were built now
  std::string named;          ///< of a bisection: one sentence
  bool found = false;         ///< a bisection named one commit
};

/// Checks out what is asked for, one commit after another in folders below the store's, builds and
/// runs what the store lacks. A commit that cannot be built or run is a gap with its reason. Throws
/// InputError: bad input, a full disk, somebody works in the folder; Interrupted. What was found by
/// then is stored.
Walked walk(const Walk&, Store&);

}  // namespace taut
