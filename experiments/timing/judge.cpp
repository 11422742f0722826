#include "experiments/timing/judge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/model/names.hpp"
#include "core/model/solver.hpp"
#include "experiments/answer/number.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/metrics/reference.hpp"

namespace taut {

namespace {

/// Reason why a case wins nothing if the limits of its scene were never determined.
constexpr const char* kNobodyAsked = "the limits of its scene are unknown";

double value(const Record& r, std::string_view name) { return r.value(std::string(name)); }

double if_known(double value) { return std::isfinite(value) ? value : 0; }

/// Why an error of observables tells nothing: a plate that never bends scores not much more.
std::string plate_like(const Record& r, double error) {
  const double plate = value(r, kEnsemblePlate);
  if (!(error > plate / 2)) return "";
  return "is off by more than half of what a rigid plate at rest on the body scores, " +
         shown(kShare, plate);
}

}  // namespace

std::span<const double> levels_of(const std::string& metric) {
  return metric == kVerdict ? std::span<const double>(kErrorLevels) : kStrainLevels;
}

bool Target::meets(const Candidate& c) const {
  if (!c.failure.empty() || std::isnan(c.error)) return false;
  return error ? c.error <= *error : c.cost.mid <= *budget;
}

bool Target::prefers(const Candidate& a, const Candidate& b) const {
  if (meets(a) != meets(b)) return meets(a);
  const std::pair by_cost_a(a.cost.mid, a.error), by_cost_b(b.cost.mid, b.error);
  const std::pair by_error_a(a.error, a.cost.mid), by_error_b(b.error, b.cost.mid);
  return error ? by_cost_a < by_cost_b : by_error_a < by_error_b;
}

std::optional<std::size_t> best_for(const Target& target, std::span<const Candidate> candidates,
                                    const std::string& solver) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (target.meets(candidates[i]) && (solver.empty() || candidates[i].solver == solver) &&
        (!best || target.prefers(candidates[i], candidates[*best])))
      best = i;
  return best;
}

std::string_view to_string(JudgedBy by) {
  constexpr Names<JudgedBy::observables> kNames{"nothing", "motion", "observables"};
  return kNames[by];
}

JudgedBy judged_by(const Record& r) {
  if (std::isfinite(value(r, kMotionError))) return JudgedBy::motion;
  if (std::isfinite(value(r, kEnsembleError))) return JudgedBy::observables;
  return JudgedBy::nothing;
}

std::string astray(const Record& r) {
  if (judged_by(r) == JudgedBy::nothing) return "";
  const double motion = value(r, judged_by(r) == JudgedBy::motion ? kMotionError : kEnsembleError);
  if (motion <= kErrorLevels[0]) return "";
  return "is not where it should be: " + shown(kShare, motion) +
         " of its motion away, where a cloth that stands still is 100\u00A0%";
}

std::string off_prediction(const Record& r) {
  constexpr double kApart = 0.15;
  const double predicted = value(r, kPredicted), measured = value(r, kStretch);
  const double apart = predicted / measured - 1;
  if (!(std::abs(apart) > kApart)) return "";
  return std::string(kOffPrediction) + ": its RMS stretch is " + shown(kShare, measured) +
         ", and its sweeps should leave " + shown(kShare, predicted) + ", " +
         shown(kShare, std::abs(apart)) + (apart > 0 ? " more" : " less");
}

double strain_error(const Record& r) {
  return std::abs(value(r, kStretch) - if_known(value(r, kMotionStrain)));
}

double error_of(const Record& r, const std::string& metric) {
  if (metric != kVerdict) return std::abs(value(r, metric));
  const JudgedBy by = judged_by(r);
  if (by == JudgedBy::nothing) return std::nan("");
  const bool moving = by == JudgedBy::motion;
  const double floor = if_known(value(r, moving ? kMotionFloor : kEnsembleFloor));
  return std::max(
      {value(r, moving ? kMotionError : kEnsembleError), if_known(strain_error(r)), 3 * floor});
}

Candidate judge(const Record& r, const std::string& metric,
                const std::optional<std::vector<Limit>>& limits, const Interval& cost,
                const std::string& not_timed) {
  Candidate one{.solver = r.solver,
                .setting = r.spec.solver,
                .cost = cost,
                .error = error_of(r, metric),
                .failure = not_timed};
  const auto refuse = [&](Candidate::Refusal kind, const std::string& why) {
    if (!one.failure.empty() || why.empty()) return;
    one.failure = why;
    one.refusal = kind;
  };
  refuse(Candidate::Refusal::failed, completed(r.status) ? "" : describe(r.status));
  if (metric == kVerdict)
    refuse(Candidate::Refusal::not_judged, std::isnan(one.error) ? not_judged(r.scene) : "");
  const ValueSpec* value = find_value(metric).second;
  if (value && value->role == Role::error) refuse(Candidate::Refusal::astray, astray(r));
  std::vector<Limit> kept = limits.value_or(std::vector<Limit>{});
  if (metric == kVerdict)  // the error has the strain already
    std::erase_if(kept, [](const Limit& limit) { return limit.name == kStretch; });
  if (metric == kVerdict && judged_by(r) == JudgedBy::observables)
    refuse(Candidate::Refusal::astray, plate_like(r, one.error));
  refuse(Candidate::Refusal::not_accepted, limits ? beyond(r, kept) : kNobodyAsked);
  return one;
}

Cell why_not(const Target& target, std::span<const Candidate> candidates, const std::string& metric,
             const std::string& solver) {
  const Candidate *uncounted = nullptr, *any = nullptr;
  for (const Candidate& one : candidates) {
    if (!solver.empty() && one.solver != solver) continue;
    if (!any) any = &one;
    const bool enough = target.error && one.error <= *target.error;
    if (one.is_uncounted() && enough && (!uncounted || one.cost.mid < uncounted->cost.mid))
      uncounted = &one;
  }
  if (!any) return Cell::lacking(Cell::State::not_run, "not tried");
  if (uncounted) {
    const bool moved = uncounted->refusal == Candidate::Refusal::astray;
    return Cell::lacking(moved ? Cell::State::astray : Cell::State::none, "not reached")
        .with(uncounted->failure);
  }
  const double all = std::numeric_limits<double>::infinity();
  const auto nearest =
      best_for(target.error ? Target{{}, all} : Target{all, {}}, candidates, solver);
  if (!nearest) return Cell::lacking(Cell::State::none, "not reached").with(any->failure);
  const Candidate& one = candidates[*nearest];
  return Cell::lacking(Cell::State::none, "not reached")
      .with((target.error ? "at best " + number_text(one.error, unit_of_value(metric))
                          : "the cheapest costs " + shown(kFrameCost, one.cost.mid)) +
            " (" + parse_solver(one.setting).brief() + ")");
}

std::string deciding_metric(const std::vector<const Record*>& records) {
  const auto judged = [](const Record* r) { return judged_by(*r) != JudgedBy::nothing; };
  return std::ranges::any_of(records, judged) ? kVerdict : std::string(kStretch);
}

std::string deciding_metric(const Scene& scene) {
  const MetricEntry* ensemble = find_value(kEnsembleError).first;
  const bool known = known_references(scene).motion || (ensemble && ensemble->make(scene));
  return known ? kVerdict : std::string(kStretch);
}

std::string not_judged(const std::string& scene) {
  return "motion not judged: no reference in motion is known (`taut reference " + scene +
         "` makes one or says why there is none)";
}

}  // namespace taut
