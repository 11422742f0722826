#include "experiments/advise/advisor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/io/scene_io.hpp"
#include "core/model/text.hpp"
#include "experiments/advise/expected_cost.hpp"
#include "experiments/advise/trial.hpp"
#include "experiments/answer/number.hpp"
#include "experiments/predict/prediction.hpp"
#include "experiments/require/draft.hpp"
#include "experiments/require/effects.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"
#include "experiments/timing/search.hpp"

namespace taut {

namespace {

constexpr std::size_t kMostFinalists = 5;  ///< most candidates that are timed against each other
/// A setting whose quick cost exceeds the budget by this factor is certainly over it: quick costs
/// are not that inaccurate.
constexpr double kSurelyDearer = 1.3;
/// Share of the patience kept for timing the finalists.
constexpr double kFinalShare = 0.25;
constexpr std::size_t kFewestFinalists = 2;
/// Fewest rounds in which finalists are timed if time is short.
constexpr int kFewestRounds = 2;

/// Searches, times the finalists and verifies the best, all within the patience.
class Advisor {
 public:
  Advisor(const AdviceWanted& wanted, Store& store)
      : wanted_(wanted), store_(store), result_{.target = wanted.target} {
    store_.prepare();
  }

  Advice run() {
    const std::vector<std::string> solvers = supported();
    if (!result_.target.budget || fits(solvers)) {
      search(solvers);
      decide();
    }
    result_.elapsed = elapsed();
    return std::move(result_);
  }

 private:
  double elapsed() const { return seconds_since(start_); }

  Case make(const std::string& solver) {
    Case one = maker_.make({wanted_.scene, wanted_.settings, parse_solver(solver).canonical()});
    duration_ = one.scene->duration();
    dt_ = one.scene->dt;
    return one;
  }

  SteadyClock::time_point at(double seconds) const { return after(start_, seconds); }

  /// Wall time for timing the best `most` candidates and verifying the winner, from their quick
  /// costs [s].
  double seconds_of_final(std::size_t most, int rounds) const {
    double all = 0;
    const auto chosen = finalists(result_.tried, result_.target, most);
    const auto of = [&](const Candidate& c) {
      const double run = c.cost.mid * duration_;  // a sample is at most one run
      return run + 2 * rounds * (std::min(wanted_.seconds, run) + 5 * c.cost.mid * dt_);
    };
    for (const std::size_t i : chosen) all += of(result_.tried[i]);
    // The control; second sessions of the control and of the best; the second run of the best, with
    // metrics.
    if (!chosen.empty())
      all += 3 * of(result_.tried[chosen.front()]) +
             2 * result_.tried[chosen.front()].cost.mid * duration_;
    return slowdown() * all;
  }

  /// Ratio of wall time to CPU time, which others on the machine raise. It is the median over all
  /// pilots, since a pilot is so short that a single wait can make it a hundred times as long.
  double slowdown() const { return slowdowns_.empty() ? 1 : std::max(1.0, median(slowdowns_)); }

  /// Time at which the search has to end to leave time for the final [s]. If a full final would
  /// take a large share, a smaller one has to do.
  double end_of_search() const {
    return wanted_.patience - std::max(seconds_of_final(kFewestFinalists, kFewestRounds),
                                       std::min(seconds_of_final(kMostFinalists, wanted_.rounds),
                                                kFinalShare * wanted_.patience));
  }

  /// Physics and quick cost of a setting, run at most once. Nothing if time is up.
  std::optional<Candidate> evaluate(const std::string& text, double deadline) {
    const std::string setting = parse_solver(text).canonical();
    const auto known = std::ranges::find(result_.tried, setting, &Candidate::setting);
    if (known != result_.tried.end()) return *known;
    const auto found = run_and_time(setting, deadline);
    if (found) result_.tried.push_back(*found);
    return found;
  }

