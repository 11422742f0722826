#include "experiments/advise/trial.hpp"

#include <algorithm>
#include <cmath>

#include "experiments/case/record_io.hpp"
#include "experiments/study/campaign.hpp"

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
  found = judge(*record, metric, limits);
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
