#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>

#include "core/model/input_error.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/study/store.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/json.hpp"
#include "experiments/timing/advice.hpp"

namespace taut::verb::advise {

namespace {

constexpr double kFrame = 1.0 / 60;        ///< s; budgets are CPU time within it
constexpr int kQuickSteps = 48;            ///< of the quick cost that guides the search
constexpr std::size_t kMostFinalists = 5;  ///< timed against each other

struct Options {
  std::string scene, metric = "stretch.rms", error, out = default_results();
  double budget = 0;  ///< ms per frame; 0: not given
  std::vector<std::string> solvers, settings;
  double patience = 120;
  int rounds = 8;
  double seconds = 0.05, tolerance = 0.05;
  bool json = false;
};

using Seconds = std::chrono::duration<double>;

double since(std::chrono::steady_clock::time_point start) {
  return Seconds(std::chrono::steady_clock::now() - start).count();
}

std::string number(double value, int digits = 3) {
  std::ostringstream text;
  text << std::setprecision(digits) << value;
  return text.str();
}

std::string interval(const Interval& i, double scale = 1) {
  return number(i.mid * scale) + " (" + number(i.low * scale) + " to " + number(i.high * scale) +
         ")";
}

const ValueSpec& find_value(const std::string& name) {
  std::vector<std::string> names;
  for (const MetricEntry* metric : metrics())
    for (const ValueSpec& value : metric->values) {
      if (value.name == name) return value;
      names.emplace_back(value.name);
    }
  throw InputError("unknown metric value '" + name + "'" + suggestion(name, names));
}

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

Wish wish_of(const Options& options) {
  if (options.error.empty() == (options.budget <= 0))
    throw InputError("advise needs one of --error and --budget");
  if (!options.error.empty()) return {error_of(options.error), {}};
  return {{}, options.budget * 1e-3 / kFrame};
}

/// Cases of one scene, run in processes of their own and kept in the store.
class Runner {
 public:
  explicit Runner(const Options& options) : options_(options), store_(options.out) {
    store_.prepare();
  }

  Case make(const std::string& solver) {
    return maker_.make({options_.scene, options_.settings, parse_solver(solver).canonical()});
  }

  Record stored(const Case& one) { return run_stored(one, store_); }
  Record again(const Case& one) { return run_again(one, store_); }

 private:
  const Options& options_;
  Store store_;
  CaseMaker maker_;
};

Offer quick_offer(const Record& record, const std::string& metric) {
  const auto value = record.values.find(metric);
  const bool ok =
      record.status.kind == Status::Kind::ok || record.status.kind == Status::Kind::unsettled;
  Offer offer{record.solver,
              record.spec.solver,
              {},
              value == record.values.end() ? std::nan("") : std::abs(value->second),
              !ok};
  try {
    TimingWorker worker(program_of(record.spec), record.spec);
    const double cost = worker.rehearse(std::min(kQuickSteps, steps_done(record))).cpu / record.dt;
    offer.cost = {cost, cost, cost};
  } catch (const std::runtime_error&) {
    offer.failed = true;
    offer.cost.mid = std::nan("");
  }
  return offer;
}

/// What was asked, searched and found.
struct Answer {
  Wish wish;
  std::vector<Offer> tried;
  std::vector<std::string> unsupported;  ///< "xpbd: why"
  std::vector<std::string> cut;          ///< solvers whose share of the time ended their search
  SceneBench bench;
  Advice advice;
  double searched = 0;  ///< s
  bool same_bits = false;
  Interval again;  ///< cost of the best in a second session