  std::optional<Candidate> run_and_time(const std::string& setting, double deadline) {
    const double end = std::min(deadline, end_of_search());
    if (elapsed() >= end) return {};
    const auto trial = try_setting(make(setting), store_, wanted_.metric, wanted_.limits, at(end));
    if (!trial) return {};
    const Candidate& found = trial->candidate;
    if (!std::isnan(found.cost.mid)) slowdowns_.push_back(trial->slowdown);
    if (wanted_.news)
      wanted_.news(
          "  " + number_text(elapsed(), 2) + " of " + number_text(wanted_.patience) + " s  " +
          parse_solver(setting).brief() + ": " +
          (found.failure.empty()
               ? wanted_.metric + " " + number_text(found.error, unit_of_value(wanted_.metric))
               : found.failure) +
          ", " + number_text(found.cost.mid, wanted_.frame()));
    return found;
  }

  /// The solvers that can run the scene.
  std::vector<std::string> supported() {
    std::vector<std::string> all;
    for (const std::string& solver : wanted_.solvers) {
      const Case one = make(solver);
      std::vector<std::string> reasons;
      try {
        reasons = one.choice.entry->unsupported(*one.scene, one.choice.params);
      } catch (const SolverFailure& failure) {
        reasons = {failure.what()};
      }
      if (!reasons.empty()) {
        result_.unsupported.push_back({solver, reasons.front()});
        continue;
      }
      all.push_back(solver);
    }
    return all;
  }

  /// CPU s per simulated s, from a few steps; nothing if it cannot be timed.
  std::optional<double> quick_cost(const CaseSpec& spec) const {
    try {
      const Case one = make_case(spec);
      return quick_time(spec, one.scene->steps, at(wanted_.patience)).cpu / one.scene->dt;
    } catch (const std::runtime_error&) {
      return {};
    }
  }

  /// Whether the cheapest setting of any solver may be within the budget. If not, records the
  /// cheapest of all and what it would cost without each effect.
  bool fits(const std::vector<std::string>& solvers) {
    std::optional<Candidate> least;
    for (const std::string& solver : solvers) {
      const Case one = make(cheapest_setting(solver));
      const auto cost = quick_cost(one.spec);
      if (!cost || *cost <= kSurelyDearer * *result_.target.budget) return true;
      if (!least || *cost < least->cost.mid)
        least = Candidate{solver, one.spec.solver, {*cost, *cost, *cost}, std::nan(""), ""};
    }
    if (!least) return true;
    result_.too_dear = least;
    const CaseSpec spec{wanted_.scene, wanted_.settings, least->setting};
    const Scratch scratch;
    for (const Effect& effect : effects_of(make_case(spec))) {
      if (effect.reductions.size() != 1 || !effect.reductions.front().removes) continue;
      Draft draft(spec);
      effect.reductions.front().apply(draft);
      const auto cost = quick_cost(
          draft.write(scratch.path(), "without-" + std::to_string(result_.without.size())));
      if (cost) result_.without.push_back({effect.name, *cost});
    }
    std::ranges::sort(result_.without, {}, &Without::cost);
    return false;
  }

  /// Searches every solver before it refines any. Each solver gets an equal share of the time that
  /// those before it left.
  void search(std::vector<std::string> solvers) {
    if (solvers.size() > 1) {
      solvers = by_expected_cost(std::move(solvers), wanted_.scene, wanted_.settings, store_);
      solvers = cheapest_first(std::move(solvers), [&](const std::string& setting) {
        return evaluate(setting, wanted_.patience);
      });
    }
    result_.cut = search(solvers, SearchDepth::columns);
    for (const std::string& solver : search(solvers, SearchDepth::refined))
      if (std::ranges::find(result_.cut, solver) == result_.cut.end())
        result_.unrefined.push_back(solver);
  }

  /// Searches these solvers and returns those that ran out of time. Time that others leave is then
  /// given to them.
  std::vector<std::string> search(const std::vector<std::string>& solvers, SearchDepth depth) {
    std::vector<std::string> cut = search_once(solvers, depth);
    for (std::size_t before = 0;
         !cut.empty() && elapsed() < end_of_search() && result_.tried.size() > before;) {
      before = result_.tried.size();
      cut = search_once(cut, depth);
    }
    return cut;
  }

