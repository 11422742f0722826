#include <cmath>
#include <limits>
#include <optional>

#include "core/io/scene_io.hpp"
#include "core/model/text.hpp"
#include "experiments/advise/equal_search.hpp"
#include "experiments/advise/expected_cost.hpp"
#include "experiments/advise/trial.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/require/require.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/process.hpp"
#include "experiments/timing/recommendation.hpp"
#include "experiments/timing/search.hpp"

namespace taut::verb::advise {

namespace {

constexpr std::size_t kMostFinalists = 5;  ///< timed against each other
constexpr std::size_t kMostRefused = 4;    ///< printed unless all are asked for
constexpr double kSurelyDearer = 1.3;      ///< than a budget: more than a quick cost may be off
constexpr double kFinalShare = 0.25;  ///< of --patience, kept from the search to time finalists
constexpr std::size_t kFewestFinalists = 2;
constexpr int kFewestRounds = 2;  ///< with which finalists are timed where the time is short

struct Options {
  std::string scene, study, preset, metric = kErrorMetric, error, out;
  double cpu = 8;     ///< s of each solver on a scene of a study
  double budget = 0;  ///< ms per frame; 0: not given
  double fps = 1 / kFrame;
  std::vector<std::string> solvers, settings, keep;
  double patience = 120;
  int rounds = 8;
  double seconds = 0.05, tolerance = kTolerance;
  Format format;

  Unit frame() const { return frame_cost(fps); }
};

Target target_of(const Options& options) {
  if (options.error.empty() == (options.budget <= 0))
    throw InputError(std::string("advise needs one of --error and --budget") +
                     (options.error.empty() ? "" : ", not both"));
  if (!options.error.empty()) return {error_of(options.error, unit_of_value(options.metric)), {}};
  return {{}, options.budget * 1e-3 * options.fps};
}

/// What a step of the cheapest setting costs without one effect of the scene.
struct Without {
  std::string effect;
  double cost = 0;  ///< CPU s per simulated s
};

struct Refused {
  std::string solver, why;
};

/// What was searched and found.
struct Result {
  Target target;
  std::vector<KeptAnswer> limits;  ///< of values beside the error
  /// Where not even the cheapest settings fit the budget: the cheapest of all with its quick cost,
  /// and what it would cost without each effect, the least first.
  std::optional<Candidate> too_dear;
  std::vector<Without> without;
  std::vector<Candidate> tried;
  std::vector<Refused> unsupported;    ///< solvers that cannot run the scene
  std::vector<std::string> cut;        ///< solvers whose search --patience ended
  std::vector<std::string> unrefined;  ///< and those of which it ended what follows the search
  SceneBench bench;
  Recommendation recommendation;
  Interval cost;  ///< of the best, as it is expected in a second session
  bool same_bits = false;
  Interval again;  ///< cost of the best in a second session

  const BenchedCase& best() const { return bench.cases[*recommendation.best]; }
  bool complete() const { return cut.empty() && unrefined.empty(); }
  /// What the best is called: that of a search that was ended is not the best.
  std::string called() const {
    const auto tried_once = [&](const std::string& solver) {
      return std::ranges::count(tried, parse_solver(solver).entry->name, &Candidate::solver) > 0;
    };
    const auto n = static_cast<std::size_t>(std::ranges::count_if(cut, tried_once));
    return cut.empty() ? "best"
                       : so_far(target.error ? "cheapest" : "most accurate", cut.size() - n, n);
  }
  bool confirmed() const { return cost.contains(again.mid); }
};

/// Searches, times the finalists and verifies the best, all within --patience.
class Advisor {
 public:
  explicit Advisor(const Options& options)
      : options_(options), store_(options.out), result_{.target = target_of(options)} {
    const Scene scene = load_scene(find_scene(options.scene), options.settings);
    result_.limits = default_limits(scene);
    if (result_.target.error)  // which says how much is accepted
      std::erase_if(result_.limits,
                    [&](const KeptAnswer& one) { return one.name == options.metric; });
    if (!options.keep.empty()) result_.limits.clear();
    read_all(options.keep, [&](const std::string& asked) {
      if (asked != "nothing") result_.limits.push_back(parse_limit(asked, scene));
    });
    store_.prepare();
  }

