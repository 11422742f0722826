#include "experiments/study/frontier.hpp"

#include <algorithm>
#include <cmath>

#include "core/io/section.hpp"
#include "core/model/input_error.hpp"
#include "core/model/shortest.hpp"
#include "core/reference/linear_stability.hpp"

namespace taut {

namespace {

const ParamSpec& find_param(const SolverChoice& choice, const std::string& name) {
  std::vector<std::string> names{"dt"};
  for (const ParamSpec& spec : choice.entry->params) {
    if (spec.name == name) return spec;
    names.emplace_back(spec.name);
  }
  throw InputError(std::string(choice.entry->name) + " has no parameter '" + name + "'" +
                   suggestion(name, names) + " (a scene key has a dot, as \"wind.strength\")");
}

bool of_scene(const std::string& of) { return of.find('.') != std::string::npos; }

}  // namespace

CaseSpec FrontierQuestion::at(double value) const {
  CaseSpec spec = base;
  if (of == "dt")
    spec.overrides.push_back("time.dt=\"" + shortest(value) + "\"");
  else if (of_scene(of))
    spec.overrides.push_back(of + "=" + shortest(value));
  else
    spec.solver +=
        (spec.solver.find(':') == std::string::npos ? ":" : ",") + of + "=" + shortest(value);
  return spec;
}

SearchRange range_of(const CaseSpec& base, const std::string& of, std::optional<double> from,
                     std::optional<double> to) {
  SearchRange range;
  const SolverChoice choice = parse_solver(base.solver);
  if (of == "dt") {
    range.from = 1e-3, range.to = 0.5;
  } else if (!of_scene(of)) {
    const ParamSpec& spec = find_param(choice, of);
    if (spec.kind == ParamSpec::Kind::text)
      throw InputError("'" + of + "' is a text, not a number");
    if (spec.kind == ParamSpec::Kind::choice)
      throw InputError("'" + of + "' is one of " + std::string(spec.choices) + ", not a number");
    range.from = spec.min, range.to = spec.max;
    range.whole = spec.kind == ParamSpec::Kind::integer;
  }
  // Ranges such as 0 to infinity only say what is a number at all.
  const bool endless = !(range.to > range.from) || range.to > 1e4;
  if (endless && !(from && to))
    throw InputError("'" + of + "' has no range of its own: give --from and --to");
  range.from = from.value_or(range.from), range.to = to.value_or(range.to);
  if (!(range.from < range.to))
    throw InputError("--from " + shortest(range.from) + " must be below --to " +
                     shortest(range.to));
  return range;
}

CaseFrontier find_frontier(const FrontierQuestion& question, const Store& store,
                           const Session& session, const CampaignOptions& options) {
  CaseFrontier result;
  CaseMaker maker;
  std::vector<std::pair<double, Record>> seen;
  result.frontier = find_frontier(question.range, [&](const std::vector<double>& values) {
    std::vector<Case> cases;
    for (const double value : values) cases.push_back(maker.make(question.at(value)));
    const CampaignProgress campaign = run_cases(cases, store, session, options);
    result.ran += campaign.ran;
    result.interrupted = result.interrupted || campaign.interrupted;
    std::vector<Status> statuses;
    for (std::size_t i = 0; i < cases.size(); ++i) {
      const std::optional<Record> record = store.find(cases[i]);
      if (!record) break;
      seen.emplace_back(values[i], *record);
      statuses.push_back(record->status);
    }
    return statuses;
  });
  std::sort(seen.begin(), seen.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
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
