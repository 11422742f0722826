#include "experiments/require/require.hpp"

#include <algorithm>
#include <cctype>
#include <functional>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/model/input_error.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/require/draft.hpp"
#include "experiments/require/effects.hpp"
#include "experiments/require/perturbation.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/files.hpp"
#include "experiments/timing/timing.hpp"

namespace taut {

namespace {

/// Shares of the patience at which each part of the work has to end.
constexpr double kNoiseBy = 0.65, kTrialsBy = 0.65, kCombinedBy = 0.75, kVerifiedBy = 0.82,
                 kTimedBy = 0.97;
constexpr int kTimingRounds = 4;

class Search {
 public:
  Search(const RequireOptions& options, Store& store, std::filesystem::path folder)
      : options_(options), store_(store), folder_(std::move(folder)) {}

  Requirement run() {
    found_.full = make_case(options_.full);
    if (!observe_full()) return std::move(found_);
    try_effects();
    combine();
    verify();
    measure();
    return std::move(found_);
  }

 private:
  SteadyClock::time_point at(double share) const {
    return after(start_, share * options_.patience);
  }

  /// Runs the cases that are not stored yet. The result has an entry for each case, which is empty
  /// if time was up.
  std::vector<std::optional<Observation>> observe(const std::vector<CaseSpec>& specs,
                                                  double share) {
    std::vector<Case> cases;
    for (const CaseSpec& spec : specs) cases.push_back(maker_.make(spec));
    const CasesRun run = run_and_read(std::move(cases), store_,
                                      {.jobs = options_.jobs,
                                       .frames = true,
                                       .deadline = at(share),
                                       .progress = options_.progress});
    found_.interrupted = found_.interrupted || run.campaign.interrupted;
    found_.cases += run.campaign.cases;
    found_.ran += run.campaign.ran;
    std::vector<std::optional<Observation>> seen(run.cases.size());
    for (std::size_t i = 0; i < seen.size(); ++i)
      if (const auto& record = run.records[i]) {
        seen[i] = Observation{run.cases[i], *record, {}};
        if (completed(record->status)) seen[i]->frames = store_.motion(record->key).frames;
      }
    return seen;
  }

  /// Runs the full model, determines its noise, and chooses which answers can be kept. False if
  /// time is up.
  bool observe_full() {
    auto full = observe({options_.full}, kNoiseBy).front();
    if (!full) return give_up("the full model");
    if (!completed(full->record.status))
      throw InputError(found_.full.id +
                       " does not run to its end: " + describe(full->record.status));
    full_ = std::move(*full);
    for (const std::string& text : options_.keep.empty() ? default_answers(full_) : options_.keep) {
      found_.answers.push_back(parse_answer(text, full_));
      const KeptQuantity& answer = found_.answers.back();
      found_.values.push_back(answer.is_shape() ? 0 : value_of(answer, full_));
    }
    const Perturbations other = perturbations(found_.full, folder_);
    if (!add_rounded(other.rounding, 2) || !add_reordered(other.order))
      return give_up("the noise of the full model");
    if (found_.chaotic && !add_rounded(other.rounding, other.rounding.size()))
      return give_up("the noise of the full model");
    choose_answers();
    return !found_.interrupted;
  }

  /// Ends the search, but keeps what is known about chaos.
  bool give_up(const std::string& what) {
    found_.not_done.push_back(what);
    drop_shape();
    return false;
  }

  /// Runs cases and appends those that complete to `to`. False if time is up.
  bool add_runs(const std::vector<CaseSpec>& specs, std::vector<Observation>& to) {
    for (auto& one : observe(specs, kNoiseBy)) {
      if (!one) return false;
      if (completed(one->record.status)) to.push_back(std::move(*one));
    }
    return true;
  }

  bool add_rounded(const std::vector<CaseSpec>& specs, std::size_t most) {
    most = std::min(most, specs.size());
    rounded_.clear();
    if (!add_runs({specs.begin(), specs.begin() + static_cast<std::ptrdiff_t>(most)}, rounded_))
      return false;
    for (const Observation& one : rounded_) find_horizon(one);
    return true;
  }

  bool add_reordered(const std::vector<CaseSpec>& specs) { return add_runs(specs, reordered_); }

  void find_horizon(const Observation& other) {
    const auto shape = std::ranges::find_if(found_.answers, &KeptQuantity::is_shape);
    const double tolerance =
        shape != found_.answers.end() ? shape->tolerance : parse_answer("shape", full_).tolerance;
    if (const auto t = apart_after(full_, other, tolerance)) {
      found_.horizon = found_.chaotic ? std::min(found_.horizon, *t) : *t;
      found_.chaotic = true;
    }
  }

  /// Determines the noise of each answer. Drops the shape if the scene is chaotic.
  void choose_answers() {
    for (const KeptQuantity& answer : found_.answers) {
      double most = 0, reordered = 0;
      for (std::size_t i = 0; i < rounded_.size(); ++i) {
        most = std::max(most, distance(answer, full_, rounded_[i]));
        for (std::size_t j = 0; j < i; ++j)
          most = std::max(most, distance(answer, rounded_[j], rounded_[i]));
      }
      for (const Observation& one : reordered_)
        reordered = std::max(reordered, distance(answer, full_, one));
      found_.noise.push_back(most);
      if (!reordered_.empty()) found_.by_order.push_back(reordered);
    }
    drop_shape();
  }