  Result run() {
    const std::vector<std::string> solvers = supported();
    if (result_.target.budget && !fits(solvers)) return std::move(result_);
    search(solvers);
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
      const double run = c.cost.mid * duration_;  // a sample is a run at most
      return run + 2 * rounds * (std::min(options_.seconds, run) + 5 * c.cost.mid * dt_);
    };
    for (const std::size_t i : chosen) all += of(result_.tried[i]);
    // The control, its and the best's second session, and the best's second run with its metrics.
    if (!chosen.empty())
      all += 3 * of(result_.tried[chosen.front()]) +
             2 * result_.tried[chosen.front()].cost.mid * duration_;
    return slowdown() * all;
  }

  /// Wall over CPU time now, as others use the machine: the middle of all pilots, for a single one
  /// is so short that to wait once makes it a hundred times as long.
  double slowdown() const { return slowdowns_.empty() ? 1 : std::max(1.0, median(slowdowns_)); }

  /// When the search has to end, so that there is time for the final; that makes do with less where
  /// it would take a large share [s].
  double end_of_search() const {
    return options_.patience - std::max(seconds_of_final(kFewestFinalists, kFewestRounds),
                                        std::min(seconds_of_final(kMostFinalists, options_.rounds),
                                                 kFinalShare * options_.patience));
  }

  /// Physics and quick cost of a setting, run at most once; nothing when the time is up.
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
    const auto trial = try_setting(make(setting), store_, options_.metric, result_.limits, at(end));
    if (!trial) return {};
    const Candidate& found = trial->candidate;
    if (!std::isnan(found.cost.mid)) slowdowns_.push_back(trial->slowdown);
    progress() << "  " << number_text(elapsed(), 2) << " of " << number_text(options_.patience)
               << " s  " << parse_solver(setting).brief() << ": "
               << (found.failure.empty()
                       ? options_.metric + " " +
                             number_text(found.error, unit_of_value(options_.metric))
                       : found.failure)
               << ", " << number_text(found.cost.mid, options_.frame()) << '\n';
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
        result_.unsupported.push_back({solver, reasons.front()});
        continue;
      }
      all.push_back(solver);
    }
    return all;
  }

  /// CPU s per simulated s of a few steps; nothing: it cannot be timed.
  std::optional<double> quick_cost(const CaseSpec& spec) const {
    try {
      const Case one = make_case(spec);
      return quick_time(spec, one.scene->steps, at(options_.patience)).cpu / one.scene->dt;
    } catch (const std::runtime_error&) {
      return {};
    }
  }

  /// Whether any solver's cheapest setting may be within the budget. If none is, says what costs
  /// most in the cheapest of all.
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
    const CaseSpec spec{options_.scene, options_.settings, least->setting};
    const Scratch scratch;
    for (const Effect& effect : effects_of(make_case(spec))) {
      if (effect.reductions.size() != 1 || effect.reductions.front().change != "gone") continue;
      Draft draft(spec);
      effect.reductions.front().apply(draft);
      const auto cost = quick_cost(
          draft.write(scratch.path(), "without-" + std::to_string(result_.without.size())));
      if (cost) result_.without.push_back({effect.name, *cost});
    }
    std::ranges::sort(result_.without, {}, &Without::cost);
    return false;
  }

  /// Every solver is searched before one is refined; each gets an equal share of the time that
  /// those before it have left.
  void search(std::vector<std::string> solvers) {
    if (solvers.size() > 1) {
      solvers = by_expected_cost(std::move(solvers), options_.scene, options_.settings, store_);
      solvers = cheapest_first(std::move(solvers), [&](const std::string& setting) {
        return evaluate(setting, options_.patience);
      });
    }
    result_.cut = search(solvers, SearchDepth::columns);
    for (const std::string& solver : search(solvers, SearchDepth::refined))
      if (std::ranges::find(result_.cut, solver) == result_.cut.end())
        result_.unrefined.push_back(solver);
  }

  /// Those for which there was too little time; what the others leave of it is theirs.
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
      search_settings(solver, result_.target, run, others, depth);
      if (!ended) cut.push_back(solver);
    }
    return cut;
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
    while (most > kFewestFinalists && too_long()) --most;
    while (rounds > kFewestRounds && too_long()) --rounds;
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
        !(result_.complete() && result_.confirmed()))
      recommendation.certainty = Certainty::likely;
  }

  const Options& options_;
  SteadyClock::time_point start_ = SteadyClock::now();
  Store store_;
  CaseMaker maker_;
  double duration_ = 0, dt_ = 0;   ///< of the scene [s]
  std::vector<double> slowdowns_;  ///< wall over CPU time of each pilot
  Result result_;
};

