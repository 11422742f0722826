#include "experiments/advise/advice_answer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/system/process.hpp"

namespace taut {

namespace {

constexpr std::size_t kMostRefused = 4;  ///< printed unless all are requested

std::string command(const AdviceWanted& wanted, const Advice& advice) {
  std::string text = "taut bench " + shell_word(wanted.scene);
  for (const SceneSetting& one : wanted.settings) text += " --set " + shell_word(one.text());
  const auto solver = [&](std::size_t i) {
    text +=
        " --solver " + shell_word(parse_solver(advice.bench.cases[i].record.spec.solver).brief());
  };
  solver(*advice.recommendation.best);
  if (advice.recommendation.runner_up) solver(*advice.recommendation.runner_up);
  return text + " --metric " + wanted.metric;
}

/// Adds the best setting, its certainty, and the command that compares it again.
void add_best(Answer& answer, const AdviceWanted& wanted, const Advice& advice) {
  const Recommendation& chosen = advice.recommendation;
  const Record& record = advice.best().record;
  Cell best(parse_solver(record.spec.solver).brief());
  best.key = record.key;
  answer.add({"best", advice.called()}, best.with(verdict(chosen, advice.bench)));
  answer.add({"error", wanted.metric, unit_of_value(wanted.metric)},
             error_of(record, wanted.metric));
  answer.add({"cost", "CPU time", wanted.frame()}, advice.cost);
  answer.add({"again", "timed again", wanted.frame()},
             Cell(advice.again)
                 .with(advice.confirmed()
                           ? ""
                           : "OUTSIDE THE INTERVAL: THIS MACHINE IS TOO NOISY NOW TO JUDGE"));
  answer.add({"control", "the same code against itself"}, advice.bench.control);
  answer.add({"same_bits", "run again, the same bits"}, advice.same_bits);
  answer.add(Column("confirmed").in_detail(), advice.confirmed());
  answer.add(Column("certainty").in_detail(), to_string(chosen.certainty));
  answer.add(Column("command", "compare again").of_commands(), command(wanted, advice));
}

/// Adds the closest miss if nothing meets the target.
void add_nearest(Answer& answer, const AdviceWanted& wanted, const Advice& advice) {
  const auto miss = [&](const Candidate& c) { return advice.target.error ? c.error : c.cost.mid; };
  const Candidate* nearest = nullptr;
  for (const Candidate& c : advice.tried)
    if (c.failure.empty() && std::isfinite(c.error) && (!nearest || miss(c) < miss(*nearest)))
      nearest = &c;
  answer.add({"best", advice.called()},
             Cell().with(advice.too_dear     ? "unreachable"
                         : advice.complete() ? "never reached"
                                             : "not reached in the time given"));
  if (advice.too_dear) {
    answer.add({"cheapest", "the cheapest setting"},
               parse_solver(advice.too_dear->setting).brief());
    answer.add({"cheapest_cost", "its CPU time", wanted.frame()}, advice.too_dear->cost.mid);
  }
  if (!nearest) return;
  answer.add({"nearest"}, parse_solver(nearest->setting).brief());
  answer.add({"error", wanted.metric, unit_of_value(wanted.metric)}, nearest->error);
  answer.add({"quick_cost", "CPU time", wanted.frame()}, nearest->cost.mid);
}

/// Row of a solver that was not timed at the end: its cells up to the error, and the reason.
std::vector<Cell> not_timed(const AdviceWanted& wanted, const Advice& advice,
                            const std::string& solver) {
  const auto refused = std::ranges::find(advice.unsupported, solver, &Refused::solver);
  if (refused != advice.unsupported.end()) return {solver, "", {}, "unsupported: " + refused->why};
  const std::string name(parse_solver(solver).entry->name);
  const auto row = [&](std::size_t at, const std::string& why) -> std::vector<Cell> {
    const Candidate& c = advice.tried[at];
    return {name, parse_solver(c.setting).brief(), c.error,
            why + number_text(c.cost.mid, wanted.frame()) + " by its quick cost"};
  };
  if (const auto best = best_for(advice.target, advice.tried, name))
    return row(*best, "reaches it, not timed beside the others: ");
  constexpr double kAny = std::numeric_limits<double>::infinity();
  const Target any = advice.target.error ? Target{{}, kAny} : Target{kAny, {}};
  if (const auto nearest = best_for(any, advice.tried, name))
    return row(*nearest, "not reached by the settings tried; the nearest: ");
  const auto tried = std::ranges::find(advice.tried, name, &Candidate::solver);
  return {name,
          "",
          {},
          tried == advice.tried.end()
              ? "not tried: --patience had ended"
              : "every setting tried was refused, such as " + parse_solver(tried->setting).brief() +
                    ": " + tried->failure};
}

/// A table of every solver's best, compared with the best of all. A solver without one has a row
/// with the reason.
Table solvers_of(const AdviceWanted& wanted, const Advice& advice) {
  Table table{"solvers",
              advice.cut.empty() ? "every solver's best" : "the cheapest so far of each solver",
              {{"solver"},
               {"setting"},
               {"error", wanted.metric, unit_of_value(wanted.metric)},
               {"cost", "CPU time", wanted.frame()},
               {"times", advice.cut.empty() ? "x the best" : "x the first"},
               {"peak_bytes", "memory", kMegabytes}}};
  for (const Limit& limit : wanted.limits)
    table.columns.push_back({limit.name, "", unit_of_value(limit.name)});
  table.columns.emplace_back("note", "");
  for (const SolverRecommendation& solver : advice.recommendation.solvers) {
    auto& row = table.rows.emplace_back();
    row = {solver.solver};
    if (solver.at) {
      const BenchedCase& c = advice.bench.cases[*solver.at];
      row.insert(row.end(),
                 {parse_solver(c.record.spec.solver).brief(), error_of(c.record, wanted.metric),
                  c.cost(), solver.times, c.timing.peak_bytes});
      for (const Limit& limit : wanted.limits) row.push_back(c.record.value(limit.name));
      row.emplace_back("");
    } else {
      row.resize(table.columns.size());
      row.back() = nearest(solver, advice.bench, advice.recommendation, wanted.metric);
    }
  }
  for (const std::string& solver : wanted.solvers) {
    const auto timed =
        std::ranges::find(advice.recommendation.solvers, parse_solver(solver).entry->name,
                          &SolverRecommendation::solver);
    if (timed != advice.recommendation.solvers.end() || advice.too_dear) continue;
    std::vector<Cell> cells = not_timed(wanted, advice, solver);
    const Cell why = cells.back();
    cells.pop_back();
    cells.resize(table.columns.size());
    cells.back() = why;
    table.rows.push_back(std::move(cells));
  }
  return table;
}

/// A table of the limits besides the error, and the values of the best setting.
Table limits_of(const AdviceWanted& wanted, const Advice& advice) {
  Table table{
      "kept", "limits besides the error", {{"value"}, {"limit", "at most"}, {"best", "here"}}};
  const bool any = advice.recommendation.best.has_value();
  for (const Limit& limit : wanted.limits) {
    const auto said = [&](double value) {
      return unit_of_value(limit.name).shown.empty() ? Cell(value)
                                                     : Cell(value).with(limit.text(value));
    };
    table.rows.push_back({limit.name, said(limit.most),
                          any ? said(std::abs(advice.best().record.value(limit.name))) : Cell()});
  }
  return table;
}

Table without_of(const AdviceWanted& wanted, const Advice& advice) {
  Table table{"without",
              "what costs most in the cheapest setting",
              {{"effect", "without"},
               {"share", "its share", kShare, 2},
               {"cost", "CPU time left", wanted.frame()},
               {"fits", "fits the budget"}}};
  for (const auto& [effect, cost] : advice.without)
    table.rows.push_back(
        {effect, 1 - cost / advice.too_dear->cost.mid, cost, cost <= *advice.target.budget});
  table.most = kMostRefused;
  return table;
}

Table tried_of(const AdviceWanted& wanted, const Advice& advice) {
  Table table{"tried",
              "all that was tried",
              {{"setting"},
               {"error", wanted.metric, unit_of_value(wanted.metric)},
               {"quick_cost", "quick CPU time", wanted.frame()},
               {"refused"}}};
  for (const Candidate& c : advice.tried)
    table.rows.push_back({parse_solver(c.setting).brief(), c.error, c.cost.mid, c.failure});
  table.detail = true;
  return table;
}

/// A table of everything refused.
Table refused_of(const Advice& advice) {
  Table table{"refused", "refused", {{"setting"}, {"why"}}};
  for (const auto& [solver, why] : advice.unsupported)
    table.rows.push_back({solver, "unsupported: " + why});
  for (const Candidate& c : advice.tried)
    if (!c.failure.empty()) table.rows.push_back({parse_solver(c.setting).brief(), c.failure});
  table.most = kMostRefused;
  return table;
}

}  // namespace

Answer answer_of(const AdviceWanted& wanted, const Advice& advice) {
  std::string subject = wanted.scene + ", " + text(advice.target, wanted.metric, wanted.fps);
  if (!wanted.judged) subject += "; MOTION NOT JUDGED: no reference says where the cloth should be";
  if (!advice.cut.empty())
    subject += "; INCOMPLETE: --patience ended the search of " + join(advice.cut, ", ");
  Answer answer{"advise", subject};
  if (advice.recommendation.best)
    add_best(answer, wanted, advice);
  else
    add_nearest(answer, wanted, advice);
  answer.add({"searched", "settings searched"}, advice.tried.size());
  answer.add({"seconds", "time", kTime}, advice.elapsed);
  answer.add({"patience", "of", kTime}, wanted.patience);
  answer.add(Column("complete").in_detail(), advice.complete());
  answer.add(solvers_of(wanted, advice));
  answer.add(limits_of(wanted, advice));
  answer.add(without_of(wanted, advice));
  answer.add(refused_of(advice));
  Table not_done{"not_done", "NOT DONE: stopped by --patience", {{"solver"}, {"what"}}};
  for (const std::string& solver : advice.cut) not_done.rows.push_back({solver, "search"});
  for (const std::string& solver : advice.unrefined)
    not_done.rows.push_back({solver, "refinement of its best"});
  answer.add(std::move(not_done));
  answer.add(tried_of(wanted, advice));
  return answer;
}

}  // namespace taut
