#include "experiments/timing/search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/model/solver.hpp"

namespace taut {

namespace {

constexpr int kMostSubsteps = 1024;
constexpr double kDearer = 1.3;   ///< a quick cost this much above its own best is not worth a run
constexpr double kHopeless = 30;  ///< nor is one this much above the best of all
constexpr double kFar = 10;       ///< above the best of all: found, but not polished

/// Values of the second knob, each tried with its own number of substeps.
struct Columns {
  std::vector<std::string> knobs;  ///< parameters that take the value together
  std::vector<std::string> values;
  bool sweeps = false;  ///< more of it costs more and needs fewer substeps
};

/// The parts of "a|b|c".
std::vector<std::string> parts_of(std::string_view list) {
  std::vector<std::string> parts;
  while (!list.empty()) {
    const std::size_t end = std::min(list.find('|'), list.size());
    parts.emplace_back(list.substr(0, end));
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  return parts;
}

/// The solver's accuracy knobs, as far as the user's text leaves them open.
class Knobs {
 public:
  explicit Knobs(const std::string& solver) : base_(solver), entry_(*parse_solver(solver).entry) {}

  bool open(std::string_view name) const {
    const auto fixed = [&](char mark) {
      return base_.find(mark + std::string(name) + "=") != std::string::npos;
    };
    return !name.empty() && !fixed(':') && !fixed(',');
  }

  std::string substeps() const { return std::string(entry_.knobs.substeps); }
  bool has_substeps() const { return open(entry_.knobs.substeps); }
  std::string sweeps() const { return std::string(entry_.knobs.sweeps); }

  Columns columns() const {
    if (open(entry_.knobs.sweeps)) return {{sweeps()}, doublings(1, 128), true};
    Columns columns{parts_of(entry_.knobs.stiffness.parameters), {}, false};
    std::erase_if(columns.knobs, [&](const std::string& name) { return !open(name); });
    if (columns.knobs.empty()) return {{}, {""}, false};
    columns.values = parts_of(entry_.knobs.stiffness.values);
    return columns;
  }

  /// Single changes worth trying beside substeps and columns.
  std::vector<std::pair<std::string, std::string>> alternatives() const {
    std::vector<std::pair<std::string, std::string>> all;
    for (const auto& [name, values] : entry_.knobs.alternatives)
      for (const std::string& value : parts_of(values))
        if (open(name) && value != parse_solver(base_).params.value(name))
          all.emplace_back(name, value);
    return all;
  }

 private:
  static std::vector<std::string> doublings(int from, int to) {
    std::vector<std::string> values;
    for (int v = from; v <= to; v *= 2) values.push_back(std::to_string(v));
    return values;
  }
  std::string base_;
  const SolverEntry& entry_;
};

using Values = std::map<std::string, std::string>;

class KnobSearch {
 public:
  KnobSearch(const std::string& solver, const Wish& wish, const Try& run, std::vector<Offer> known)
      : solver_(solver), wish_(wish), run_(run), knobs_(solver), known_(std::move(known)) {}

  std::vector<Offer> run() {
    const Columns columns = knobs_.columns();
    int start = 1, idle = 0;
    for (const std::string& value : columns.values) {
      Values values;
      for (const std::string& knob : columns.knobs) values[knob] = value;
      const auto before = best_;
      if (wish_.error)
        start = columns.sweeps ? std::max(1, fewest(values, start) / 2) : (fewest(values, 1), 1);
      else
        most(values);
      idle = best_ && best_ != before ? 0 : idle + 1;
      if (over_ || (idle >= 2 && (best_ || columns.sweeps == false))) break;
      if (columns.sweeps && hopeless_) break;
    }
    if (wish_.error) bisect();
    if (wish_.error && columns.sweeps) bisect_sweeps();
    if (worth_more()) alternatives();
    return tried_;
  }

 private:
  std::string text(const Values& values) const {
    std::string all = solver_;
    for (const auto& [name, value] : values)
      all += (all.find(':') == std::string::npos ? ":" : ",") + name + "=" + value;
    return all;
  }

  /// The offer at these values and substeps, run at most once; nullptr when time is up.
  const Offer* attempt(Values values, int substeps) {
    if (knobs_.has_substeps()) values[knobs_.substeps()] = std::to_string(substeps);
    const std::string setting = text(values);
    if (const auto at = index_.find(setting); at != index_.end()) return &tried_[at->second];
    if (over_) return nullptr;
    const std::optional<Offer> offer = run_(setting);
    if (!offer) {
      over_ = true;
      return nullptr;
    }
    index_[setting] = tried_.size();
    tried_.push_back(*offer);
    if (wish_.grants(*offer) && (!best_ || wish_.prefers(*offer, tried_[*best_]))) {
      best_ = tried_.size() - 1;
      best_values_ = values, best_substeps_ = substeps;
    }
    if (wish_.grants(*offer)) granted_.push_back({offer->cost.mid, values, substeps});
    return &tried_.back();
  }

  double least(const std::vector<Offer>& offers) const {
    double cost = std::numeric_limits<double>::infinity();
    for (const Offer& o : offers)
      if (wish_.grants(o)) cost = std::min(cost, o.cost.mid);
    return cost;
  }

  /// Quick costs above this are not worth a run. A rival is held to its own best, so that the
  /// runner-up is as well chosen as the winner.
  double bar() const { return std::min(kDearer * least(tried_), kHopeless * least(known_)); }

  /// The fewest substeps, a power of two times `from`, that reach the error; where the walk ended
  /// if none does for a cost worth paying.
  int fewest(const Values& values, int from) {
    int n = from;
    hopeless_ = false;
    const Offer* offer = attempt(values, n);
    if (!offer) return n;
    if (wish_.grants(*offer)) {
      while (n > 1 && (offer = attempt(values, n / 2)) && wish_.grants(*offer)) n /= 2;
      return n;
    }
    double last = offer->error;
    for (int stuck = 0; stuck < 3 && n < kMostSubsteps && knobs_.has_substeps();) {
      if (2 * offer->cost.mid > bar()) {
        hopeless_ = n == from;  // not even the start of the next column can be cheaper
        return n;
      }
      n *= 2;
      offer = attempt(values, n);
      if (!offer || wish_.grants(*offer)) return n;
      // Explosions have no error; rounding is a floor that no number of substeps passes.
      stuck = offer->error > 0.9 * last ? stuck + 1 : 0;
      if (!std::isnan(offer->error)) last = offer->error;
    }
    return n;
  }

  /// As many substeps as the budget allows, by the cost of those tried.
  void most(const Values& values) {
    int n = 1;
    for (int i = 0; i < 4; ++i) {
      const Offer* offer = attempt(values, n);
      if (!offer) return;
      const double room = 0.97 * *wish_.budget / offer->cost.mid;
      const int next = std::clamp(static_cast<int>(n * std::min(room, 1e6)), 1, kMostSubsteps);
      if (next == n || !knobs_.has_substeps() || (room >= 1 && next < n * 1.15)) return;
      n = next;
    }
  }

  /// The two cheapest columns, each between the fewest substeps that reach the error and half of
  /// them, which do not.
  void bisect() {
    if (!worth_more()) return;
    std::vector<Granted> ends = granted_;
    std::ranges::sort(ends, {}, &Granted::cost);
    Values first;
    int columns = 0;
    for (const Granted& end : ends) {
      const Values values = without_substeps(end.values);
      if (columns > 0 && (values == first || end.cost > 1.7 * ends.front().cost)) continue;
      if (columns++ == 0) first = values;
      if (columns > 2) return;
      bisect(values, end.substeps);
    }
  }

  void bisect(const Values& values, int high) {
    int low = high / 2;
    while (high - low > std::max(1, high / 10)) {
      const int middle = (low + high) / 2;
      const Offer* offer = attempt(values, middle);
      if (!offer) return;
      (wish_.grants(*offer) ? high : low) = middle;
    }
  }

  /// The sweeps of the best, between what it has and half of it.
  void bisect_sweeps() {
    if (!worth_more()) return;
    Values values = without_substeps(best_values_);
    const int substeps = best_substeps_;
    int high = std::stoi(values[knobs_.sweeps()]), low = high / 2;
    while (high - low > std::max(1, high / 10)) {
      const int middle = (low + high) / 2;
      values[knobs_.sweeps()] = std::to_string(middle);
      const Offer* offer = attempt(values, substeps);
      if (!offer) return;
      (wish_.grants(*offer) ? high : low) = middle;
    }
  }

  /// Whether this solver is near enough to the best of the others to be polished.
  bool worth_more() const {
    if (!best_) return false;
    return wish_.budget || tried_[*best_].cost.mid <= kFar * least(known_);
  }

  void alternatives() {
    for (const auto& [name, value] : knobs_.alternatives()) {
      if (over_) return;
      Values values = without_substeps(best_values_);
      if (values.contains(name) && values[name] == value) continue;
      values[name] = value;
      const Offer* offer = attempt(values, best_substeps_);
      if (!offer) return;
      if (wish_.budget) {  // a cheaper step buys more of them
        if (!offer->failed && offer->cost.mid < 0.8 * *wish_.budget) most(values);
        continue;
      }
      int n = best_substeps_;
      if (wish_.grants(*offer)) {
        while (offer && wish_.grants(*offer) && n > 1) {
          n = std::min(n - 1, n * 3 / 4);
          offer = attempt(values, n);
        }
      } else {  // less accurate, but perhaps so much cheaper that more substeps pay
        while (offer && !wish_.grants(*offer) && !offer->failed &&
               1.4 * offer->cost.mid < least(tried_) && n < kMostSubsteps) {
          n = n + std::max(1, n / 3);
          offer = attempt(values, n);
        }
      }
    }
  }

  struct Granted {
    double cost;
    Values values;
    int substeps;
  };

  Values without_substeps(Values values) const {
    values.erase(knobs_.substeps());
    return values;
  }

  std::string solver_;
  Wish wish_;
  const Try& run_;
  Knobs knobs_;
  std::vector<Offer> known_, tried_;
  std::map<std::string, std::size_t> index_;
  std::optional<std::size_t> best_;
  Values best_values_;
  std::vector<Granted> granted_;
  int best_substeps_ = 1;
  bool over_ = false, hopeless_ = false;
};

}  // namespace

bool Wish::grants(const Offer& o) const {
  if (o.failed || std::isnan(o.error)) return false;
  return error ? o.error <= *error : o.cost.mid <= *budget;
}

bool Wish::prefers(const Offer& a, const Offer& b) const {
  if (grants(a) != grants(b)) return grants(a);
  const auto by_cost = std::pair(a.cost.mid, a.error), by_cost_b = std::pair(b.cost.mid, b.error);
  const auto by_error = std::pair(a.error, a.cost.mid), by_error_b = std::pair(b.error, b.cost.mid);
  return error ? by_cost < by_cost_b : by_error < by_error_b;
}

std::vector<Offer> search_settings(const std::string& solver, const Wish& wish, const Try& run,
                                   std::vector<Offer> known) {
  return KnobSearch(solver, wish, run, std::move(known)).run();
}

}  // namespace taut
