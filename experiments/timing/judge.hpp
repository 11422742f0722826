#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/case/record.hpp"
#include "experiments/study/limits.hpp"
#include "experiments/timing/statistics.hpp"

namespace taut {

/// The error by which settings are compared unless another metric is asked for: where the cloth is
/// and how stretched (error_of()). It bears the name of its first part.
inline constexpr const char* kVerdict = "motion.error";
/// Levels of that error. A cloth that stands still has 1, and one that is frozen at the mean of a
/// swing .58, so that no level is above a half.
inline constexpr double kErrorLevels[] = {0.5, 0.2, 0.1, 0.05, 0.02, 0.01};
/// Levels of another metric, such as RMS stretch.
inline constexpr double kStrainLevels[] = {0.1, 0.03, 0.01, 0.003, 0.001};
std::span<const double> levels_of(const std::string& metric);

inline constexpr double kFrame = 1.0 / 60;  ///< s; budgets are CPU time per such frame
/// Unit in which people see CPU seconds per simulated second: ms per frame, at `fps` frames a
/// second.
constexpr Unit frame_cost(double fps) {
  return {Unit::Kind::other, "s/s", "ms a frame", 1e3 / fps};
}
inline constexpr Unit kFrameCost = frame_cost(1 / kFrame);

/// One setting of one solver on one scene, with its cost and error.
struct Candidate {
  enum class Refusal {
    failed,       ///< it did not run to its end, or could not be timed
    not_judged,   ///< it has no error: nobody knows where the cloth should be
    astray,       ///< its strain is low, but the cloth is not where it should be
    not_accepted  ///< it exceeds the limits of its scene
  };
  std::string solver;   ///< the entry's name
  std::string setting;  ///< "jakobsen:substeps=16,iterations=1"
  Interval cost;        ///< CPU seconds per simulated second
  double error = 0;     ///< error_of(); NaN if it has no meaning here
  std::string failure;  ///< why it is refused, such as "exploded (energy)"; empty if it is not
  Refusal refusal = Refusal::failed;  ///< the kind of `failure`

  /// Whether it has a cost and an error that do not count.
  bool is_uncounted() const { return !failure.empty() && refusal >= Refusal::astray; }
};

/// The goal of a search: the cheapest setting within an error, or the most accurate one within a
/// budget. Exactly one is set.
struct Target {
  std::optional<double> error;   ///< largest value of the metric, in SI
  std::optional<double> budget;  ///< CPU seconds per simulated second

  /// Whether the candidate meets the target; a failed one never does.
  bool meets(const Candidate&) const;
  /// Whether a serves the target better than b. One that meets it beats all that do not.
  bool prefers(const Candidate& a, const Candidate& b) const;
};

/// Index of the candidate of `solver` ("" = any) that serves the target best; nothing if none meets
/// it.
std::optional<std::size_t> best_for(const Target&, std::span<const Candidate>,
                                    const std::string& solver = "");

/// What decides how far a case is off.
enum class JudgedBy { nothing, motion, observables };
JudgedBy judged_by(const Record&);
/// "nothing", "motion", "observables".
std::string_view to_string(JudgedBy);
/// Why a cloth with little strain does not count: it is farther from where it should be than the
/// first of kErrorLevels; "" if it is not, or if nobody knows.
std::string astray(const Record&);

/// A finding: the case's stretch at rest is not what its sweeps leave according to a law that holds
/// for it (stretch.predicted), by more than 15 %; "" if it is, or if nothing is predicted. Either
/// the solver does something else than it says, or the law is wrong there.
inline constexpr std::string_view kOffPrediction = "off-prediction";
std::string off_prediction(const Record&);

/// The case's value of a metric, at least 0. Of kVerdict it is the largest of
///   - the distance from the reference in motion (motion.error) or, where a motion is too chaotic
///     to have one, from the observables of its references (ensemble.error);
///   - the distance of the RMS strain from the reference's, which is 0 for rigid links;
///   - three times the reference's own floor, below which nothing can be told.
/// NaN without a reference.
double error_of(const Record&, const std::string& metric);

/// How far the RMS strain is from the reference's, or from 0 without one.
double strain_error(const Record&);

/// The one rule by which a setting counts for an error: its case ended well, its error is known,
/// the cloth moves as it should if the metric only says how strained it is, and it keeps the limits
/// of its scene. Nothing for `limits`: they were never determined, and it does not count.
Candidate judge(const Record&, const std::string& metric,
                const std::optional<std::vector<Limit>>& limits, const Interval& cost = {},
                const std::string& not_timed = "");

/// Why no setting of the solver ("" = any) meets the target, in a cell without a value: it was not
/// tried; those that are accurate enough do not count, for the reason of the cheapest; or how near
/// the best came ("at best 3.1 % (jakobsen:substeps=8)").
Cell why_not(const Target&, std::span<const Candidate>, const std::string& metric,
             const std::string& solver = "");

/// The metric that decides on a scene with these cases: kVerdict, or RMS stretch if none of them
/// has a reference to be judged by.
std::string deciding_metric(const std::vector<const Record*>&);

/// The same for a scene, by the references that are known.
std::string deciding_metric(const Scene&);

/// "motion not judged: ..." with the command that makes a reference, for a scene without.
std::string not_judged(const std::string& scene);

}  // namespace taut