  void drop_shape() {
    if (!found_.chaotic) return;
    for (std::size_t i = found_.answers.size(); i-- > 0;) {
      if (!found_.answers[i].is_shape()) continue;
      const bool measured = i < found_.noise.size();
      found_.given_up.push_back(
          "shape: a rounding error at the start moves it by " +
          text(found_.answers[i], measured ? found_.noise[i] : found_.answers[i].tolerance) +
          (measured ? "" : " or more"));
      const auto place = static_cast<std::ptrdiff_t>(i);
      found_.answers.erase(found_.answers.begin() + place);
      found_.values.erase(found_.values.begin() + place);
      if (measured) found_.noise.erase(found_.noise.begin() + place);
      if (i < found_.by_order.size()) found_.by_order.erase(found_.by_order.begin() + place);
    }
  }

  /// The full model with these reductions, or the reason why there is no such case.
  ModelTrial draft(const std::vector<const Reduction*>& reductions, const std::string& name,
                   const std::string& comment = "") {
    ModelTrial trial;
    try {
      Draft draft(options_.full);
      for (const Reduction* reduction : reductions) reduction->apply(draft);
      trial.spec = draft.write(folder_, name, comment);
      maker_.make(trial.spec);
    } catch (const InputError& error) {
      trial.spec = {};
      trial.why = error.diagnostics().front().message;
      trial.moved.assign(found_.answers.size(), kNoAnswer);
      trial.done = true;
    }
    return trial;
  }

  void judge(ModelTrial& trial, const std::optional<Observation>& seen) const {
    if (!seen) return;
    trial.done = trial.within = true;
    trial.cost = seen->record.step_cost;
    trial.steps = seen->record.steps;
    if (!completed(seen->record.status)) trial.why = describe(seen->record.status);
    for (std::size_t i = 0; i < found_.answers.size(); ++i) {
      const double moved = distance(found_.answers[i], full_, *seen);
      trial.moved.push_back(moved);
      trial.within &= moved <= std::max(found_.answers[i].tolerance, found_.noise[i]);
    }
  }

  /// Tries each effect by itself: the weakest reductions of all effects at once, then the next ones
  /// of effects that can go.
  void try_effects() {
    effects_ = effects_of(found_.full);
    for (const Effect& effect : effects_) found_.effects.push_back({effect.name, {}, 0, {}, {}});
    for (std::size_t level = 0;; ++level) {
      std::vector<CaseSpec> specs;
      std::vector<ModelTrial*> asked;
      for (std::size_t i = 0; i < effects_.size(); ++i) {
        EffectTrial& effect = found_.effects[i];
        if (effect.allowed < level || level >= effects_[i].reductions.size()) continue;
        const Reduction& reduction = effects_[i].reductions[level];
        effect.trials.push_back(draft({&reduction}, slug(effect.name + " " + reduction.change)));
        effect.trials.back().change = reduction.change;
        effect.trials.back().removes = reduction.removes;
        if (effect.trials.back().done) continue;
        specs.push_back(effect.trials.back().spec);
        asked.push_back(&effect.trials.back());
      }
      if (specs.empty()) break;
      const auto seen = observe(specs, kTrialsBy);
      for (std::size_t i = 0; i < asked.size(); ++i) judge(*asked[i], seen[i]);
      for (EffectTrial& effect : found_.effects)
        if (effect.trials.size() > level && effect.trials[level].within)
          effect.allowed = level + 1;
        else if (effect.trials.size() > level && !effect.trials[level].done)
          found_.not_done.push_back(effect.name);
    }
  }

  /// Work of a whole run, in items visited; unlike time, it is not disturbed by anything.
  static double work(const ModelTrial& trial) {
    return static_cast<double>(work_of(trial.cost)) * trial.steps;
  }

  /// Effects, each with the index of its chosen reduction.
  using Choice = std::vector<std::pair<std::size_t, std::size_t>>;

  std::vector<const Reduction*> reductions(const Choice& choice) const {
    std::vector<const Reduction*> all;
    for (const auto& [effect, level] : choice) all.push_back(&effects_[effect].reductions[level]);
    return all;
  }

  ModelTrial try_combined(const Choice& choice) {
    // Scenes are read once for each name, so every combination has its own.
    ModelTrial trial = draft(reductions(choice), "smaller-" + std::to_string(++combinations_));
    if (!trial.done) judge(trial, observe({trial.spec}, kCombinedBy).front());
    return trial;
  }

  /// Whether no answer moves by more than its noise.
  bool moves_nothing(const ModelTrial& trial) const {
    return std::ranges::equal(trial.moved, found_.noise, std::less_equal<>());
  }

