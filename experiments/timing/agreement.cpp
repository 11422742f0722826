#include "experiments/timing/agreement.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

/// Largest |log| of an A/A control's ends.
double strayed(const Interval& control) {
  return std::max(std::abs(std::log(control.low)), std::abs(std::log(control.high)));
}

/// The case of the same id; nothing if it was not timed or failed.
std::optional<std::size_t> same_case(const SceneBench& bench, const std::string& id) {
  for (std::size_t i = 0; i < bench.cases.size(); ++i)
    if (bench.cases[i].record.id == id && bench.cases[i].sound()) return i;
  return {};
}

void compare_ratios(const SceneBench& a, const SceneBench& b, double tolerance, Agreement& out) {
  std::optional<std::pair<std::size_t, std::size_t>> first;
  const double noise = std::max({std::log1p(tolerance), strayed(a.control), strayed(b.control)});
  for (std::size_t i = 0; i < a.cases.size(); ++i) {
    const auto j = same_case(b, a.cases[i].record.id);
    if (!j || !a.cases[i].sound()) continue;
    if (!first) {
      first = {i, *j};
      continue;
    }
    TwiceMeasured both{a.scene, a.cases[i].record.id, *a.ratio(i, first->first),
                       *b.ratio(*j, first->second)};
    both.overlap = both.a.low <= both.b.high && both.b.low <= both.a.high;
    both.contradict = !both.overlap && std::abs(std::log(both.a.mid / both.b.mid)) > noise;
    out.ratios.push_back(both);
  }
}

void compare_answers(const SceneBench& a, const SceneBench& b, const std::string& metric,
                     Agreement& out) {
  for (const double level : kErrorLevels) {
    const std::vector<Offer> one = a.offers(metric), two = b.offers(metric);
    const auto i = cheapest_within(one, "", level), j = cheapest_within(two, "", level);
    TwiceAnswered both{a.scene, level, i ? one[*i].setting : "", j ? two[*j].setting : "",
                       i.has_value() != j.has_value()};
    if (i && j) both.contradict = one[*i].solver != two[*j].solver;
    out.answers.push_back(both);
  }
}

}  // namespace

std::size_t Agreement::overlapping() const {
  return static_cast<std::size_t>(
      std::count_if(ratios.begin(), ratios.end(), [](const auto& r) { return r.overlap; }));
}

std::size_t Agreement::contradictions() const {
  const auto wrong = [](const auto& r) { return r.contradict; };
  return static_cast<std::size_t>(std::count_if(ratios.begin(), ratios.end(), wrong) +
                                  std::count_if(answers.begin(), answers.end(), wrong));
}

Agreement agreement(const BenchSession& a, const BenchSession& b, const std::string& metric,
                    double tolerance) {
  Agreement all;
  for (const SceneBench& one : a.scenes)
    for (const SceneBench& two : b.scenes) {
      if (one.scene != two.scene) continue;
      compare_ratios(one, two, tolerance, all);
      compare_answers(one, two, metric, all);
    }
  return all;
}

}  // namespace taut
