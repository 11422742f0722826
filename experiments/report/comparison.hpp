#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiments/report/input.hpp"
#include "experiments/report/price.hpp"

namespace taut::report {

/// One solver with the settings under which it is compared: of several choices the one with most
/// cases, so that "Bullet" means one thing in every sentence.
struct Contender {
  std::string solver;
  std::string label;  ///< "Bullet", or "Bullet float" if other choices were run too
  std::vector<Record> records;
};

/// y of a contender over y of the first one, case by case: same scene, time step, overrides and
/// sweeps.
struct Ratio {
  double mean = 0;  ///< geometric, over scenes: a study with many cases of one scene weighs no more
  int pairs = 0;    ///< cases in which both ended with a positive value
  std::map<std::string, double> by_scene;  ///< geometric means
};

/// The numbers of which verdict and tiles speak.
struct Comparison {
  std::vector<Contender> contenders;          ///< in the order of first appearance
  std::vector<std::optional<Ratio>> stretch;  ///< RMS stretch over the first contender's
  std::vector<std::optional<Ratio>> cost;     ///< CPU per step over the first contender's
  std::vector<std::optional<Price>> price;    ///< of kPricedError; nothing: not timed
  int sweeps = 0;                             ///< at which single cases are quoted; 0: none
  std::vector<int> failed, total;  ///< cases by contender; unsupported ones are not failures
};

/// A ratio within this factor of 1 is called equal.
inline constexpr double kAlike = 1.05;

/// Strains below a tenth of a per cent are as good as none: without a floor, one scene in free fall
/// (1e-17 against 1e-13) would decide the mean of all.
inline constexpr double kNoStretch = 1e-3;

Comparison compare(const ReportInput&);

/// y over y of the first contender's matching cases, values below `floor` counting as `floor`;
/// nullopt without a pair. NaN never counts.
std::optional<Ratio> ratio_of(const Contender&, const Contender& first, const std::string& value,
                              double floor);

/// Whether a case is among those quoted at this number of sweeps: it has as many, or its solver has
/// none.
bool quoted_at(const Record&, int sweeps);

/// Whether all contenders that have substeps ran with the same ones: only then is a sweep of one as
/// much work as a sweep of the other.
bool equal_substeps(const Comparison&);

/// A time step up to which (itself included) every tried one ended ok or unsettled.
struct SoundStep {
  double dt = 0;         ///< s; 0 if the smallest that was tried failed
  bool no_limit = true;  ///< nothing that was tried failed: dt is no limit but the longest tried
};
/// A contender's on `scene` at `sweeps`; nullopt unless three steps and a range of 4 were tried.
std::optional<SoundStep> largest_sound_step(const Contender&, const std::string& scene, int sweeps);

/// The same for all contenders, over the scenes where each has one.
struct SoundSteps {
  std::vector<double> dt;  ///< s, geometric means over the scenes; empty: no scene
  std::vector<std::string> scenes;
  bool no_limit = true;  ///< on none of them did any step fail
};
SoundSteps sound_steps(const Comparison&, const std::vector<std::string>& scenes);

/// The value of the one case on `scene` at `sweeps` and the most common dt; nullopt if it failed.
std::optional<double> value_at(const Contender&, const std::string& scene, int sweeps,
                               const std::string& value);

/// The verdict: what the data say, as HTML. Never claims what no pair of cases shows.
std::string verdict(const Comparison&, const std::vector<std::string>& scenes);

/// Who pays less for kPricedError, by how much and how sure that is, as HTML; "" if nothing was
/// timed.
std::string price_verdict(const Comparison&);

}  // namespace taut::report