  std::vector<std::string> search_once(const std::vector<std::string>& solvers, SearchDepth depth) {
    std::vector<std::string> cut;
    auto left = static_cast<double>(solvers.size());
    for (const std::string& solver : solvers) {
      const double deadline = elapsed() + (end_of_search() - elapsed()) / left--;
      bool ended = true;
      const Evaluation run = [&](const std::string& setting) {
        const auto found = evaluate(setting, deadline);
        ended = found.has_value();
        return found;
      };
      const std::string name(parse_solver(solver).entry->name);
      std::vector<Candidate> others = result_.tried;
      std::erase_if(others, [&](const Candidate& c) { return c.solver == name; });
      search_settings(solver, result_.target, run, others, depth,
                      std::numeric_limits<double>::infinity(), expected_);
      if (!ended) cut.push_back(solver);
    }
    return cut;
  }

  SceneBench time(const std::vector<Record>& records, int rounds) const {
    return bench_scene(
        wanted_.scene, records, wanted_.limits,
        {.rounds = rounds, .seconds = wanted_.seconds, .progress = wanted_.timing_round});
  }

  void decide() {
    std::size_t most = kMostFinalists;
    int rounds = wanted_.rounds;
    const auto too_long = [&] {
      return elapsed() + seconds_of_final(most, rounds) > wanted_.patience;
    };
    while (most > kFewestFinalists && too_long()) --most;
    while (rounds > kFewestRounds && too_long()) --rounds;
    std::vector<Record> records;
    for (const std::size_t i : finalists(result_.tried, result_.target, most))
      records.push_back(*run_stored(make(result_.tried[i].setting), store_));
    if (records.empty()) return;
    result_.bench = time(records, rounds);
    Recommendation& recommendation = result_.recommendation =
        recommend(result_.bench, result_.target, wanted_.metric, wanted_.tolerance);
    if (!recommendation.best) return;
    const Record& best = result_.best().record;
    result_.same_bits = run_again(make(best.spec.solver), store_).digest == best.digest;
    result_.again = time({best}, rounds).cases.front().cost();
    result_.cost = cost_expected_again(result_.bench, *recommendation.best);
    if (recommendation.certainty == Certainty::clear &&
        !(result_.complete() && result_.confirmed()))
      recommendation.certainty = Certainty::likely;
  }

  /// Substeps with which sweeps leave the wanted strain at rest, where a law says so: the strain is
  /// the error, or must be within it.
  std::optional<int> predicted(const std::string& setting, double error) {
    if (wanted_.metric != kStretch && wanted_.metric != kVerdict) return {};
    const SolverChoice choice = parse_solver(setting);
    const Case one = make(choice.canonical());
    for (const PredictedStrain& found : predict(*one.scene, one.choice, {.error = error}))
      if (found.refused.empty() && found.found == choice.entry->accuracy.substeps)
        return found.choice.substeps();
    return {};
  }

  const AdviceWanted& wanted_;
  SteadyClock::time_point start_ = SteadyClock::now();
  Store& store_;
  CaseMaker maker_;
  const Expectation expected_ = [this](const std::string& setting, double error) {
    return predicted(setting, error);
  };
  double duration_ = 0, dt_ = 0;   ///< duration and time step of the scene [s]
  std::vector<double> slowdowns_;  ///< ratio of wall to CPU time, for each pilot
  Advice result_;
};

}  // namespace

std::string Advice::called() const {
  const auto tried_once = [&](const std::string& solver) {
    return std::ranges::count(tried, parse_solver(solver).entry->name, &Candidate::solver) > 0;
  };
  const auto n = static_cast<std::size_t>(std::ranges::count_if(cut, tried_once));
  return cut.empty() ? "best"
                     : so_far(target.error ? "cheapest" : "most accurate", cut.size() - n, n);
}

Advice find_advice(const AdviceWanted& wanted, Store& store) {
  return Advisor(wanted, store).run();
}

}  // namespace taut