  /// Combines all that can go at once. If that fails, adds them one by one: first those that move
  /// nothing, then those that are removed entirely, then by the greatest saving.
  void combine() {
    Choice wanted;
    for (std::size_t i = 0; i < found_.effects.size(); ++i)
      if (found_.effects[i].may_go()) wanted.emplace_back(i, found_.effects[i].allowed - 1);
    if (wanted.empty() || found_.interrupted) return;
    std::ranges::stable_sort(wanted, {}, [&](const auto& one) {
      const ModelTrial& trial = found_.effects[one.first].trials[one.second];
      return std::tuple(!moves_nothing(trial), !trial.removes, work(trial));
    });
    ModelTrial best = try_combined(wanted);
    if (!best.within) wanted = one_by_one(wanted, best);
    if (!best.within) return;
    std::string comment =
        "# The smallest model found of " + found_.full.id + ". Without, or coarser:\n";
    for (const auto& [effect, level] : wanted) {
      found_.effects[effect].chosen = level;
      comment +=
          "#   " + effects_[effect].name + ": " + effects_[effect].reductions[level].change + "\n";
    }
    best.spec = draft(reductions(wanted), "smallest", comment).spec;
    found_.smallest = std::move(best);
    found_.file = found_.smallest->spec.scene;
  }

  /// Adds the effects whose combination still stays within, each with the strongest possible
  /// reduction. Returns what was added; `best` receives its trial.
  Choice one_by_one(const Choice& wanted, ModelTrial& best) {
    Choice chosen;
    for (const auto& [effect, level] : wanted)
      for (std::size_t weaker = level + 1; weaker-- > 0;) {
        Choice more = chosen;
        more.emplace_back(effect, weaker);
        ModelTrial trial =
            chosen.empty() ? found_.effects[effect].trials[weaker] : try_combined(more);
        if (!trial.done) {
          found_.not_done.emplace_back("the combination");
          return chosen;
        }
        if (!trial.within) continue;
        best = std::move(trial);
        chosen = std::move(more);
        break;
      }
    return chosen;
  }

  /// Runs the smallest model again, from its file and in a store of its own.
  void verify() {
    if (!found_.smallest || found_.interrupted) return;
    const Scratch scratch;
    Store apart(scratch.path());
    apart.prepare();
    const Case again = make_case(found_.smallest->spec);
    const std::optional<Record> first = store_.find(again),
                                second = run_stored(again, apart, {}, at(kVerifiedBy));
    if (!second) return found_.not_done.push_back("the verification");
    found_.verified = first && first->digest == second->digest;
  }

  /// Times what every effect costs and what the smallest model saves, in one interleaved session.
  void measure() {
    if (found_.interrupted) return;
    std::vector<CaseToTime> cases{{full_.record.spec, full_.record.steps}};
    std::vector<std::optional<Interval>*> wanted{nullptr};
    const auto ask = [&](const ModelTrial& trial, std::optional<Interval>& ratio) {
      if (!trial.done || !trial.why.empty()) return;
      cases.push_back({trial.spec, trial.steps});
      wanted.push_back(&ratio);
    };
    if (found_.smallest) ask(*found_.smallest, found_.time_ratio);
    for (EffectTrial& effect : found_.effects)
      if (effect.done()) ask(effect.representative(), effect.time);
    const TimingSession bench = time_cases(
        cases,
        {.rounds = kTimingRounds, .seconds = 0.02, .progress = {}, .deadline = at(kTimedBy)});
    found_.control = bench.control;
    for (std::size_t i = 1; i < cases.size(); ++i) {
      if (bench.timings[i].samples.empty() || !bench.timings[i].failure.empty() ||
          bench.timings[0].samples.size() != bench.timings[i].samples.size()) {
        if (found_.not_done.empty() || found_.not_done.back() != "timing")
          found_.not_done.emplace_back("timing");
        continue;
      }
      const double longer = static_cast<double>(cases[i].steps) / cases[0].steps;
      *wanted[i] = bench.ratio(i, 0) * longer;
    }
  }

  const RequireOptions& options_;
  Store& store_;
  std::filesystem::path folder_;
  SteadyClock::time_point start_ = SteadyClock::now();
  CaseMaker maker_;
  Observation full_;
  std::vector<Observation> rounded_, reordered_;  ///< perturbed variants of the full model
  std::vector<Effect> effects_;
  int combinations_ = 0;
  Requirement found_;
};

}  // namespace

std::size_t bytes_of(const std::vector<PassCost>& passes) {
  return std::accumulate(passes.begin(), passes.end(), std::size_t{0},
                         [](std::size_t sum, const PassCost& p) { return sum + p.bytes; });
}

std::size_t work_of(const std::vector<PassCost>& passes) {
  return std::accumulate(
      passes.begin(), passes.end(), std::size_t{0},
      [](std::size_t sum, const PassCost& p) { return sum + p.items * p.repeats; });
}

Requirement find_requirement(const RequireOptions& options, Store& store,
                             const std::filesystem::path& folder) {
  // Reports errors before anything runs.
  for (const std::string& asked : options.keep) name_of_answer(asked);
  return Search(options, store, folder).run();
}

}  // namespace taut