std::string command(const Options& options, const Result& result) {
  std::string text = "taut bench " + shell_word(options.scene);
  for (const std::string& value : options.settings) text += " --set " + shell_word(value);
  const auto solver = [&](std::size_t i) {
    text +=
        " --solver " + shell_word(parse_solver(result.bench.cases[i].record.spec.solver).brief());
  };
  solver(*result.recommendation.best);
  if (result.recommendation.runner_up) solver(*result.recommendation.runner_up);
  return text + (options.metric == kErrorMetric ? "" : " --metric " + options.metric);
}

/// The best setting, how sure it is, and the command that compares it again.
void add_best(Answer& answer, const Options& options, const Result& result) {
  const Recommendation& chosen = result.recommendation;
  const Record& record = result.best().record;
  Cell best(parse_solver(record.spec.solver).brief());
  best.key = record.key;
  answer.add({"best", result.called()}, best.with(verdict(chosen, result.bench)));
  answer.add({"error", options.metric, unit_of_value(options.metric)},
             record.value(options.metric));
  answer.add({"cost", "CPU time", options.frame()}, result.cost);
  answer.add({"again", "timed again", options.frame()},
             Cell(result.again)
                 .with(result.confirmed()
                           ? ""
                           : "OUTSIDE THE INTERVAL: THIS MACHINE IS TOO NOISY NOW TO JUDGE"));
  answer.add({"control", "the same code against itself"}, result.bench.control);
  answer.add({"same_bits", "run again, the same bits"}, result.same_bits);
  answer.add(Column("confirmed").in_detail(), result.confirmed());
  answer.add(Column("certainty").in_detail(), to_string(chosen.certainty));
  answer.add({"command", "compare again"}, command(options, result));
}

/// How near anything came, where nothing meets the target.
void add_nearest(Answer& answer, const Options& options, const Result& result) {
  const auto miss = [&](const Candidate& c) { return result.target.error ? c.error : c.cost.mid; };
  const Candidate* nearest = nullptr;
  for (const Candidate& c : result.tried)
    if (c.failure.empty() && std::isfinite(c.error) && (!nearest || miss(c) < miss(*nearest)))
      nearest = &c;
  answer.add({"best", result.called()},
             Cell().with(result.too_dear     ? "unreachable"
                         : result.complete() ? "never reached"
                                             : "not reached in the time given"));
  if (result.too_dear) {
    answer.add({"cheapest", "the cheapest setting"},
               parse_solver(result.too_dear->setting).brief());
    answer.add({"cheapest_cost", "its CPU time", options.frame()}, result.too_dear->cost.mid);
  }
  if (!nearest) return;
  answer.add({"nearest"}, parse_solver(nearest->setting).brief());
  answer.add({"error", options.metric, unit_of_value(options.metric)}, nearest->error);
  answer.add({"quick_cost", "CPU time", options.frame()}, nearest->cost.mid);
}

/// A solver that was not among those timed at the end: the cells of its row up to the error, and
/// why.
std::vector<Cell> not_timed(const Options& options, const Result& result,
                            const std::string& solver) {
  const auto refused = std::ranges::find(result.unsupported, solver, &Refused::solver);
  if (refused != result.unsupported.end()) return {solver, "", {}, "unsupported: " + refused->why};
  const std::string name(parse_solver(solver).entry->name);
  const auto row = [&](std::size_t at, const std::string& why) -> std::vector<Cell> {
    const Candidate& c = result.tried[at];
    return {name, parse_solver(c.setting).brief(), c.error,
            why + number_text(c.cost.mid, options.frame()) + " by its quick cost"};
  };
  if (const auto best = best_for(result.target, result.tried, name))
    return row(*best, "reaches it, not timed beside the others: ");
  constexpr double kAny = std::numeric_limits<double>::infinity();
  const Target any = result.target.error ? Target{{}, kAny} : Target{kAny, {}};
  if (const auto nearest = best_for(any, result.tried, name))
    return row(*nearest, "not reached by the settings tried; the nearest: ");
  const auto tried = std::ranges::find(result.tried, name, &Candidate::solver);
  return {name,
          "",
          {},
          tried == result.tried.end()
              ? "not tried: --patience had ended"
              : "every setting tried was refused, such as " + parse_solver(tried->setting).brief() +
                    ": " + tried->failure};
}

