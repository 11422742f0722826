#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/baseline/check_answer.hpp"
#include "experiments/study/campaign.hpp"

namespace taut {

/// Options that every verb about baselines has.
struct BaselineOptions {
  std::string baselines;
  std::string out;  ///< results folder
  int jobs = 1;
  bool repeat = false;  ///< run every case a second time, to mark those that differ as flaky
  void bind(CLI::App&);
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
