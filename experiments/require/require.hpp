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

/// What a smaller model does to the kept answers.
struct ModelTrial {
  std::string change;          ///< "gone", "5 -> 2"
  CaseSpec spec;               ///< empty solver: it could not be made
  std::string why;             ///< why it cannot be: "exploded (energy) at step 3", ...; "": it can
  std::vector<double> moved;   ///< by answer; infinite if it cannot be
  bool done = false;           ///< false: the time was up before
  bool within = false;         ///< every answer stays within its tolerance or the noise
  std::vector<PassCost> cost;  ///< of its step
  int steps = 0;
};

/// One effect, tried by itself.
struct EffectTrial {
  std::string name;
  std::vector<ModelTrial> trials;     ///< from the weakest reduction on, up to the first that fails
  std::size_t allowed = 0;            ///< how many of them stay within; the last of them is taken
  std::optional<Interval> time;       ///< CPU time of the whole run without it over that with it
  std::optional<std::size_t> chosen;  ///< which trial is in the smallest model

  bool done() const { return !trials.empty() && trials.back().done; }
  bool may_go() const { return allowed > 0; }
  /// The trial that speaks for the effect: the strongest that stays within, else the weakest.
  const ModelTrial& representative() const { return trials[allowed > 0 ? allowed - 1 : 0]; }
};

/// What a scene requires of a model.
struct Requirement {
  Case full;
  std::vector<KeptQuantity> answers;  ///< kept
  std::vector<double> values;         ///< of the full model; 0 for the shape
  /// Largest difference between any two of the full model and the same started off by a rounding
  /// error: what an answer moves by without any reason.
  std::vector<double> noise;
  /// Largest difference from the full model of the same with its links in another order; empty: the
  /// solver offers none. No noise, so nothing is judged by it.
  std::vector<double> by_order;
  std::vector<std::string> given_up;  ///< answers that are not kept, and why
  bool chaotic = false;               ///< a rounding error moves the shape beyond its tolerance
  double horizon = 0;                 ///< until then [s] it does not; meaningful if chaotic
  std::vector<EffectTrial> effects;
  std::optional<ModelTrial> smallest;  ///< nothing can go: none
  std::filesystem::path file;          ///< of the smallest model's scene
  bool verified = false;               ///< run again from its file: the same bits
  std::optional<Interval> time_ratio;  ///< CPU time of the smallest model's run over the full one's
  Interval control;                    ///< the full model against itself in the same session
  std::size_t cases = 0, ran = 0;      ///< looked at; of which were not stored yet
  std::vector<std::string> not_done;   ///< what the time did not suffice for
  bool interrupted = false;
};

struct RequireOptions {
  CaseSpec full;
  std::vector<std::string> keep;  ///< parse_answer(); empty: default_answers()
  double patience = 120;          ///< s, in all
  int jobs = 1;
  std::function<void(const CampaignProgress&, const Record*)> progress;
};

/// Takes one effect away at a time, combines what may go (the one that saves most work first),
/// verifies and times the result. Every run is a case of the store, so that an interrupted search
/// goes on where it was. Scenes that it makes lie in `folder`. Throws InputError if the full model
/// cannot be run.
Requirement find_requirement(const RequireOptions&, Store&, const std::filesystem::path& folder);

/// Bytes that a step holds, and items that it visits.
std::size_t bytes_of(const std::vector<PassCost>&);
std::size_t work_of(const std::vector<PassCost>&);

}  // namespace taut
