#include "experiments/case/run_case.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "core/model/text.hpp"
#include "core/reference/strain_at_rest.hpp"
#include "experiments/case/case.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/divergence.hpp"
#include "experiments/system/clock.hpp"

namespace taut {

namespace {

/// All metrics that this scene has something for.
class SceneMetrics {
 public:
  SceneMetrics(const Scene& scene, bool measure, const MeasuringTime& time) : time_(time) {
    if (!measure) return;
    for (const MetricEntry* entry : metrics())
      if (auto metric = entry->make(scene)) watching_.push_back({entry, std::move(metric)});
  }

  void observe(const Snapshot& moment) {
    for (Watching& one : watching_) timed(one, [&] { one.metric->observe(moment); });
    leave_out_what_is_too_dear(moment.step);
  }
  void declare(const DeclaredStep& step) {
    for (Watching& one : watching_) one.metric->declare(step);
  }
  bool follow_path(int step) const {
    return std::any_of(watching_.begin(), watching_.end(),
                       [&](const Watching& one) { return one.follows(step); });
  }
  void observe_within(const Snapshot& moment) {
    for (Watching& one : watching_)
      if (one.follows(moment.step)) timed(one, [&] { one.metric->observe_within(moment); });
  }
  /// Adds the metrics' remarks, which are those of a run that was observed to its end.
  void add_remarks(ResolvedSettings& settings) const {
    for (const Watching& one : watching_)
      if (const std::string remark = one.remark(); !remark.empty())
        settings.emplace_back(one.entry->values.front().name, remark);
  }

  std::vector<std::string> series_columns() const {
    std::vector<std::string> columns{"step", "t"};
    for (const Watching& one : watching_)
      for (const ValueSpec& value : one.entry->values)
        if (value.in_series) columns.emplace_back(value.name);
    return columns;
  }

  std::vector<double> series_row(const Snapshot& moment) {
    std::vector<double> row{static_cast<double>(moment.step), moment.t};
    for (Watching& one : watching_) {
      std::vector<double> now = one.none();
      timed(one, [&] { now = one.metric->now(moment); });
      for (std::size_t i = 0; i < now.size(); ++i)
        if (one.entry->values[i].in_series) row.push_back(now[i]);
    }
    return row;
  }

  void tell_unconverged(std::optional<int> steps) {
    if (!steps) return;
    for (Watching& one : watching_) one.metric->unconverged(*steps);
  }

  /// The values of all metrics. They are NaN unless the run is `complete`, which means that it was
  /// observed to its end.
  std::map<std::string, double> values(bool complete) {
    std::map<std::string, double> all;
    for (Watching& one : watching_) {
      std::vector<double> final_values = one.none();
      if (complete) timed(one, [&] { final_values = one.metric->finish(); });
      for (std::size_t i = 0; i < final_values.size(); ++i)
        all[std::string(one.entry->values[i].name)] = final_values[i];
    }
    return all;
  }

 private:
  struct Watching {
    const MetricEntry* entry;
    std::unique_ptr<Metric> metric;
    double seconds = 0;       ///< of CPU time
    int too_dear_after = -1;  ///< step after which it saw no more; negative: none

    bool follows(int step) const {
      return too_dear_after < 0 && entry->follows_path && metric->follows(step);
    }
    std::vector<double> none() const {
      return std::vector<double>(entry->values.size(), std::numeric_limits<double>::quiet_NaN());
    }
    std::string remark() const {
      if (too_dear_after < 0) return metric->remark();
      return "no value: too dear for this case, " + general(seconds, 2) +
             " s of CPU time until step " + std::to_string(too_dear_after);
    }
  };

