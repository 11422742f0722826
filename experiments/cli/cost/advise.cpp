#include <cmath>
#include <iomanip>
#include <optional>

#include "experiments/case/record_io.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/process.hpp"
#include "experiments/timing/recommendation.hpp"
#include "experiments/timing/search.hpp"

namespace taut::verb::advise {

namespace {

constexpr int kQuickSteps = 48;            ///< of the quick cost that guides the search
constexpr std::size_t kMostFinalists = 5;  ///< timed against each other
constexpr std::size_t kMostRefused = 4;    ///< printed; --json has all

struct Options {
  std::string scene, metric = kErrorMetric, error, out;
  double budget = 0;  ///< ms per frame; 0: not given
  std::vector<std::string> solvers, settings;
  double patience = 120;
  int rounds = 8;
  double seconds = 0.05, tolerance = kTolerance;
  bool json = false;
};

/// "0.01" or "1%".
double error_of(const std::string& text) {
  std::size_t used = 0;
  double value = 0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  const std::string unit = text.substr(used);
  if (used == 0 || !(unit.empty() || unit == "%") || !(std::isfinite(value) && value > 0))
    throw InputError("--error " + text + ": expected a number above 0 such as 0.01 or 1%");
  return unit == "%" ? value / 100 : value;
}

Target target_of(const Options& options) {
  if (options.error.empty() == (options.budget <= 0))
    throw InputError(std::string("advise needs one of --error and --budget") +
                     (options.error.empty() ? "" : ", not both"));
  if (!options.error.empty()) return {error_of(options.error), {}};
  return {{}, options.budget * 1e-3 / kFrame};
}

/// What was searched and found.
struct Result {
  Target target;
  std::vector<Candidate> tried;
  std::vector<std::string> unsupported;  ///< "xpbd: why"
  std::vector<std::string> cut;          ///< solvers whose search --patience ended
  SceneBench bench;
  Recommendation recommendation;
  Interval cost;  ///< of the best, as it is expected in a second session
  bool same_bits = false;
  Interval again;  ///< cost of the best in a second session

  const BenchedCase& best() const { return bench.cases[*recommendation.best]; }
  bool confirmed() const { return cost.contains(again.mid); }
};

/// Searches, times the finalists and verifies the best, all within --patience.
class Advisor {
 public:
  explicit Advisor(const Options& options)
      : options_(options), store_(options.out), result_{.target = target_of(options)} {
    store_.prepare();
  }

  Result run() {
    search();
    decide();
    return std::move(result_);
  }
  double elapsed() const { return seconds_since(start_); }

 private:
  Case make(const std::string& solver) {
    Case one = maker_.make({options_.scene, options_.settings, parse_solver(solver).canonical()});
    duration_ = one.scene->duration(), dt_ = one.scene->dt;
    return one;
  }

  SteadyClock::time_point at(double seconds) const { return after(start_, seconds); }

  /// Wall time that timing and verifying the best `most` takes, by their quick costs [s].
  double seconds_of_final(std::size_t most, int rounds) const {
    double all = 0;
    const auto chosen = finalists(result_.tried, result_.target, most);
    const auto of = [&](const Candidate& c) {
      return c.cost.mid * duration_ + 2 * rounds * (options_.seconds + 5 * c.cost.mid * dt_);
    };
    for (const std::size_t i : chosen) all += of(result_.tried[i]);
    // The control, its and the best's second session, and the best's second run with its metrics.
    if (!chosen.empty())
      all += 3 * of(result_.tried[chosen.front()]) +
             2 * result_.tried[chosen.front()].cost.mid * duration_;
    return slowdown_ * all;
  }

