#include "experiments/timing/search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/model/solver.hpp"
#include "core/model/text.hpp"

namespace taut {

namespace {

/// A setting whose quick cost exceeds its solver's best by this factor is not run.
constexpr double kSkipAboveOwnBest = 1.3;
/// Nor is one whose quick cost exceeds the best of all solvers by this factor.
constexpr double kAbandonAboveBest = 30;
/// A solver is refined only if its cost is below the best of all solvers times this factor.
constexpr double kRefineBelowBest = 10;
constexpr double kNone = std::numeric_limits<double>::infinity();

using Values = std::map<std::string, std::string>;

/// Columns of the search: values of the second parameter, each tried with its own number of
/// substeps.
struct Columns {
  std::vector<std::string> parameters;  ///< parameters that all take the value
  std::vector<std::string> values;
  bool sweeps = false;  ///< whether the values are sweeps: more cost more, but need fewer substeps
};

/// The solver's accuracy parameters that the user's text leaves open.
class OpenParameters {
 public:
  explicit OpenParameters(const std::string& solver)
      : base_(parse_solver(solver)), entry_(*base_.entry) {}

  bool open(std::string_view name) const { return !name.empty() && !base_.params.given(name); }

  /// Those of the parameters that are open, set to that value.
  Values values_of(const Words& parameters, std::string_view value) const {
    Values values;
    for (const std::string_view name : parameters)
      if (open(name)) values[std::string(name)] = value;
    return values;
  }

  std::string substeps() const { return std::string(entry_.accuracy.substeps); }
  bool has_substeps() const { return open(entry_.accuracy.substeps); }
  std::string sweeps() const { return std::string(entry_.accuracy.sweeps); }

  Columns columns() const {
    if (open(entry_.accuracy.sweeps)) {
      Columns columns{{sweeps()}, {}, true};
      for (int v = 1; v <= kMostSweeps; v *= 2) columns.values.push_back(std::to_string(v));
      return columns;
    }
    Columns columns;
    for (const std::string_view name : entry_.accuracy.stiffness.parameters)
      if (open(name)) columns.parameters.emplace_back(name);
    if (columns.parameters.empty()) return {{}, {""}, false};
    for (const std::string_view value : entry_.accuracy.stiffness.values)
      columns.values.emplace_back(value);
    return columns;
  }

  /// Open stiffnesses of a solver whose columns are sweeps.
  std::vector<Values> stiffnesses() const {
    std::vector<Values> all;
    if (open(entry_.accuracy.sweeps))
      for (const std::string_view value : entry_.accuracy.stiffness.values)
        if (const Values values = values_of(entry_.accuracy.stiffness.parameters, value);
            !values.empty())
          all.push_back(values);
    return all;
  }

  /// Single changes to try besides substeps and columns.
  std::vector<Values> alternatives() const {
    std::vector<Values> all;
    for (const auto& [names, values] : entry_.accuracy.alternatives)
      for (const std::string_view value : values)
        if (Values change = values_of(names, value); !change.empty())
          all.push_back(std::move(change));
    for (const Values& values : stiffnesses()) all.push_back(values);
    return all;
  }

  /// The alternatives that differ from what the solver's text already gives.
  std::vector<Values> other_alternatives() const {
    std::vector<Values> all = alternatives();
    std::erase_if(all, [&](const Values& values) {
      return std::ranges::all_of(
          values, [&](const auto& one) { return base_.params.value(one.first) == one.second; });
    });
    return all;
  }

 private:
  SolverChoice base_;
  const SolverEntry& entry_;
};

class SettingSearch {
 public:
  SettingSearch(const std::string& solver, const Target& target, const Evaluation& run,
                std::vector<Candidate> known, double dearest, const Expectation& expected)
      : solver_(solver),
        target_(target),
        run_(run),
        open_(solver),
        known_(std::move(known)),
        dearest_(dearest),
        expected_(expected) {}

  std::vector<Candidate> run(SearchDepth depth) {
    const Columns columns = open_.columns();
    walk(columns, {});
    if (target_.error)
      for (const Values& stiffness : open_.stiffnesses())
        if (!best_ && is_stiffer(stiffness)) walk(columns, stiffness);
    if (depth == SearchDepth::columns) return tried_;
    if (depth == SearchDepth::repeated)
      for (const Values& change : open_.other_alternatives())
        if (!best_) walk(columns, change);
    refine(columns);
    std::optional<std::size_t> before;
    while (depth == SearchDepth::repeated && best_ != before && !over_) {
      before = best_;
      if (target_.error && columns.sweeps) other_sweeps();
      refine(columns);
    }
    return tried_;
  }