/// Every solver's best beside the best of all; one that is missing there stands there with why.
Table solvers_of(const Options& options, const Result& result) {
  Table table{"solvers",
              result.cut.empty() ? "every solver's best" : "the cheapest so far of each solver",
              {{"solver"},
               {"setting"},
               {"error", options.metric, unit_of_value(options.metric)},
               {"cost", "CPU time", options.frame()},
               {"times", result.cut.empty() ? "x the best" : "x the first"},
               {"peak_bytes", "memory", kMegabytes}}};
  for (const KeptAnswer& limit : result.limits)
    table.columns.push_back({limit.name, "", unit_of(limit)});
  table.columns.emplace_back("note", "");
  for (const SolverRecommendation& solver : result.recommendation.solvers) {
    auto& row = table.rows.emplace_back();
    row = {solver.solver};
    if (solver.at) {
      const BenchedCase& c = result.bench.cases[*solver.at];
      row.insert(row.end(),
                 {parse_solver(c.record.spec.solver).brief(), c.record.value(options.metric),
                  c.cost(), solver.times, c.timing.peak_bytes});
      for (const KeptAnswer& limit : result.limits) row.push_back(c.record.value(limit.name));
      row.emplace_back("");
    } else {
      row.resize(table.columns.size());
      row.back() =
          nearest(solver, result.bench, result.recommendation, options.metric, options.fps);
    }
  }
  for (const std::string& solver : options.solvers) {
    const auto timed =
        std::ranges::find(result.recommendation.solvers, parse_solver(solver).entry->name,
                          &SolverRecommendation::solver);
    if (timed != result.recommendation.solvers.end() || result.too_dear) continue;
    std::vector<Cell> cells = not_timed(options, result, solver);
    const Cell why = cells.back();
    cells.pop_back();
    cells.resize(table.columns.size());
    cells.back() = why;
    table.rows.push_back(std::move(cells));
  }
  return table;
}

/// What is kept beside the error, and what the best makes of it.
Table limits_of(const Result& result) {
  Table table{"kept", "kept beside the error", {{"value"}, {"limit", "at most"}, {"best", "here"}}};
  const bool any = result.recommendation.best.has_value();
  for (const KeptAnswer& limit : result.limits) {
    const auto said = [&](double value) {
      return unit_of(limit).shown.empty() ? Cell(value) : Cell(value).with(text(limit, value));
    };
    table.rows.push_back({limit.name, said(limit.tolerance),
                          any ? said(std::abs(result.best().record.value(limit.name))) : Cell()});
  }
  return table;
}

Table without_of(const Options& options, const Result& result) {
  Table table{"without",
              "what costs most in the cheapest setting",
              {{"effect", "without"},
               {"share", "its share", kShare, 2},
               {"cost", "CPU time left", options.frame()},
               {"fits", "fits the budget"}}};
  for (const auto& [effect, cost] : result.without)
    table.rows.push_back(
        {effect, 1 - cost / result.too_dear->cost.mid, cost, cost <= *result.target.budget});
  table.most = kMostRefused;
  return table;
}

Table tried_of(const Options& options, const Result& result) {
  Table table{"tried",
              "all that was tried",
              {{"setting"},
               {"error", options.metric, unit_of_value(options.metric)},
               {"quick_cost", "quick CPU time", options.frame()},
               {"refused"}}};
  for (const Candidate& c : result.tried)
    table.rows.push_back({parse_solver(c.setting).brief(), c.error, c.cost.mid, c.failure});
  table.detail = true;
  return table;
}

