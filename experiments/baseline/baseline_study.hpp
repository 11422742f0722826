#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "experiments/baseline/baseline.hpp"
#include "experiments/study/campaign.hpp"

namespace taut {

struct BaselineOptions {
  std::string baselines;
  std::string out;  ///< results folder
  int jobs = 1;
  bool repeat = false;  ///< run every case a second time, to mark those that differ as flaky
  /// Runs what the store lacks, in a session of this command.
  std::function<CampaignProgress(const std::vector<StudyCases>&, Store&, const std::string& command,
                                 CampaignOptions)>
      run;
  /// Is told news for people, a line each.
  std::function<void(const std::string&)> say;
  /// What a value is called where it is counted by its name; "": it is one of the other values.
  std::function<std::string(const std::string& value)> title;
};

/// A study beside its baseline.
struct BaselineStudy {
  std::string name;
  std::filesystem::path folder;  ///< of its baseline
  Tolerances tolerances;
  Baseline before, now;
  std::vector<std::string> not_run;  ///< ids of cases without a result
  std::string toolchain;             ///< under which the baseline was made; "": not recorded
  bool conflict = false, interrupted = false;

  /// Cases that were not run are left out on both sides.
  Comparison compare() const;
};

/// Loads the study and its baseline and runs the cases that the store does not have; nothing is run
/// if there is no baseline and `needs_baseline`. Throws InputError.
BaselineStudy baseline_study(const std::string& study, const BaselineOptions&, bool needs_baseline);

/// File in a baseline's folder that says what it was made with.
inline constexpr const char* kToolchainFile = "toolchain.txt";

}  // namespace taut