  std::string cheapest() const {
    const Columns columns = open_.columns();
    Values values;
    for (const std::string& name : columns.parameters) values[name] = columns.values.front();
    if (open_.has_substeps()) values[open_.substeps()] = "1";
    return text(values);
  }

 private:
  std::string text(const Values& values) const {
    std::string all = solver_;
    for (const auto& [name, value] : values) all = with(all, name + "=" + value);
    return all;
  }

  /// The text in canonical form, which does not depend on whether defaults are spelled out.
  std::string canonical(const Values& values) const {
    return parse_solver(text(values)).canonical();
  }

  bool is_stiffer(const Values& stiffness) const {
    const Params& params = parse_solver(solver_).params;
    return std::ranges::all_of(stiffness, [&](const auto& one) {
      return *whole<double>(one.second) > params.real(one.first);
    });
  }

  /// Tries the columns, with these values of other parameters.
  void walk(const Columns& columns, const Values& fixed) {
    int start = 1, idle = 0;
    double floor_before = kNone;
    for (const std::string& value : columns.values) {
      Values values = fixed;
      for (const std::string& name : columns.parameters) values[name] = value;
      const auto before = best_;
      if (target_.error)
        start = columns.sweeps ? std::max(1, fewest(values, start) / 2) : (fewest(values, 1), 1);
      else
        most(values);
      idle = best_ && best_ != before ? 0 : idle + 1;
      if (over_ || (idle >= 2 && (best_ || columns.sweeps == false))) break;
      if (columns.sweeps && hopeless_) break;
      // If neither more substeps nor more sweeps help, the stiffness is the limit.
      if (!best_ && at_floor_ && floor_ > 0.9 * floor_before && !open_.stiffnesses().empty()) break;
      floor_before = at_floor_ ? floor_ : kNone;
    }
  }

  void refine(const Columns& columns) {
    if (target_.error) bisect();
    if (target_.error && columns.sweeps) bisect_sweeps();
    if (worth_more()) alternatives();
  }

  /// The candidate with these values and substeps, run at most once; nullptr when time is up.
  const Candidate* attempt(Values values, int substeps) {
    if (open_.has_substeps()) values[open_.substeps()] = std::to_string(substeps);
    const std::string setting = text(values);
    if (const auto at = index_.find(setting); at != index_.end()) return &tried_[at->second];
    if (over_) return nullptr;
    const std::optional<Candidate> candidate = run_(setting);
    if (!candidate) {
      over_ = true;
      return nullptr;
    }
    index_[setting] = tried_.size();
    tried_.push_back(*candidate);
    if (target_.meets(*candidate) && (!best_ || target_.prefers(*candidate, tried_[*best_]))) {
      best_ = tried_.size() - 1;
      best_met_ = {candidate->cost.mid, values, substeps};
    }
    if (target_.meets(*candidate))
      met_.push_back({candidate->cost.mid, values, substeps});
    else if (int& most = missed_[without_substeps(values)]; most < substeps)
      most = substeps;
    return &tried_.back();
  }

  double least(const std::vector<Candidate>& candidates) const {
    double cost = std::numeric_limits<double>::infinity();
    for (const Candidate& o : candidates)
      if (target_.meets(o)) cost = std::min(cost, o.cost.mid);
    return cost;
  }

  /// Settings with a quick cost above this are not run. A solver is compared with its own best, so
  /// that the runner-up is chosen as carefully as the winner.
  double bar() const {
    return std::min(
        {kSkipAboveOwnBest * least(tried_), kAbandonAboveBest * least(known_), dearest_});
  }

