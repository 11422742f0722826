#include <iomanip>
#include <iostream>
#include <memory>
#include <sstream>

#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"
#include "experiments/timing/agreement.hpp"

namespace taut::verb::agree {

namespace {

struct Options {
  std::string bench;
  std::vector<std::string> others;
  std::string metric = "stretch.rms";
  double tolerance = 0.05;
};

std::string number(double value) {
  std::ostringstream text;
  text << std::setprecision(3) << value;
  return text.str();
}

std::string interval(const Interval& i) {
  return number(i.mid) + " (" + number(i.low) + " to " + number(i.high) + ")";
}

std::string or_never(const std::string& setting) {
  return setting.empty() ? "never reached" : parse_solver(setting).brief();
}

/// What two sessions found, and how much of it contradicts.
struct Outcome {
  std::size_t compared = 0, contradictions = 0;
};

Outcome with_bench(const BenchSession& a, const BenchSession& b, const Options& options) {
  const Agreement found = agreement(a, b, options.metric, options.tolerance);
  for (const TwiceMeasured& r : found.ratios)
    if (!r.overlap)
      std::cout << "  " << r.id << ": " << interval(r.a) << " and " << interval(r.b)
                << " x the first"
                << (r.contradict ? ": CONTRADICT" : ": apart by no more than noise or tolerance")
                << '\n';
  for (const TwiceAnswered& answer : found.answers)
    if (answer.contradict)
      std::cout << "  " << answer.scene << ", cheapest for " << number(answer.level) << ": "
                << or_never(answer.a) << " and " << or_never(answer.b) << ": CONTRADICT\n";
  std::cout << "  " << found.overlapping() << " of " << found.ratios.size()
            << " intervals of cost ratios overlap, " << found.answers.size()
            << " answers of the equal-error table, " << found.contradictions()
            << " contradictions\n";
  return {found.ratios.size() + found.answers.size(), found.contradictions()};
}

/// An answer of `taut advise --json` against what the bench says of the same scene and error.
Outcome with_advice(const BenchSession& bench, const Json& advice) {
  const std::string scene = advice.at("scene"), metric = advice.at("metric");
  if (!advice.contains("error"))
    throw InputError("advice on a budget is not compared; ask with --error");
  for (const SceneBench& one : bench.scenes) {
    if (one.scene != scene) continue;
    const std::vector<Offer> offers = one.offers(metric);
    const auto cheapest = cheapest_within(offers, "", advice.at("error"));
    const auto& best = advice.at("best");
    std::cout << "  " << scene << ": bench " << or_never(cheapest ? offers[*cheapest].setting : "");
    if (cheapest) std::cout << ", " << number(1e3 * offers[*cheapest].cost.mid) << " ms";
    std::cout << "\n    advice "
              << or_never(best.is_null() ? "" : best.at("setting").get<std::string>());
    if (!best.is_null())
      std::cout << ", " << number(1e3 * best.at("cpu_seconds_per_second").at(1).get<double>())
                << " ms";
    const bool same = cheapest && !best.is_null()
                          ? offers[*cheapest].solver == best.at("solver").get<std::string>()
                          : !cheapest && best.is_null();
    std::cout << (same ? ": the same solver\n" : ": CONTRADICT\n");
    return {1, same ? 0U : 1U};
  }
  return {};
}

int run(const Options& options) {
  const BenchSession bench = bench_from_json(read_text(options.bench), options.bench);
  Outcome all;
  for (const std::string& file : options.others) {
    const std::string text = read_text(file);
    const Json json = try_parse_json(text);
    std::cout << options.bench << " and " << file << '\n';
    Outcome one;
    try {
      one = json.is_object() && json.contains("best")
                ? with_advice(bench, json)
                : with_bench(bench, bench_from_json(text, file), options);
    } catch (const Json::exception& error) {
      throw InputError(file + ": neither a bench nor an advice: " + error.what());
    }
    all.compared += one.compared, all.contradictions += one.contradictions;
  }
  if (all.compared == 0) return kNothing;
  return all.contradictions == 0 ? kPass : kRegression;
}

std::function<int()> bind(Arguments& arguments) {
  const auto o = std::make_shared<Options>();
  arguments.option("BENCH", o->bench, "What `taut bench STUDY` left: results/bench/STUDY.json")
      .required();
  arguments.option("OTHER", o->others, "Further benches, or answers of `taut advise --json`")
      .required();
  arguments.option("--metric", o->metric,
                   "The error of the equal-error table (default: stretch.rms)");
  arguments
      .option("--tolerance", o->tolerance, "Smaller relative differences are none (default: 0.05)")
      .positive();
  return [o] { return run(*o); };
}

}  // namespace
}  // namespace taut::verb::agree

TAUT_VERB(agree) = {
    .name = "agree",
    .summary =
        "Says whether benches of one build, or a bench and advice, agree within their intervals",
    .example =
        "taut agree monday/bench/trade.json tuesday/bench/trade.json\n  taut agree "
        "results/bench/trade.json hang.json",
    .bind = taut::verb::agree::bind};
