#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/case/case.hpp"
#include "experiments/require/answers.hpp"
#include "experiments/results/store.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/timing/statistics.hpp"

namespace taut {

/// A smaller model and its effect on the kept answers.
struct ModelTrial {
  std::string change;    ///< for people: "gone", "5 -> 2"
  bool removes = false;  ///< whether nothing of the effect is left
  CaseSpec spec;         ///< empty solver: it could not be made
  std::string why;  ///< why it cannot be used: "exploded (energy) at step 3", ...; "" if it can
  std::vector<double> moved;   ///< by answer; infinite if it cannot be used
  bool done = false;           ///< false if time was up first
  bool within = false;         ///< whether every answer stays within its tolerance or the noise
  std::vector<PassCost> cost;  ///< cost of its step
  int steps = 0;
};

/// One effect, tried by itself.
struct EffectTrial {
  std::string name;
  std::vector<ModelTrial> trials;  ///< from the weakest reduction to the first that fails
  std::size_t allowed = 0;         ///< number of trials that stay within; the last of them is used
  /// CPU time of the whole run without the effect, relative to that with it.
  std::optional<Interval> time;
  std::optional<std::size_t> chosen;  ///< the trial that is in the smallest model

  bool done() const { return !trials.empty() && trials.back().done; }
  bool may_go() const { return allowed > 0; }
  /// The trial that represents the effect: the strongest that stays within, otherwise the weakest.
  const ModelTrial& representative() const { return trials[allowed > 0 ? allowed - 1 : 0]; }
};

/// The requirements of a scene on a model.
struct Requirement {
  Case full;
  std::vector<KeptQuantity> answers;  ///< answers that are kept
  std::vector<double> values;         ///< their values in the full model; 0 for the shape
  /// Noise of each answer: its largest difference between any two of the full model and the
  /// variants of it that start with a rounding error.
  std::vector<double> noise;
  /// Largest difference between the full model and variants with another order of links; empty if
  /// the solver has no such option. This is not noise, so nothing is judged by it.
  std::vector<double> by_order;
  std::vector<std::string> given_up;  ///< answers that cannot be kept, and why
  bool chaotic = false;  ///< whether a rounding error moves the shape beyond its tolerance
  double horizon = 0;    ///< time [s] until which it does not; valid if chaotic
  std::vector<EffectTrial> effects;
  std::optional<ModelTrial> smallest;  ///< nothing if nothing can go
  std::filesystem::path file;          ///< file with the smallest model's scene
  bool verified = false;               ///< whether a second run from the file gave the same bits
  std::optional<Interval> time_ratio;  ///< CPU time of the smallest model relative to the full one
  Interval control;                    ///< the full model against itself in the same session
  std::size_t cases = 0, ran = 0;      ///< cases examined, and how many of them had to be run
  std::vector<std::string> not_done;   ///< parts for which there was no time
  bool interrupted = false;
};

struct RequireOptions {
  CaseSpec full;
  std::vector<std::string> keep;  ///< parse_answer(); empty: default_answers()
  double patience = 120;          ///< s for everything
  int jobs = 1;
  std::function<void(const CampaignProgress&, const Record*)> progress;
};

/// Removes one effect at a time, combines those that can go (starting with the one that saves most
/// work), and verifies and times the result. Every run is a case in the store, so that an
/// interrupted search can continue. Scenes that it makes are written to `folder`. Throws InputError
/// if the full model cannot be run.
Requirement find_requirement(const RequireOptions&, Store&, const std::filesystem::path& folder);

/// Bytes that a step holds.
std::size_t bytes_of(const std::vector<PassCost>&);
std::size_t work_of(const std::vector<PassCost>&);

}  // namespace taut