/// What was refused, a line each.
Table refused_of(const Result& result) {
  Table table{"refused", "refused", {{"setting"}, {"why"}}};
  for (const auto& [solver, why] : result.unsupported)
    table.rows.push_back({solver, "unsupported: " + why});
  for (const Candidate& c : result.tried)
    if (!c.failure.empty()) table.rows.push_back({parse_solver(c.setting).brief(), c.failure});
  table.most = kMostRefused;
  return table;
}

Answer answer_of(const Options& options, const Result& result, double elapsed) {
  std::string subject = options.scene + ", " + text(result.target, options.metric, options.fps);
  if (!result.cut.empty())
    subject += "; INCOMPLETE: --patience ended the search of " + join(result.cut, ", ");
  Answer answer{"advise", subject};
  if (result.recommendation.best)
    add_best(answer, options, result);
  else
    add_nearest(answer, options, result);
  answer.add({"searched", "settings searched"}, result.tried.size());
  answer.add({"seconds", "time", kTime}, elapsed);
  answer.add({"patience", "of", kTime}, options.patience);
  answer.add(Column("complete").in_detail(), result.complete());
  answer.add(solvers_of(options, result));
  answer.add(limits_of(result));
  answer.add(without_of(options, result));
  answer.add(refused_of(result));
  Table not_done{"not_done", "NOT DONE: stopped by --patience", {{"solver"}, {"what"}}};
  for (const std::string& solver : result.cut) not_done.rows.push_back({solver, "search"});
  for (const std::string& solver : result.unrefined)
    not_done.rows.push_back({solver, "refinement of its best"});
  answer.add(std::move(not_done));
  answer.add(tried_of(options, result));
  return answer;
}

/// What is written above the rows of a file of searched settings.
std::string heading(const Study& study, const Options& options) {
  return "# Written by `taut advise --study " + study.name +
         (study.preset.empty() ? "" : " --preset " + study.preset) + " --cpu " +
         number_text(options.cpu) + "`: every solver's levers, searched scene by scene with " +
         number_text(options.cpu) +
         " s of CPU\n# time for each solver: half of it without accelerators that others lack, the "
         "rest with all. All that was tried, with its error (" +
         options.metric +
         ")\n# and its cost by a few steps [CPU s per simulated s]. `plain` and `best`: errors for "
         "which it is the cheapest of its solver,\n# without accelerators and with them. "
         "These are what the study runs and times afresh.\n";
}

/// Searches all solvers of a study and writes its file of settings.
int search_study(const Options& options) {
  const Study study = load_study(options.study, options.preset);
  if (study.searched.empty())
    throw InputError(study.file.string() + ": the study" +
                     (study.preset.empty() ? "" : "'s preset " + study.preset) +
                     " has no key 'searched': the file to write");
  Store store(options.out);
  store.prepare();
  Answer answer{"advise", "study " + study.name + ", every solver on every scene"};
  Table searched{"searched",
                 "what was searched",
                 {{"scene"},
                  {"solver"},
                  {"tried", "settings"},
                  {"cpu", "CPU time", kTime},
                  {"cut_off", "would have tried more"}}};
  std::vector<SearchedSetting> rows;
  std::vector<std::string> missing;
  search_equally(
      study, store, options.metric, {std::begin(kErrorLevels), std::end(kErrorLevels)}, options.cpu,
      [&](const EqualSearch& one) {
        progress() << one.scene << ", " << one.solver << ": " << one.rows.size() << " settings, "
                   << number_text(one.cpu) << " s of CPU" << '\n';
        searched.rows.push_back({one.scene, one.solver, one.rows.size(), one.cpu, one.cut_off});
        rows.insert(rows.end(), one.rows.begin(), one.rows.end());
        missing.insert(missing.end(), one.missing.begin(), one.missing.end());
      });
  std::filesystem::create_directories(study.searched.parent_path());
  write_file(study.searched, searched_toml(heading(study, options), rows, missing));
  answer.add({"file"}, study.searched.string());
  answer.add(std::move(searched));
  Table none{"missing", "no setting within an error", {{"why"}}};
  for (const std::string& one : missing) none.rows.push_back({one});
  answer.add(std::move(none));
  print(answer, options.format);
  return kPass;
}

