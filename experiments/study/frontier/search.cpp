#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>

#include "core/io/document.hpp"
#include "core/model/input_error.hpp"
#include "core/model/names.hpp"
#include "core/model/scene_keys.hpp"
#include "core/model/scene_setting.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "core/reference/linear_stability.hpp"
#include "experiments/study/frontier/frontier.hpp"

namespace taut {

namespace {

/// Values looked at between the bracket and the next value tried above it.
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
    return rounded_to(value, digits);
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
    std::ranges::sort(result_.probes, {}, &Probed::value);
    if (!all) result_.kind = Frontier::Kind::not_answered;
    return all;
  }

  void bracket() {
    std::vector<Probed> known;
    std::ranges::copy_if(result_.probes, std::back_inserter(known), &Probed::known);
    if (known.empty()) return;
    const auto first = std::ranges::find(known, false, &Probed::stable);
    const bool any = first != known.end(), below = first != known.begin();
    if (any) result_.unstable = first->value;
    if (below) result_.stable = std::prev(first)->value;
    result_.kind = !any     ? Frontier::Kind::all_stable
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

const ParamSpec& find_param(const SolverChoice& choice, const std::string& name) {
  std::vector<std::string> names{"dt"};
  for (const ParamSpec& spec : choice.entry->params) {
    if (spec.name == name) return spec;
    names.emplace_back(spec.name);
  }
  throw InputError(std::string(choice.entry->name) + " has no parameter '" + name + "'" +
                   suggestion(name, names) + " (a scene key has a dot, as \"wind.strength\")");
}

}  // namespace

std::string_view to_string(Frontier::Kind kind) {
  constexpr Names<Frontier::Kind::not_answered> kNames{"bracketed", "all stable", "none stable",
                                                       "not answered"};
  return kNames[kind];
}

const Probed* Frontier::at(double value) const {
  const auto found = std::ranges::find(probes, value, &Probed::value);
  return found == probes.end() ? nullptr : &*found;
}

Frontier find_frontier(const SearchRange& range, const Trial& trial) {
  return BorderSearch(range, trial).run();
}

double FrontierQuestion::setting(double value) const {
  if (direction == Direction::up) return value;
  if (direction == Direction::down_in_whole_numbers) return std::round(1 / value);
  // Six digits are more than a bracket has.
  return rounded_to(1 / value, 6);
}

CaseSpec FrontierQuestion::at(double value) const {
  CaseSpec spec = base;
  const std::string text = shortest(setting(value));
  for (const std::string& name : parts_of(of))
    if (name == "dt")
      spec.settings =
          replaced(std::move(spec.settings), {SceneSetting("time.dt", '"' + text + '"')});
    else if (is_of_scene(name))
      spec.settings = replaced(std::move(spec.settings), {SceneSetting(name, text)});
    else
      spec.solver = parse_solver(spec.solver).with(name, text).brief();
  return spec;
}

SearchRange range_of(const CaseSpec& base, const std::string& of, std::optional<double> from,
                     std::optional<double> to) {
  SearchRange range;
  const SolverChoice choice = parse_solver(base.solver);
  if (of == "dt") {
    range = kTimeSteps;
  } else if (is_of_scene(of)) {
    const SceneKey* key = find_scene_key(of.substr(0, of.find('|')));
    if (key && !key->choices.empty())
      throw InputError("'" + of + "' is one of " + std::string(key->choices) + ", not a number");
    if (key && key->type == "string") throw InputError("'" + of + "' is a text, not a number");
    if (key) {
      range.from = key->range.min;
      range.to = key->range.max;
    }
  } else {
    const ParamSpec& spec = find_param(choice, of.substr(0, of.find('|')));
    if (spec.kind == ParamSpec::Kind::text)
      throw InputError("'" + of + "' is a text, not a number");
    if (spec.kind == ParamSpec::Kind::choice)
      throw InputError("'" + of + "' is one of " + std::string(spec.choices) + ", not a number");
    range.from = spec.min;
    range.to = spec.max;
    range.whole = spec.kind == ParamSpec::Kind::integer;
  }
  // Ranges such as 0 to infinity only say what is a number at all.
  const bool endless = !(range.to > range.from) || range.to > 1e4;
  if (endless && !(from && to)) {
    std::vector<std::string> keys;
    for (const SceneKey& key : scene_keys()) keys.emplace_back(key.path);
    const bool is_key = !is_of_scene(of) || find_scene_key(of.substr(0, of.find('|')));
    throw InputError("'" + of + "' has no range of its own: give --from and --to" +
                     (is_key ? "" : suggestion(of, keys)));
  }
  range.from = from.value_or(range.from);
  range.to = to.value_or(range.to);
  if (!(range.from < range.to))
    throw InputError("--from " + shortest(range.from) + " must be below --to " +
                     shortest(range.to));
  return range;
}

CaseFrontier find_frontier(const FrontierQuestion& question, Store& store,
                           const CampaignOptions& options, const Judge& judge) {
  CaseFrontier result;
  CaseMaker maker;
  std::vector<std::pair<double, Record>> seen;
  result.frontier = find_frontier(question.range, [&](const std::vector<double>& values) {
    std::vector<Case> cases;
    for (const double value : values) cases.push_back(maker.make(question.at(value)));
    const CasesRun run = run_and_read(std::move(cases), store, options);
    result.ran += run.campaign.ran;
    result.interrupted = result.interrupted || run.campaign.interrupted;
    std::vector<Outcome> outcomes;
    for (std::size_t i = 0; i < run.cases.size() && run.records[i]; ++i) {
      const Record& record = *run.records[i];
      seen.emplace_back(values[i], record);
      outcomes.push_back({record.status, judge ? judge(run.cases[i], record) : ""});
    }
    return outcomes;
  });
  std::ranges::sort(seen, {}, [](const auto& one) { return one.first; });
  for (auto& [value, record] : seen) result.records.push_back(std::move(record));
  return result;
}

std::optional<Prediction> predicted_frontier(const FrontierQuestion& question) {
  const auto theory = [&](double value) {
    const Case one = make_case(question.at(value));
    return linear_stability(*one.scene, one.choice);
  };
  const SearchRange& range = question.range;
  const auto first = theory(range.from), last = theory(range.to);
  if (!first || !last) return {};
  if (!first->stable())
    return Prediction{Frontier::Kind::none_stable, range.from, last->growth, first->law};
  if (last->stable())
    return Prediction{Frontier::Kind::all_stable, range.to, last->growth, last->law};
  Prediction result{Frontier::Kind::bracketed, range.to, last->growth, last->law};
  double low = range.from, high = range.to;
  while (high - low > 1e-6 * std::abs(high)) {
    const double middle = low > 0 ? std::sqrt(low * high) : (low + high) / 2;
    const double tried = range.whole ? std::round(middle) : middle;
    if (tried <= low || tried >= high) break;
    const auto there = theory(tried);
    if (!there) return {};
    (there->stable() ? low : high) = tried;
    if (!there->stable()) result.growth = there->growth;
  }
  result.value = range.whole ? low : (low + high) / 2;
  return result;
}

}  // namespace taut