  /// Physics and quick cost of a setting; nothing when the time is up.
  std::optional<Candidate> evaluate(const std::string& setting, double deadline) {
    const double end =
        std::min(deadline, options_.patience - seconds_of_final(kMostFinalists, options_.rounds));
    if (elapsed() >= end) return {};
    const auto record = run_stored(make(setting), store_, {}, at(end));
    if (!record) return {};
    Candidate found{
        record->solver, record->spec.solver, {}, std::abs(record->value(options_.metric)), {}};
    if (!completed(record->status)) found.failure = describe(record->status);
    try {
      TimingWorker worker(record->spec);
      worker.give_up_at(at(end));
      const StepTime step = worker.pilot_run(std::min(kQuickSteps, steps_done(*record)));
      const double cost = step.cpu / record->dt;
      found.cost = {cost, cost, cost};
      slowdown_ = std::max(1.0, step.wall / step.cpu);
    } catch (const TimeIsUp&) {
      return {};
    } catch (const std::runtime_error& error) {
      found.failure = error.what();
      found.cost.mid = std::nan("");
    }
    progress() << "  " << number_text(elapsed(), 2) << " of " << number_text(options_.patience)
               << " s  " << parse_solver(setting).brief() << ": "
               << (found.failure.empty() ? options_.metric + " " + number_text(found.error)
                                         : found.failure)
               << ", " << number_text(1e3 * found.cost.mid) << " ms per simulated s\n";
    return found;
  }

  /// Those that can run the scene.
  std::vector<std::string> supported() {
    std::vector<std::string> all;
    for (const std::string& solver : options_.solvers) {
      const Case one = make(solver);
      std::vector<std::string> reasons;
      try {
        reasons = one.choice.entry->unsupported(*one.scene, one.choice.params);
      } catch (const SolverFailure& failure) {
        reasons = {failure.what()};
      }
      if (!reasons.empty()) {
        result_.unsupported.push_back(solver + ": " + reasons.front());
        continue;
      }
      all.push_back(solver);
    }
    return all;
  }

  /// Every solver gets an equal share of the time that those before it have left.
  void search() {
    std::vector<std::string> solvers = supported();
    if (solvers.size() > 1)
      solvers = cheapest_first(std::move(solvers), [&](const std::string& setting) {
        return evaluate(setting, options_.patience);
      });
    auto left = static_cast<double>(solvers.size());
    for (const std::string& solver : solvers) {
      const double deadline = elapsed() + (options_.patience - elapsed()) / left--;
      bool ended = true;
      const Evaluation run = [&](const std::string& setting) {
        const auto found = evaluate(setting, deadline);
        ended = found.has_value();
        return found;
      };
      const auto found = search_settings(solver, result_.target, run, result_.tried);
      result_.tried.insert(result_.tried.end(), found.begin(), found.end());
      if (!ended) result_.cut.push_back(solver);
    }
  }

  SceneBench time(const std::vector<Record>& records, int rounds) const {
    return bench_scene(
        options_.scene, records,
        {.rounds = rounds, .seconds = options_.seconds, .progress = Countdown("timing round")});
  }

  void decide() {
    std::size_t most = kMostFinalists;
    int rounds = options_.rounds;
    const auto too_long = [&] {
      return elapsed() + seconds_of_final(most, rounds) > options_.patience;
    };
    while (most > 2 && too_long()) --most;
    while (rounds > 2 && too_long()) --rounds;
    std::vector<Record> records;
    for (const std::size_t i : finalists(result_.tried, result_.target, most))
      records.push_back(*run_stored(make(result_.tried[i].setting), store_));
    if (records.empty()) return;
    result_.bench = time(records, rounds);
    Recommendation& recommendation = result_.recommendation =
        recommend(result_.bench, result_.target, options_.metric, options_.tolerance);
    if (!recommendation.best) return;
    const Record& best = result_.best().record;
    result_.same_bits = run_again(make(best.spec.solver), store_).digest == best.digest;
    result_.again = time({best}, rounds).cases.front().cost();
    result_.cost = cost_expected_again(result_.bench, *recommendation.best);
    if (recommendation.certainty == Certainty::clear &&
        !(result_.cut.empty() && result_.confirmed()))
      recommendation.certainty = Certainty::likely;
  }