  const BenchedCase& best() const { return bench.cases[*advice.best]; }
};

/// Every solver gets an equal share of the time that those before it have left.
void search(const Options& options, Runner& runner, Answer& answer) {
  const auto start = std::chrono::steady_clock::now();
  double deadline = 0;
  bool in_time = true;
  const Try run = [&](const std::string& setting) -> std::optional<Offer> {
    in_time = since(start) <= deadline;
    if (!in_time) return {};
    const Offer offer = quick_offer(runner.stored(runner.make(setting)), options.metric);
    std::cerr << "  " << parse_solver(setting).brief() << ": "
              << (offer.failed ? "failed" : options.metric + " " + number(offer.error)) << ", "
              << number(1e3 * offer.cost.mid) << " ms per simulated s\n";
    return offer;
  };
  auto left = static_cast<double>(options.solvers.size());
  for (const std::string& solver : options.solvers) {
    deadline = since(start) + (options.patience - since(start)) / left--;
    in_time = true;
    const Case one = runner.make(solver);
    const auto reasons = one.choice.entry->unsupported(*one.scene, one.choice.params);
    if (!reasons.empty()) {
      answer.unsupported.push_back(solver + ": " + reasons.front());
      continue;
    }
    const std::vector<Offer> found = search_settings(solver, answer.wish, run, answer.tried);
    answer.tried.insert(answer.tried.end(), found.begin(), found.end());
    if (!in_time) answer.cut.push_back(solver);
  }
  answer.searched = since(start);
}

SceneBench time_them(const std::vector<Record>& records, const Options& options) {
  std::vector<CaseSpec> specs;
  for (const Record& record : records) specs.push_back(record.spec);
  const auto steps = [&](const CaseSpec& spec) {
    const auto at = std::find_if(records.begin(), records.end(),
                                 [&](const Record& r) { return r.spec.solver == spec.solver; });
    return steps_done(*at);
  };
  Bench bench = run_bench(specs, {.rounds = options.rounds,
                                  .seconds = options.seconds,
                                  .program = program_of,
                                  .steps = steps,
                                  .progress = {}});
  SceneBench result{options.scene, bench.control, {}};
  for (std::size_t i = 0; i < specs.size(); ++i)
    result.cases.push_back({records[i], std::move(bench.timings[i])});
  return result;
}

Answer advise(const Options& options) {
  Answer answer{.wish = wish_of(options),
                .tried = {},
                .unsupported = {},
                .bench = {},
                .advice = {},
                .again = {}};
  Runner runner(options);
  search(options, runner, answer);
  std::vector<Record> records;
  for (const std::size_t i : finalists(answer.tried, answer.wish, kMostFinalists))
    records.push_back(runner.stored(runner.make(answer.tried[i].setting)));
  if (records.empty()) return answer;
  answer.bench = time_them(records, options);
  answer.advice = judge_finalists(answer.bench, answer.wish, options.metric, options.tolerance);
  if (!answer.advice.best) return answer;
  const Record& best = answer.best().record;
  answer.same_bits = runner.again(runner.make(best.spec.solver)).digest == best.digest;
  answer.again = time_them({best}, options).cases.front().cost();
  return answer;
}

std::string command(const Options& options, const Answer& answer) {
  std::string text = "taut bench " + options.scene;
  for (const std::string& value : options.settings) text += " --set '" + value + "'";
  const auto solver = [&](std::size_t i) {
    text += " --solver " + parse_solver(answer.bench.cases[i].record.spec.solver).brief();
  };
  solver(*answer.advice.best);
  if (answer.advice.runner_up) solver(*answer.advice.runner_up);
  return text + (options.metric == "stretch.rms" ? "" : " --metric " + options.metric);
}

std::string asked(const Options& options, const Answer& answer) {
  return answer.wish.error
             ? "least cost for " + options.metric + " <= " + number(*answer.wish.error)
             : "least " + options.metric + " within " + number(options.budget) +
                   " ms per frame of 1/60 s";
}

void print_best(const Options& options, const Answer& answer) {
  const BenchedCase& best = answer.best();
  const Advice& advice = answer.advice;
  const auto line = [](const char* what, const std::string& text) {
    std::cout << "  " << std::left << std::setw(11) << what << text << '\n';
  };
  line("use", parse_solver(best.record.spec.solver).brief());
  line("error", options.metric + " " + number(best.record.values.at(options.metric)));
  line("cost", interval(best.cost(), 1e3) + " ms CPU per simulated s, " +
                   number(1e3 * kFrame * best.cost().mid) + " ms per frame");
  if (advice.runner_up) {
    const BenchedCase& other = answer.bench.cases[*advice.runner_up];
    line("runner-up", parse_solver(other.record.spec.solver).brief() + ": " + options.metric + " " +
                          number(other.record.values.at(options.metric)) +
                          (advice.ratio ? ", " + interval(*advice.ratio) + " x the cost" : ""));
  }
  line("certainty", std::string(to_string(advice.certainty)) +
                        (answer.cut.empty() ? "" : " among what was tried") +
                        "; the same code against itself: " + interval(answer.bench.control));
  line("verified", std::string(answer.same_bits ? "run again, the same bits"
                                                : "RUN AGAIN, OTHER BITS: not deterministic") +
                       "; timed again, " + interval(answer.again, 1e3) + " ms");
  line("reproduce", command(options, answer));
}

void print_searched(const Options& options, const Answer& answer) {
  std::cout << "  searched   " << answer.tried.size() << " settings in " << number(answer.searched)
            << " s" << '\n';
  for (const std::string& solver : answer.cut)
    std::cout << "  NOT DONE   " << solver << ": stopped by --patience " << number(options.patience)
              << "\n";
  for (const std::string& reason : answer.unsupported)
    std::cout << "  cannot     " << reason << '\n';
}

/// How near anything came, where nothing granted the wish.
void print_nearest(const Options& options, const Answer& answer) {
  std::cout << "  never reached";
  const Offer* nearest = nullptr;
  const auto miss = [&](const Offer& o) { return answer.wish.error ? o.error : o.cost.mid; };
  for (const Offer& o : answer.tried)
    if (!o.failed && std::isfinite(o.error) && (!nearest || miss(o) < miss(*nearest))) nearest = &o;
  if (nearest)
    std::cout << "; nearest: " << parse_solver(nearest->setting).brief() << ", " << options.metric
              << " " << number(nearest->error) << " for " << number(1e3 * nearest->cost.mid)
              << " ms CPU per simulated s";
  std::cout << '\n';
}

Json json_of(const Interval& i) { return {i.low, i.mid, i.high}; }

Json json_of(const BenchedCase& c, const std::string& metric) {
  return {{"setting", parse_solver(c.record.spec.solver).brief()},
          {"solver", c.record.solver},
          {"error", c.record.values.at(metric)},
          {"cpu_seconds_per_second", json_of(c.cost())},
          {"peak_bytes", c.timing.peak_bytes},
          {"case", c.record.id}};
}

void print_json(const Options& options, const Answer& answer) {
  Json all{{"scene", options.scene},
           {"metric", options.metric},
           {"best", nullptr},
           {"runner_up", nullptr},
           {"unsupported", answer.unsupported},
           {"searched_seconds", answer.searched},
           {"complete", answer.cut.empty()},
           {"not_done", answer.cut}};
  if (answer.wish.error) all["error"] = *answer.wish.error;
  if (answer.wish.budget) all["budget_cpu_seconds_per_second"] = *answer.wish.budget;
  for (const Offer& o : answer.tried)
    all["tried"].push_back({{"setting", parse_solver(o.setting).brief()},
                            {"error", o.error},
                            {"quick_cost", o.cost.mid},
                            {"failed", o.failed}});
  if (const Advice& advice = answer.advice; advice.best) {
    all["best"] = json_of(answer.best(), options.metric);
    all["certainty"] = to_string(advice.certainty);
    all["control"] = json_of(answer.bench.control);
    all["verified"] = {{"same_bits", answer.same_bits},
                       {"cpu_seconds_per_second", json_of(answer.again)}};
    all["command"] = command(options, answer);
    if (advice.runner_up)
      all["runner_up"] = json_of(answer.bench.cases[*advice.runner_up], options.metric);
    if (advice.ratio) all["ratio"] = json_of(*advice.ratio);
  }
  std::cout << to_text(all, 1) << '\n';
}

int run(Options options) {
  find_value(options.metric);
  find_scene(options.scene);
  wish_of(options);
  if (options.solvers.empty())
    for (const SolverEntry* entry : solvers()) options.solvers.emplace_back(entry->name);
  // Ours first: what it costs bounds how far the others need to be searched.
  std::stable_partition(options.solvers.begin(), options.solvers.end(),
                        [](const std::string& s) { return s.starts_with("jakobsen"); });
  for (const std::string& solver : options.solvers) parse_solver(solver);
  const Answer answer = advise(options);
  if (std::all_of(answer.tried.begin(), answer.tried.end(),
                  [](const Offer& o) { return o.failed || std::isnan(o.error); }))
    throw InputError(answer.tried.empty()
                         ? "no solver can run scene '" + options.scene + "'"
                         : options.metric + " has no value on scene '" + options.scene + "'");
  if (options.json) {
    print_json(options, answer);
  } else {
    std::cout << options.scene << ": " << asked(options, answer) << '\n';
    answer.advice.best ? print_best(options, answer) : print_nearest(options, answer);
    print_searched(options, answer);
  }
  if (!answer.advice.best) return kNothing;
  return answer.same_bits ? kPass : kConflict;
}

std::function<int()> bind(Arguments& arguments) {
  const auto o = std::make_shared<Options>();
  arguments.option("SCENE", o->scene, "Name or path of a scene").required();
  arguments.option("--error", o->error, "Reach this error (0.01 or 1%) at the least cost");
  arguments
      .option("--budget", o->budget,
              "Reach the least error within this CPU time per frame of 1/60 s [ms]")
      .positive();
  arguments.option("--metric", o->metric, "What the error is (default: stretch.rms)");
  arguments.option(
      "--solver", o->solvers,
      "Only this solver; what its text fixes is not searched; repeat it (default: all)");
  arguments.option("--set", o->settings,
                   "Scene setting as a TOML assignment, such as cloth.grid=[64,64]");
  arguments.option("--patience", o->patience, "Search no longer than this [s] (default: 120)")
      .positive();
  arguments.option("--rounds", o->rounds, "Rounds of the final timing (default: 8)").range(2, 1000);
  arguments.option("--seconds", o->seconds, "CPU time of one sample (default: 0.05)").positive();
  arguments
      .option("--tolerance", o->tolerance, "Smaller relative differences are none (default: 0.05)")
      .positive();
  arguments.option("--out", o->out, "Results folder (default: " + o->out + ")");
  arguments.flag("--json", o->json, "The answer and all that was tried, as JSON");
  return [o] { return run(*o); };
}

}  // namespace
}  // namespace taut::verb::advise

TAUT_VERB(advise) = {
    .name = "advise",
    .summary =
        "Finds the best solver and setting for an error or a budget, and verifies it (exit "
        "4: never reached)",
    .example =
        "taut advise hang --error 1%\n  taut advise ball --budget 4 --metric "
        "stretch.max\n  taut advise my/scene.toml --error 0.001 --solver jakobsen --json",
    .bind = taut::verb::advise::bind};