int run(Options options) {
  if (options.scene.empty() == options.study.empty())
    throw InputError("advise what? A scene, or --study");
  if (!options.study.empty()) return search_study(options);
  find_scene(options.scene);
  target_of(options);
  if (options.solvers.empty())
    for (const SolverEntry* entry : all_solvers())
      if (entry->name != "external" && entry->name != "positions")
        options.solvers.emplace_back(entry->name);
  check_solvers(options.solvers);
  Advisor advisor(options);
  const Result result = advisor.run();
  if (!result.too_dear && result.complete() &&
      std::ranges::all_of(result.tried, [](const Candidate& c) { return std::isnan(c.error); }))
    throw InputError(result.tried.empty()
                         ? "no solver can run scene '" + options.scene + "'"
                         : options.metric + " has no value on scene '" + options.scene + "'");
  print(answer_of(options, result, advisor.elapsed()), options.format);
  if (!result.recommendation.best) return kNothing;
  if (!result.same_bits) return kConflict;
  return result.cut.empty() ? kPass : kIncomplete;
}

void add_options(CLI::App& app, Options& o) {
  app.add_option("SCENE", o.scene, "Name or path of a scene");
  app.add_option("--study", o.study,
                 "In place of a scene: searches every solver on every scene of this study, with "
                 "equal CPU time for each, and writes the file that its key `searched` names");
  add_preset(app, o.preset);
  app.add_option("--cpu", o.cpu,
                 "With --study: CPU time of each solver on a scene [s] (default: 8)")
      ->check(above_zero_seconds());
  app.add_option("--error", o.error, "Reach this error (0.01 or 1%) at the least cost");
  app.add_option("--budget", o.budget, "Reach the least error within this CPU time per frame [ms]")
      ->check(above_zero());
  app.add_option("--fps", o.fps, "Frames a second, of which one has the budget (default: 60)")
      ->check(above_zero());
  app.add_option("--keep", o.keep,
                 "VALUE:LIMIT that it must keep, too, in SI units, in the unit shown (:1mm) or in "
                 "%; repeat it; nothing: only the error counts (default: no passage, no crossing, "
                 "vertices at most 0.1 % of the cloth deep, a motion within 25 % of its way from "
                 "the reference, an RMS stretch of at most 10 %, as far as the scene has them)")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--solver", o.solvers,
                 "Only this solver; what its text fixes is not searched; repeat it (default: all)");
  add_settings(app, o.settings);
  add_judgement(app, o.metric, o.tolerance);
  app.add_option("--patience", o.patience,
                 "Search, time and verify within this time [s] (default: 120)")
      ->check(above_zero_seconds());
  add_samples(app, o.rounds, o.seconds, 2);
  add_results(app, o.out);
  add_format(app, o.format, "Print all that was tried, too");
}

}  // namespace
}  // namespace taut::verb::advise

TAUT_VERB(advise) = {
    .name = "advise",
    .group = VerbGroup::cost,
    .summary = "Finds and verifies the best setting for an error or a budget",
    .example =
        "taut advise hang --error 1%\n  taut advise ball --budget 4 --metric "
        "stretch.max\n  taut advise tunnel --error 1% --keep penetration.peak:1mm --keep "
        "tunnelling.count:0\n  taut advise my/scene.toml --error 0.001 --solver jakobsen --json\n"
        "  taut advise --study trade --preset searched\n"
        "Exit: 0 found; 3 found, solvers not searched; 4 not reached; 6 the best does not repeat "
        "bit for bit",
    .answer =
        "best error cost again control same_bits confirmed certainty command searched seconds "
        "patience complete file cheapest cheapest_cost nearest quick_cost; "
        "solvers: solver setting error cost times peak_bytes note; "
        "kept: value limit best; "
        "without: effect share cost fits; "
        "refused: setting why; "
        "not_done: solver what; "
        "tried: setting error quick_cost refused; "
        "searched: scene solver tried cpu cut_off; "
        "missing: why",
    .bind = taut::bind_verb<taut::verb::advise::add_options, taut::verb::advise::run>};
