#include "experiments/study/bisection.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace taut {

namespace {

/// Values looked at between the bracket and the coarse value above it.
constexpr int kLooksAbove = 4;

class BorderSearch {
 public:
  BorderSearch(const SearchRange& range, const Trial& trial) : range_(range), trial_(trial) {}

  Frontier run() {
    if (answers(coarse_values())) {
      bracket();
      look_above();
    }
    return std::move(result_);
  }

 private:
  bool geometric() const { return range_.from > 0; }

  /// The value at the fraction s of the way from a to b, with no more digits than are needed.
  double between(double a, double b, double s) const {
    const double value = geometric() ? a * std::pow(b / a, s) : a + s * (b - a);
    if (range_.whole) return std::round(value);
    const int digits =
        std::clamp(3 - static_cast<int>(std::floor(std::log10(range_.tolerance))), 3, 17);
    char text[40];
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    return std::strtod(text, nullptr);
  }

  std::vector<double> coarse_values() const {
    std::vector<double> values{range_.from};
    for (int i = 1; i + 1 < range_.coarse; ++i)
      values.push_back(
          between(range_.from, range_.to, static_cast<double>(i) / (range_.coarse - 1)));
    values.push_back(range_.to);
    values.erase(std::unique(values.begin(), values.end()), values.end());
    return values;
  }

  /// False if not all of them were answered; then the result stays `not_answered`.
  bool answers(const std::vector<double>& values) {
    const std::vector<Outcome> outcomes = trial_(values);
    bool all = outcomes.size() == values.size();
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
      const Outcome& one = outcomes[i];
      result_.probes.push_back({one, values[i]});
      all = all && (one.status.kind != Status::Kind::unsupported || !one.symptom.empty());
    }
    std::sort(result_.probes.begin(), result_.probes.end(),
              [](const Probed& a, const Probed& b) { return a.value < b.value; });
    if (!all) result_.kind = Frontier::Kind::not_answered;
    return all;
  }

  void bracket() {
    const Probed* below = nullptr;
    const Probed* first = nullptr;
    for (const Probed& probe : result_.probes) {
      if (!probe.known()) continue;
      if (!probe.stable()) {
        first = &probe;
        break;
      }
      below = &probe;
    }
    if (!first && !below) return;
    if (first) result_.unstable = first->value;
    if (below) result_.stable = below->value;
    result_.kind = !first   ? Frontier::Kind::all_stable
                   : !below ? Frontier::Kind::none_stable
                            : Frontier::Kind::bracketed;
    if (result_.kind == Frontier::Kind::bracketed) halve();
  }

  void halve() {
    while (result_.unstable - result_.stable > range_.tolerance * std::abs(result_.unstable)) {
      const double middle = between(result_.stable, result_.unstable, 0.5);
      if (middle <= result_.stable || middle >= result_.unstable) break;
      if (!answers({middle})) return;
      if (!result_.at(middle)->known()) break;
      (result_.at(middle)->stable() ? result_.stable : result_.unstable) = middle;
    }
  }

  void look_above() {
    if (result_.kind != Frontier::Kind::bracketed && result_.kind != Frontier::Kind::none_stable)
      return;
    double next = range_.to;
    for (const Probed& probe : result_.probes)
      if (probe.value > result_.unstable) next = std::min(next, probe.value);
    std::vector<double> values;
    for (int i = 1; i <= kLooksAbove; ++i) {
      const double value =
          between(result_.unstable, next, static_cast<double>(i) / (kLooksAbove + 1));
      if (value > result_.unstable && value < next && (values.empty() || value > values.back()))
        values.push_back(value);
    }
    if (!values.empty() && !answers(values)) return;
    for (const Probed& probe : result_.probes) {
      if (probe.value <= result_.unstable) continue;
      ++result_.above;
      if (probe.stable()) result_.stable_above.push_back(probe.value);
    }
  }

  const SearchRange& range_;
  const Trial& trial_;
  Frontier result_;
};

}  // namespace

std::string_view to_string(Frontier::Kind kind) {
  switch (kind) {
    case Frontier::Kind::bracketed:
      return "bracketed";
    case Frontier::Kind::all_stable:
      return "all stable";
    case Frontier::Kind::none_stable:
      return "none stable";
    default:
      return "not answered";
  }
}

const Probed* Frontier::at(double value) const {
  for (const Probed& probe : probes)
    if (probe.value == value) return &probe;
  return nullptr;
}

Frontier find_frontier(const SearchRange& range, const Trial& trial) {
  return BorderSearch(range, trial).run();
}

}  // namespace taut