  /// Searches the fewest substeps, `from` times a power of two, that reach the error. If no
  /// affordable number does, returns the last number tried; `from` if all runs failed; or, at a
  /// floor, the number beyond which more did not help.
  int fewest(const Values& values, int from) {
    hopeless_ = at_floor_ = false;
    const std::optional<int> expected = expected_substeps(values);
    int n = expected.value_or(from);
    const int first = n;
    const Candidate* candidate = attempt(values, n);
    if (!candidate) return n;
    if (expected) {
      if (beside(values, n, target_.meets(*candidate))) {
        off_ *= static_cast<double>(n) / first;
        return n;
      }
      candidate = attempt(values, n);  // others were added
    }
    if (target_.meets(*candidate)) {
      while (n > 1 && (candidate = attempt(values, n / 2)) && target_.meets(*candidate)) n /= 2;
      return n;
    }
    double last = candidate->error;
    int stuck = 0, helped = n;
    bool any = candidate->failure.empty();
    while (stuck < 3 && n < kMostSubsteps && open_.has_substeps()) {
      if (2 * candidate->cost.mid > bar()) {
        hopeless_ = n == first;  // the next column starts no cheaper
        return any ? n : from;
      }
      n *= 2;
      candidate = attempt(values, n);
      if (!candidate || target_.meets(*candidate)) return n;
      // An explosion has no error, and rounding sets a floor that no number of substeps passes.
      stuck = candidate->error > 0.9 * last ? stuck + 1 : 0;
      if (stuck == 0) helped = n;
      any = any || candidate->failure.empty();
      if (!std::isnan(candidate->error)) last = candidate->error;
    }
    at_floor_ = stuck == 3;
    floor_ = last;
    return !any ? from : at_floor_ ? helped : n;
  }

  std::optional<int> expected_substeps(const Values& values) const {
    if (!expected_ || !open_.has_substeps()) return {};
    const std::optional<int> n = expected_(text(values), *target_.error);
    if (!n) return {};
    const double scaled = std::max(1.0, std::round(*n * off_));
    return scaled <= kMostSubsteps ? std::optional(static_cast<int>(scaled)) : std::nullopt;
  }

  /// Goes from n, which was tried, by a tenth of it: to fewer as long as they meet the target, or
  /// to more until they do, kNear times at most. Whether the fewest are known, which n becomes
  /// then.
  bool beside(const Values& values, int& n, bool meets) {
    const int tenth = std::max(1, n / 10);
    for (int time = 0; time < kNear; ++time) {
      const int other = meets ? n - tenth : n + tenth;
      if (other < 1) return true;
      const Candidate* here = attempt(values, n);
      if (!here || !here->failure.empty() || (!meets && here->cost.mid > bar())) return false;
      const Candidate* candidate = attempt(values, other);
      if (!candidate) return false;
      const bool changed = target_.meets(*candidate) != meets;
      if (!meets || !changed) n = other;
      if (changed) return true;
    }
    return false;
  }
  static constexpr int kNear = 3;

  /// Uses as many substeps as the budget allows, going by the cost of previous attempts.
  void most(const Values& values) {
    int n = 1;
    for (int i = 0; i < 4; ++i) {
      const Candidate* candidate = attempt(values, n);
      if (!candidate) return;
      const double room = 0.97 * *target_.budget / candidate->cost.mid;
      const int next = std::clamp(static_cast<int>(n * std::min(room, 1e6)), 1, kMostSubsteps);
      if (next == n || !open_.has_substeps() || (room >= 1 && next < n * 1.15)) return;
      n = next;
    }
  }

  /// Bisects the substeps of the two cheapest columns.
  void bisect() {
    if (!worth_more()) return;
    std::vector<Met> ends = met_;
    std::ranges::sort(ends, {}, &Met::cost);
    Values first;
    int columns = 0;
    for (const Met& end : ends) {
      const Values values = without_substeps(end.values);
      if (columns > 0 && (values == first || end.cost > 1.7 * ends.front().cost)) continue;
      if (columns++ == 0) first = values;
      if (columns > 2) return;
      halve(end.substeps, missed_[values], [&](int substeps) { return attempt(values, substeps); });
    }
  }

  /// Bisects between `high`, which reaches the error, and half of it or `missed`, which do not.
  template <class At>
  void halve(int high, int missed, const At& at) {
    for (int low = std::max(high / 2, missed < high ? missed : 0);
         high - low > std::max(1, high / 10);) {
      const int middle = (low + high) / 2;
      const Candidate* candidate = at(middle);
      if (!candidate) return;
      (target_.meets(*candidate) ? high : low) = middle;
    }
  }

