#include "experiments/advise/trial.hpp"

#include <algorithm>
#include <cmath>

#include "experiments/case/record_io.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/timing/way.hpp"

namespace taut {

namespace {

/// Number of steps for the quick cost that guides a search.
constexpr int kQuickSteps = 48;

}  // namespace

StepTime quick_time(const CaseSpec& spec, int steps,
                    std::chrono::steady_clock::time_point deadline) {
  TimingWorker worker(spec);
  worker.give_up_at(deadline);
  return worker.pilot_run(std::min(kQuickSteps, steps));
}

std::optional<SettingTrial> try_setting(const Case& one, Store& store, const std::string& metric,
                                        const std::vector<Limit>& limits,
                                        std::chrono::steady_clock::time_point deadline) {
  const auto record = run_stored(one, store, {}, deadline);
  if (!record) return {};
  SettingTrial trial;
  Candidate& found = trial.candidate;
  found = {record->solver, record->spec.solver, {}, std::abs(record->value(metric)), {}};
  if (!completed(record->status)) found.failure = describe(record->status);
  if (const std::string why = beyond(*record, limits); !why.empty())
    found.failure += (found.failure.empty() ? "" : "; ") + why;
  const ValueSpec* value = find_value(metric).second;
  if (found.failure.empty() && value && value->role == Role::error)
    found.failure = hardly_moves(*record);
  try {
    const int steps = steps_done(*record);
    const StepTime step = quick_time(record->spec, steps, deadline);
    const double cost = step.cpu / record->dt;
    found.cost = {cost, cost, cost};
    trial.slowdown = step.wall / step.cpu;
    trial.cpu = step.cpu * (steps + std::min(kQuickSteps, steps));
  } catch (const TimeIsUp&) {
    return {};
  } catch (const std::runtime_error& error) {
    found.failure = error.what();
    found.cost.mid = std::nan("");
  }
  return trial;
}

}  // namespace taut
