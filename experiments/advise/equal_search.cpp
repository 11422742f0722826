#include "experiments/advise/equal_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/model/text.hpp"
#include "experiments/advise/trial.hpp"
#include "experiments/timing/search.hpp"

namespace taut {

namespace {

constexpr double kShareWithoutAccelerators = 0.5;
/// Largest share of an error's CPU time that one run may take; substeps are doubled up to it.
constexpr double kShareOfOneRun = 0.5;

/// "jakobsen:omega=1,levels=1,tethers=off". Parameters that the text already fixes stay as they
/// are.
std::string without_accelerators(const std::string& solver) {
  const SolverChoice choice = parse_solver(solver);
  std::string text = solver;
  for (const std::string_view name : choice.entry->accuracy.accelerators)
    if (!choice.params.given(name))
      text = with(text, std::string(name).append("=").append(choice.params.value(name)));
  return text;
}

bool is_plain(const std::string& setting, const std::string& solver) {
  const SolverChoice one = parse_solver(setting), base = parse_solver(solver);
  return std::ranges::all_of(one.entry->accuracy.accelerators, [&](const std::string_view name) {
    return one.params.value(name) == base.params.value(name);
  });
}

/// The solver's text with what a setting has besides substeps, sweeps and stiffness: the values of
/// its alternatives.
std::string with_alternatives_of(const std::string& setting, const std::string& solver) {
  const SolverChoice one = parse_solver(setting), base = parse_solver(solver);
  std::string text = solver;
  for (const auto& [names, values] : one.entry->accuracy.alternatives)
    for (const std::string_view name : names)
      if (!base.params.given(name))
        text = with(text, std::string(name).append("=").append(one.params.value(name)));
  return text;
}

/// Whether a setting has all that the solver's text fixes.
bool belongs(const std::string& setting, const std::string& solver) {
  const SolverChoice one = parse_solver(setting), base = parse_solver(solver);
  return one.entry == base.entry &&
         std::ranges::all_of(base.entry->params, [&](const ParamSpec& spec) {
           return !base.params.given(spec.name) ||
                  one.params.value(spec.name) == base.params.value(spec.name);
         });
}

class SolverSearch {
 public:
  SolverSearch(const std::string& scene, const SceneSettings& settings, const std::string& solver,
               const std::string& metric, Store& store, std::vector<SearchedSetting> known)
      : scene_(scene),
        settings_(settings),
        solver_(solver),
        metric_(metric),
        store_(store),
        known_(std::move(known)) {
    const SceneSettings own = parse_study_scene(scene).settings;
    settings_.insert(settings_.end(), own.begin(), own.end());
    const Case one = make(solver);
    if (metric_.empty()) metric_ = deciding_metric(*one.scene);
    duration_ = one.scene->duration();
    limits_ = default_limits(*one.scene);
    std::erase_if(limits_, [&](const Limit& limit) { return limit.name == metric_; });
    const auto reasons = one.choice.entry->unsupported(*one.scene, one.choice.params);
    if (!reasons.empty()) unsupported_ = reasons.front();
  }

  EqualSearch run(double seconds) {
    const std::span<const double> errors = levels_of(metric_);
    if (unsupported_.empty()) {
      evaluate(cheapest_setting(solver_), seconds);
      const double plain = kShareWithoutAccelerators * seconds;
      try_known(&SearchedSetting::plain, plain);
      search(without_accelerators(solver_), errors, plain);
      try_known(&SearchedSetting::best, seconds);
      search(solver_, errors, seconds);
    }
    return found(errors);
  }

 private:
  Case make(const std::string& solver) {
    return maker_.make(
        {parse_study_scene(scene_).name, settings_, parse_solver(solver).canonical()});
  }

  /// Tries what an earlier search found best.
  void try_known(std::vector<double> SearchedSetting::*errors, double end) {
    for (const SearchedSetting& one : known_)
      if (one.scene == scene_ && !(one.*errors).empty() && belongs(one.solver, solver_))
        evaluate(one.solver, end);
  }