  /// Bisects the sweeps of the best setting.
  void bisect_sweeps() {
    if (!worth_more()) return;
    Values values = without_substeps(best_met_.values);
    const int substeps = best_met_.substeps;
    halve(std::stoi(values[open_.sweeps()]), 0, [&](int sweeps) {
      values[open_.sweeps()] = std::to_string(sweeps);
      return attempt(values, substeps);
    });
  }

  /// Whether this solver is close enough to the best of the others to be refined.
  bool worth_more() const {
    if (!best_) return false;
    return target_.budget || tried_[*best_].cost.mid <= kRefineBelowBest * least(known_);
  }

  void alternatives() {
    for (const Values& change : open_.alternatives()) {
      if (over_) return;
      Values values = without_substeps(best_met_.values);
      for (const auto& [name, value] : change) values[name] = value;
      if (canonical(values) != canonical(without_substeps(best_met_.values)))
        try_beside_best(values);
    }
  }

  /// Tries half and twice the sweeps of the best setting.
  void other_sweeps() {
    if (!worth_more()) return;
    const int sweeps = std::stoi(best_met_.values[open_.sweeps()]);
    for (const int other : {sweeps / 2, 2 * sweeps}) {
      if (over_ || other < 1 || other > kMostSweeps) continue;
      Values values = without_substeps(best_met_.values);
      values[open_.sweeps()] = std::to_string(other);
      try_beside_best(values);
    }
  }

  /// Tries these values with the substeps of the best setting, then with as many as they need.
  void try_beside_best(const Values& values) {
    if (target_.error && expected_substeps(values)) {
      fewest(values, best_met_.substeps);
      return;
    }
    const Candidate* candidate = attempt(values, best_met_.substeps);
    if (!candidate) return;
    if (target_.budget) {  // a cheaper step leaves room for more substeps
      if (candidate->failure.empty() && candidate->cost.mid < 0.8 * *target_.budget) most(values);
      return;
    }
    int n = best_met_.substeps;
    if (target_.meets(*candidate)) {
      while (candidate && target_.meets(*candidate) && n > 1) {
        n = std::min(n - 1, n * 3 / 4);
        candidate = attempt(values, n);
      }
    } else {  // less accurate, but maybe cheap enough that more substeps pay
      while (candidate && !target_.meets(*candidate) && candidate->failure.empty() &&
             1.4 * candidate->cost.mid < least(tried_) && n < kMostSubsteps) {
        n = n + std::max(1, n / 3);
        candidate = attempt(values, n);
      }
    }
  }

  struct Met {
    double cost;
    Values values;
    int substeps;
  };

  Values without_substeps(Values values) const {
    values.erase(open_.substeps());
    return values;
  }

  std::string solver_;
  Target target_;
  const Evaluation& run_;
  OpenParameters open_;
  std::vector<Candidate> known_, tried_;
  double dearest_;
  const Expectation& expected_;
  double off_ = 1;  ///< fewest substeps that were found last, over those that were expected
  std::map<std::string, std::size_t> index_;
  std::optional<std::size_t> best_;
  std::vector<Met> met_;
  std::map<Values, int> missed_;  ///< most substeps that do not meet the target, by other values
  Met best_met_{0, {}, 1};
  bool over_ = false, hopeless_ = false;
  bool at_floor_ = false;  ///< whether the last column ended because more substeps did not help
  double floor_ = kNone;   ///< the error at that floor
};

}  // namespace

std::vector<Candidate> search_settings(const std::string& solver, const Target& target,
                                       const Evaluation& run, std::vector<Candidate> known,
                                       SearchDepth depth, double dearest,
                                       const Expectation& expected) {
  return SettingSearch(solver, target, run, std::move(known), dearest, expected).run(depth);
}

std::string cheapest_setting(const std::string& solver) {
  const Evaluation none;
  return SettingSearch(solver, {}, none, {}, kNone, {}).cheapest();
}

std::vector<std::string> cheapest_first(std::vector<std::string> solvers, const Evaluation& run) {
  std::map<std::string, double> cost;
  for (const std::string& solver : solvers) {
    const auto candidate = run(cheapest_setting(solver));
    const bool known = candidate && candidate->cost.mid > 0;
    cost[solver] = known ? candidate->cost.mid : std::numeric_limits<double>::infinity();
  }
  std::ranges::stable_sort(solvers, {}, [&](const std::string& solver) { return cost[solver]; });
  return solvers;
}

}  // namespace taut
