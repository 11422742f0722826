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
  bool repeat = false;  ///< run every case twice and mark those that differ as flaky
  /// Runs the cases that the store lacks, in a session with this command.
  std::function<CampaignProgress(const std::vector<StudyCases>&, Store&, const std::string& command,
                                 CampaignOptions)>
      run;
  /// Receives news for people, one line at a time.
  std::function<void(const std::string&)> say;
  /// Title under which a value is counted; "" if it counts among the other values.
  std::function<std::string(const std::string& value)> title;
};

/// A study and its baseline.
struct BaselineStudy {
  std::string name;
  std::filesystem::path folder;  ///< folder of its baseline
  Tolerances tolerances;
  Baseline before, now;
  std::vector<std::string> not_run;  ///< ids of cases without a result
  std::string toolchain;             ///< with which the baseline was made; "" if not recorded
  bool conflict = false, interrupted = false;

  /// Compares both, leaving out cases that were not run.
  Comparison compare() const;
};

/// Loads the study and its baseline and runs the cases that the store lacks. If there is no
/// baseline and `needs_baseline` is set, runs nothing. Throws InputError.
BaselineStudy baseline_study(const std::string& study, const BaselineOptions&, bool needs_baseline);

/// File in a baseline's folder that records the toolchain with which it was made.
inline constexpr const char* kToolchainFile = "toolchain.txt";

}  // namespace taut