  /// Searches each error, with an equal share of the time that the errors before it left. The
  /// alternatives of the best for the error before come first, then those of the best so far: a
  /// solver whose runs are dear would else not get to its alternatives.
  void search(const std::string& solver, std::span<const double> errors, double seconds) {
    auto left = static_cast<double>(errors.size());
    double before = errors.front();
    for (const double error : errors) {
      cut_off_ = false;
      const double end = cpu_ + (seconds - cpu_) / left--;
      const Evaluation run = [&](const std::string& setting) { return evaluate(setting, end); };
      const Target target{error, {}};
      const double most = kShareOfOneRun * (end - cpu_) / duration_;
      // Cheap settings come first, since one column of expensive ones could use up all the time.
      // All columns come before any alternative: as long as nothing reaches the error, each
      // alternative walks all columns again.
      const auto search_from = [&](const std::string& text, SearchDepth depth) {
        for (double dearest = most / 256; dearest <= most && !cut_off_; dearest *= 4)
          if (best_for(target, search_settings(text, target, run, {}, depth, dearest))) return;
      };
      for (const double near : {before, error})
        if (const auto at = best_for({near, {}}, tried_))
          search_from(with_alternatives_of(tried_[*at].setting, solver), SearchDepth::refined);
      for (const SearchDepth depth : {SearchDepth::columns, SearchDepth::repeated})
        search_from(solver, depth);
      cut_[error] = cut_off_;
      before = error;
    }
  }

  std::optional<Candidate> evaluate(const std::string& text, double end) {
    const std::string setting = parse_solver(text).canonical();
    if (const auto known = at_.find(setting); known != at_.end()) return tried_[known->second];
    if (cpu_ >= end) {
      cut_off_ = true;
      return {};
    }
    const auto trial = try_setting(make(setting), store_, metric_, limits_,
                                   std::chrono::steady_clock::time_point::max());
    cpu_ += trial->cpu;
    at_[setting] = tried_.size();
    tried_.push_back(trial->candidate);
    return tried_.back();
  }

  EqualSearch found(std::span<const double> errors) const {
    EqualSearch result{scene_, solver_, {}, {}, cpu_};
    result.cut_off = std::ranges::any_of(cut_, [](const auto& one) { return one.second; });
    for (const Candidate& c : tried_) {
      const std::string setting = parse_solver(c.setting).brief();
      result.rows.push_back({.scene = result.scene,
                             .solver = setting,
                             .error = c.error,
                             .cost = c.cost.mid,
                             .refused = c.failure});
    }
    if (!result.rows.empty()) result.rows.front().cheapest = true;
    std::vector<Candidate> plain = tried_;
    for (Candidate& c : plain)
      if (!is_plain(c.setting, solver_)) c.failure = "accelerated";
    for (const double error : errors) {
      const Target target{error, {}};
      if (const auto at = best_for(target, plain)) result.rows[*at].plain.push_back(error);
      if (const auto at = best_for(target, tried_))
        result.rows[*at].best.push_back(error);
      else
        result.missing.push_back(result.scene + ", " + solver_ + ", " + metric_ +
                                 " <= " + shortest(error) + ": " + why_missing(error));
    }
    return result;
  }

  std::string why_missing(double error) const {
    if (!unsupported_.empty()) return "cannot run it: " + unsupported_;
    const auto cut = cut_.find(error);
    const std::string time =
        cut != cut_.end() && cut->second ? ", its CPU time used up" : ", all its levers tried";
    const Cell why = why_not({.error = error}, tried_, metric_);
    return (why.note.empty() ? why.text() : why.note) + time;
  }

  std::string scene_;
  SceneSettings settings_;
  std::string solver_, metric_, unsupported_;
  Store& store_;
  std::vector<SearchedSetting> known_;  ///< rows of an earlier search
  CaseMaker maker_;
  std::vector<Limit> limits_;
  std::vector<Candidate> tried_;
  std::map<std::string, std::size_t> at_;  ///< index into tried_, by setting
  double cpu_ = 0, duration_ = 0;
  bool cut_off_ = false;        ///< whether the search for the current error ran out of time
  std::map<double, bool> cut_;  ///< its last value, by error
};

}  // namespace

std::vector<EqualSearch> search_equally(const Study& study, Store& store, const std::string& metric,
                                        double seconds,
                                        const std::function<void(const EqualSearch&)>& after_each) {
  if (!study.axes.empty())
    throw InputError(study.file.string() + ": settings are searched only for a study without axes");
  std::vector<SearchedSetting> known;
  if (!study.searched.empty() && std::filesystem::exists(study.searched))
    known = read_searched(study.searched);
  std::vector<EqualSearch> all;
  for (const std::string& scene : study.scenes)
    for (const std::string& solver : study.solvers) {
      all.push_back(SolverSearch(scene, study.settings, solver, metric, store, known).run(seconds));
      after_each(all.back());
    }
  return all;
}

}  // namespace taut