  template <class Call>
  void timed(Watching& one, const Call& call) {
    if (one.too_dear_after >= 0) return;
    if (time_.tell) time_.tell(one.entry, seconds_);
    const double begin = seconds_of(CLOCK_THREAD_CPUTIME_ID);
    call();
    const double took = seconds_of(CLOCK_THREAD_CPUTIME_ID) - begin;
    one.seconds += took;
    seconds_ += took;
    if (time_.tell) time_.tell(nullptr, seconds_);
  }
  void leave_out_what_is_too_dear(int step) {
    if (seconds_ < allowed_) return;
    allowed_ = seconds_ + time_.most;
    const auto left = [](const Watching& one) { return one.too_dear_after < 0 ? one.seconds : -1; };
    std::ranges::max_element(watching_, {}, left)->too_dear_after = step;
  }

  std::vector<Watching> watching_;
  const MeasuringTime& time_;
  double seconds_ = 0;  ///< of all metrics
  double allowed_ = time_.most;
};

}  // namespace

std::string said(const PinPlaces::Stray& stray, double t) {
  std::string place;
  for (const double x : stray.place) place += (place.empty() ? "(" : ", ") + general(x, 6);
  return "vertex " + std::to_string(stray.vertex) + " is " + general(stray.distance, 3) +
         " m from " + place + ") at t = " + general(t, 4) + " s";
}

void describe_solver(Record& record, const SolverChoice& choice) {
  record.solver = choice.entry->name;
  for (const ParamSpec& param : choice.entry->params)
    record.params[std::string(param.name)] = choice.params.value(param.name);
  const AccuracyParameters& named = choice.entry->accuracy;
  for (const auto& [name, into] :
       {std::pair{named.substeps, &record.substeps}, {named.sweeps, &record.sweeps}}) {
    if (name.empty()) continue;
    *into = choice.params.integer(name);
    record.work_parameters.emplace_back(name);
  }
}

Record describe(const Scene& scene, const SolverChoice& choice) {
  Record record;
  record.spec = {scene.name, {}, choice.canonical()};
  record.scene = scene.name;
  describe_solver(record, choice);
  record.dt = scene.dt;
  record.steps = scene.steps;
  record.vertices = scene.mesh.size();
  record.links = static_cast<int>(scene.links.size());
  return record;
}

namespace {

/// Largest distance of a pin from its place [m], and share of the coordinates that rounding may
/// change. Nothing is known of a foreign solver's precision.
double pins_within(const Scene& scene, const SolverChoice& choice) {
  return choice.entry->pins_within ? choice.entry->pins_within(scene) : 0;
}
double pin_rounding(const SolverChoice& choice) {
  if (choice.entry->pins_within) return 0;
  const auto in_float = [&](const ParamSpec& spec) {
    return spec.role == ParamSpec::Role::precision && choice.params.is(spec.name, "float");
  };
  const bool single =
      choice.entry->foreign() || std::ranges::any_of(choice.entry->params, in_float);
  return single ? 1e-5 : 1e-9;
}

/// DeclaredStep::stretch_at_rest, which refers to the scene and the choice.
std::function<double()> stretch_at_rest(const Scene& scene, const SolverChoice& choice) {
  using reference::StrainAtRest;
  if (!StrainAtRest::refuse(scene, choice).empty()) return {};
  return [&scene, &choice] {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    StrainAtRest law(scene, choice);
    if (std::isnan(law.correction())) return kNone;
    const StrainAtRest::Strain strain = law.at(choice.sweeps(), choice.substeps());
    return law.outside(strain, choice.substeps()).empty() ? strain.rms : kNone;
  };
}

/// Runs all steps. `step` is always the step that is being computed.
void run_steps(const Scene& of, const SolverChoice& choice, const RunOptions& options, CaseRun& run,
               std::unique_ptr<Solver>& solver, int& step) {
  Record& record = run.record;
  const std::string cannot = join(choice.entry->unsupported(of, choice.params), "; ");
  if (!cannot.empty()) {
    record.status = {Status::Kind::unsupported, cannot};
    return;
  }
  std::optional<Scene> later;
  if (choice.entry->start) {
    later = of;
    later->start = choice.entry->start(of, choice.params);
  }
  const Scene& scene = later ? *later : of;
  solver = choice.entry->make(of, choice.params);
  solver->load(scene.start);
  record.step_cost = solver->step_cost();
  record.projections = projections_per_step(*solver);
  record.resolved_settings = choice.entry->resolved_settings(of, choice.params);

  const PinPlaces pins(of);
  DivergenceDetector detector(scene, record.step_cost, choice.substeps());
  SceneMetrics scene_metrics(scene, options.measure, options.measuring);
  const bool in_rows = options.every > 0 || options.series_rows > 0;
  if (in_rows) run.series.columns = scene_metrics.series_columns();
  const int stride = options.every > 0
                         ? options.every
                         : std::max(1, scene.steps / std::max(1, options.series_rows));
  if (options.timed) run.cpu_seconds = 0;
  State state;
  bool stable = true;
  std::optional<Status> strayed;
  if (options.measure) {
    DeclaredStep declared = declared_step(*choice.entry, scene, choice.params);
    declared.stretch_at_rest = stretch_at_rest(scene, choice);
    scene_metrics.declare(declared);
  }
  if (options.measure)
    solver->visit_substeps([&](double t) {
      if (!scene_metrics.follow_path(step)) return;
      solver->store(state);
      scene_metrics.observe_within({step, t, state});
    });
  for (step = 0; step <= scene.steps; ++step) {
    if (step > 0) {
      const double before = options.timed ? solver->cpu_seconds() : 0;
      solver->step((step - 1) * scene.dt, scene.dt);
      if (options.timed) run.cpu_seconds += solver->cpu_seconds() - before;
    }
    solver->store(state);
    const Snapshot moment{step, step * scene.dt, state};
    stable = detector.observe(step, moment.t, state);
    if (!stable) break;
    const auto stray =
        pins.farthest(step, state.x, pins_within(scene, choice), pin_rounding(choice));
    if (stray.vertex >= 0) {
      strayed =
          Status{choice.entry->foreign() ? Status::Kind::protocol : Status::Kind::error,
                 "does not hold the scene's pins: " + said(stray, moment.t), step, stray.vertex};
      break;
    }
    scene_metrics.observe(moment);
    if (in_rows && (step % stride == 0 || step == scene.steps))
      run.series.rows.push_back(scene_metrics.series_row(moment));
    if (options.watch) options.watch(moment);
    run.last = state;
  }
  stable = stable && !strayed;
  if (stable) detector.finish();
  record.status = strayed.value_or(detector.status());
  scene_metrics.tell_unconverged(solver->unconverged_steps());
  record.values = scene_metrics.values(stable);
  scene_metrics.add_remarks(record.resolved_settings);
  record.digest = digest(run.last);
}

}  // namespace

void name_it(Record& record, const Case& one) {
  record.spec = one.spec;
  record.key = one.key;
  record.id = one.id;
  record.setting = one.setting;
  record.scene = one.scene->name;
}

CaseRun run_case(const Scene& scene, const SolverChoice& choice, const RunOptions& options) {
  CaseRun run{describe(scene, choice), {}, {}};
  std::unique_ptr<Solver> solver;
  int step = 0;
  try {
    run_steps(scene, choice, options, run, solver, step);
    if (solver) run.record.log = solver->log();
  } catch (const SolverFailure& failure) {
    run.record.status = {failure.status, failure.reason, step - 1, -1};
    run.record.log = failure.log;
  }
  return run;
}

CaseRun run_case(const Case& one, const RunOptions& options) {
  CaseRun run = run_case(*one.scene, one.choice, options);
  name_it(run.record, one);
  return run;
}

Record unfinished(const Case& one, const Status& status) {
  Record record = describe(*one.scene, one.choice);
  name_it(record, one);
  record.status = status;
  return record;
}

}  // namespace taut