  const Options& options_;
  SteadyClock::time_point start_ = SteadyClock::now();
  Store store_;
  CaseMaker maker_;
  double duration_ = 0, dt_ = 0;  ///< of the scene [s]
  double slowdown_ = 1;           ///< wall over CPU time now: others use the machine
  Result result_;
};

std::string command(const Options& options, const Result& result) {
  std::string text = "taut bench " + options.scene;
  for (const std::string& value : options.settings) text += " --set '" + value + "'";
  const auto solver = [&](std::size_t i) {
    text +=
        " --solver " + shell_word(parse_solver(result.bench.cases[i].record.spec.solver).brief());
  };
  solver(*result.recommendation.best);
  if (result.recommendation.runner_up) solver(*result.recommendation.runner_up);
  return text + (options.metric == kErrorMetric ? "" : " --metric " + options.metric);
}

void line(const char* what, const std::string& text) {
  std::cout << "  " << std::left << std::setw(11) << what << text << '\n';
}

void print_best(const Options& options, const Result& result) {
  line("cost",
       interval_text(result.cost, 1e-3) + " ms CPU per simulated s, " +
           number_text(1e3 * kFrame * result.cost.mid) +
           " ms per frame; the same code against itself: " + interval_text(result.bench.control));
  line("verified",
       std::string(result.same_bits ? "run again, the same bits"
                                    : "RUN AGAIN, OTHER BITS: not deterministic") +
           "; timed again, " + interval_text(result.again, 1e-3) + " ms" +
           (result.confirmed() ? ""
                               : ": OUTSIDE THE INTERVAL, THIS MACHINE IS TOO NOISY NOW TO JUDGE"));
  line("reproduce", command(options, result));
}

/// How near anything came, where nothing meets the target.
void print_nearest(const Options& options, const Result& result) {
  const auto miss = [&](const Candidate& c) { return result.target.error ? c.error : c.cost.mid; };
  const Candidate* nearest = nullptr;
  for (const Candidate& c : result.tried)
    if (c.failure.empty() && std::isfinite(c.error) && (!nearest || miss(c) < miss(*nearest)))
      nearest = &c;
  std::cout << text(result.target, options.metric) << ": "
            << (result.cut.empty() ? "never reached" : "not reached in the time given");
  if (nearest)
    std::cout << "; nearest: " << parse_solver(nearest->setting).brief() << ", " << options.metric
              << " " << number_text(nearest->error) << " for "
              << number_text(1e3 * nearest->cost.mid) << " ms CPU per simulated s";
  std::cout << '\n';
}

void print_searched(const Options& options, const Result& result, double elapsed) {
  line("searched", std::to_string(result.tried.size()) + " settings; " + number_text(elapsed) +
                       " s of " + number_text(options.patience) + " s in all");
  for (const std::string& solver : result.cut)
    line("NOT DONE", solver + ": stopped by --patience " + number_text(options.patience));
  for (const std::string& reason : result.unsupported) line("unsupported", reason);
  std::size_t refused = 0;
  for (const Candidate& c : result.tried)
    if (!c.failure.empty() && ++refused <= kMostRefused)
      line("refused", parse_solver(c.setting).brief() + ": " + c.failure);
  if (refused > kMostRefused)
    line("", "and " + std::to_string(refused - kMostRefused) + " more; --json names all");
}

Json json_of(const BenchedCase& c, const std::string& metric) {
  return {{"setting", parse_solver(c.record.spec.solver).brief()},
          {"solver", c.record.solver},
          {"error", c.record.value(metric)},
          {"cpu_seconds_per_second", c.cost()},
          {"peak_bytes", c.timing.peak_bytes},
          {"case", c.record.id}};
}

Json json_of(const Options& options, const Result& result, double elapsed) {
  Json all{{"scene", options.scene},
           {"metric", options.metric},
           {"best", nullptr},
           {"runner_up", nullptr},
           {"unsupported", result.unsupported},
           {"seconds", elapsed},
           {"patience_seconds", options.patience},
           {"complete", result.cut.empty()},
           {"not_done", result.cut},
           {"tried", json_array(result.tried, [](const Candidate& c) -> Json {
              return {{"setting", parse_solver(c.setting).brief()},
                      {"error", c.error},
                      {"quick_cost", c.cost.mid},
                      {"refused", c.failure.empty() ? Json() : Json(c.failure)}};
            })}};
  if (result.target.error) all["error"] = *result.target.error;
  if (result.target.budget) all["budget_cpu_seconds_per_second"] = *result.target.budget;
  if (const Recommendation& chosen = result.recommendation; chosen.best) {
    all["best"] = json_of(result.best(), options.metric);
    all["best"]["cpu_seconds_per_second"] = result.cost;
    all["certainty"] = to_string(chosen.certainty);
    all["control"] = result.bench.control;
    all["verified"] = {{"same_bits", result.same_bits},
                       {"cpu_seconds_per_second", result.again},
                       {"inside_interval", result.confirmed()}};
    all["command"] = command(options, result);
    if (chosen.runner_up)
      all["runner_up"] = json_of(result.bench.cases[*chosen.runner_up], options.metric);
    if (chosen.ratio) all["ratio"] = *chosen.ratio;
  }
  return all;
}

int run(Options options) {
  find_scene(options.scene);
  target_of(options);
  if (options.solvers.empty())
    for (const SolverEntry* entry : all_solvers())
      if (entry->name != "external" && entry->name != "positions")
        options.solvers.emplace_back(entry->name);
  check_solvers(options.solvers);
  Advisor advisor(options);
  const Result result = advisor.run();
  if (result.cut.empty() && std::ranges::all_of(result.tried, [](const Candidate& c) {
        return !c.failure.empty() || std::isnan(c.error);
      }))
    throw InputError(result.tried.empty()
                         ? "no solver can run scene '" + options.scene + "'"
                         : options.metric + " has no value on scene '" + options.scene + "'");
  if (options.json) {
    print_json(json_of(options, result, advisor.elapsed()));
  } else {
    std::cout << options.scene << ", ";
    if (result.recommendation.best)
      std::cout << text(result.recommendation, result.bench, options.metric),
          print_best(options, result);
    else
      print_nearest(options, result);
    print_searched(options, result, advisor.elapsed());
  }
  if (!result.recommendation.best) return kNothing;
  return result.same_bits ? kPass : kConflict;
}

void add_options(CLI::App& app, Options& o) {
  app.add_option("SCENE", o.scene, "Name or path of a scene")->required();
  app.add_option("--error", o.error, "Reach this error (0.01 or 1%) at the least cost");
  app.add_option("--budget", o.budget,
                 "Reach the least error within this CPU time per frame of 1/60 s [ms]")
      ->check(above_zero());
  app.add_option("--solver", o.solvers,
                 "Only this solver; what its text fixes is not searched; repeat it (default: all)");
  add_settings(app, o.settings);
  add_judgement(app, o.metric, o.tolerance);
  app.add_option("--patience", o.patience,
                 "Search, time and verify within this time [s] (default: 120)")
      ->check(above_zero_seconds());
  add_samples(app, o.rounds, o.seconds, 2);
  add_results(app, o.out);
  add_json(app, o.json, "The answer and all that was tried");
}

}  // namespace
}  // namespace taut::verb::advise

TAUT_VERB(advise) = {
    .name = "advise",
    .group = VerbGroup::cost,
    .summary = "Finds and verifies the best setting for an error or a budget",
    .example =
        "taut advise hang --error 1%\n  taut advise ball --budget 4 --metric "
        "stretch.max\n  taut advise my/scene.toml --error 0.001 --solver jakobsen --json\n"
        "Exit: 0 found; 4 not reached; 6 the best does not repeat bit for bit",
    .bind = taut::bind_verb<taut::verb::advise::add_options, taut::verb::advise::run>};
