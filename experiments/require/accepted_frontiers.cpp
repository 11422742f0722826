#include "experiments/require/accepted_frontiers.hpp"

#include <algorithm>

#include "core/model/text.hpp"
#include "experiments/study/limits.hpp"
#include "experiments/system/read_all.hpp"

namespace taut {

namespace {

bool is_answered(const BothFrontiers& both) {
  return both.stable.frontier.kind != Frontier::Kind::not_answered;
}

std::vector<Limit> limits_of(const std::vector<std::string>& keep, const Scene& scene) {
  if (keep.empty()) return default_limits(scene);
  std::vector<Limit> limits;
  read_all(keep, [&](const std::string& text) { limits.push_back(parse_limit(text, scene)); });
  return limits;
}

FrontierQuestion question_of(const AcceptedFrontiersWanted& wanted, const std::string& solver) {
  FrontierQuestion question{wanted.base, wanted.of, {}};
  question.base.solver = solver;
  question.range = range_of(question.base, wanted.of, wanted.from, wanted.to);
  question.range.tolerance = wanted.tolerance;
  return question;
}

}  // namespace

bool AcceptedFrontiers::any_answered() const {
  return std::ranges::any_of(of_solvers, [](const auto& one) { return is_answered(one.second); });
}

std::optional<AcceptedFrontiers> find_accepted_frontiers(const AcceptedFrontiersWanted& wanted,
                                                         Store& store) {
  AcceptedFrontiers found;
  std::vector<Limit> limits;
  for (const std::string& solver : wanted.solvers) {
    FrontierQuestion question = question_of(wanted, solver);
    const Case first = make_case(question.at(question.range.from));
    if (limits.empty()) limits = limits_of(wanted.keep, *first.scene);
    store.begin_session("taut frontier " + first.id);
    BothFrontiers both =
        find_both(question, store, wanted.how,
                  [&](const Case&, const Record& record) { return beyond(record, limits); });
    if (both.stable.interrupted) return {};
    found.of_solvers.emplace_back(std::move(question), std::move(both));
  }
  found.limits = join(limits, ", ", [](const Limit& limit) {
    return limit.name + " at most " + limit.text(limit.most);
  });
  return found;
}

Answer answer_of(const AcceptedFrontiers& found) {
  if (found.of_solvers.size() > 1) return answer_of(found.of_solvers, found.limits);
  const auto& [question, both] = found.of_solvers.front();
  return answer_of(question, both, is_answered(both) ? predicted_frontier(question) : std::nullopt);
}

}  // namespace taut
