#include "experiments/study/frontier/frontier_answer.hpp"

#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"

namespace taut {

namespace {

Unit unit_of(const FrontierQuestion& question) {
  if (question.of == "dt") return kTime;
  const SolverChoice choice = parse_solver(question.base.solver);
  for (const ParamSpec& spec : choice.entry->params)
    if (spec.name == question.of && !spec.unit.empty())
      return {Unit::Kind::other, spec.unit, spec.unit};
  return kNumber;
}

/// How well theory and bracket agree.
std::string agreement(const Prediction& theory, const Frontier& found) {
  if (theory.kind != found.kind)
    return std::string("theory says ") + std::string(to_string(theory.kind)) + " here";
  if (theory.kind != Frontier::Kind::bracketed) return "agrees";
  if (theory.value >= found.stable && theory.value <= found.unstable) return "inside the bracket";
  const double nearest = theory.value < found.stable ? found.stable : found.unstable;
  const double off = nearest / theory.value - 1;
  return "measured " + std::string(off < 0 ? "" : "+") + number_text(off, kShare, 2) + " from it";
}

void add_theory(Answer& answer, const std::optional<Prediction>& theory, const Frontier& found,
                const Unit& unit) {
  const Column column("theory", "theory", unit, 5);
  if (!theory)
    return answer.add(column, Cell().with("none for these settings; there is one for few links, "
                                          "with jakobsen in order=mesh"));
  const bool bracketed = theory->kind == Frontier::Kind::bracketed;
  answer.add(column, (bracketed ? Cell(theory->value) : Cell(to_string(theory->kind)))
                         .with(agreement(*theory, found) + ": " + theory->law));
  if (theory->growth > 1 + 1e-6 && theory->kind == Frontier::Kind::none_stable)
    answer.add({"growth", "growth per step, theory", kNumber, 5}, theory->growth);
}

/// Why the acceptable range ends at a value that was tried: "stretch.rms 31 %, more than 10 %".
std::string ends_with(const Frontier& found) {
  const bool none = found.kind == Frontier::Kind::none_stable;
  const Probed* probe =
      found.kind == Frontier::Kind::all_stable ? nullptr : found.at(found.unstable);
  if (!probe) return none ? "" : "to the end of the range (--to)";
  return probe->symptom.empty() ? describe(probe->status) : probe->symptom;
}

/// Adds the last acceptable value, beside the last stable one.
void add_acceptable(Answer& answer, const Frontier& found, const Unit& unit) {
  const Column column("acceptable", "acceptable up to", unit, 7);
  if (found.kind == Frontier::Kind::none_stable)
    answer.add(column, Cell("none").with("from the start: " + ends_with(found)));
  else if (found.kind != Frontier::Kind::not_answered)
    answer.add(column, Cell(found.stable)
                           .with(found.kind == Frontier::Kind::all_stable
                                     ? ends_with(found)
                                     : "then, at " + number_text(found.unstable) + ", " +
                                           ends_with(found)));
}

}  // namespace

BothFrontiers find_both(const FrontierQuestion& question, Store& store, const CampaignOptions& how,
                        const Judge& unacceptable) {
  BothFrontiers found{.stable = find_frontier(question, store, how), .acceptable = {}};
  if (found.stable.frontier.kind == Frontier::Kind::not_answered) return found;
  found.acceptable =
      find_frontier(question, store, how, [&](const Case& one, const Record& record) {
        return completed(record.status) ? unacceptable(one, record) : describe(record.status);
      });
  return found;
}

Answer answer_of(const FrontierQuestion& question, const BothFrontiers& both,
                 const std::optional<Prediction>& theory) {
  const CaseFrontier& result = both.stable;
  const Case first = make_case(question.at(question.range.from));
  const Frontier& found = result.frontier;
  const Unit unit = unit_of(question);
  Answer answer{"frontier",
                first.scene->name + " " + question.base.solver + ": largest stable " + question.of};
  const auto end = [&](const char* name, const char* heading, double value) {
    const Probed* probe = found.at(value);
    std::string what = probe ? describe(probe->status) : "";
    if (probe && probe->stable() && probe->status.kind == Status::Kind::extreme)
      what += "; a large strain alone is no instability";
    answer.add({name, heading, unit, 7}, Cell(value).with(what));
  };
  answer.add(Column("of").in_detail(), question.of);
  answer.add(Column("kind").in_detail(), to_string(found.kind));
  if (found.kind == Frontier::Kind::all_stable)
    answer.add({"stable", "stable", unit, 7},
               Cell(found.stable).with("to the end of the range (--to); stable is not accurate"));
  else if (found.kind != Frontier::Kind::none_stable)
    end("stable", "stable up to", found.stable);
  if (found.kind != Frontier::Kind::all_stable) end("unstable", "unstable from", found.unstable);
  add_acceptable(answer, both.acceptable.frontier, unit);
  add_theory(answer, theory, found, unit);
  if (found.kind != Frontier::Kind::all_stable)
    answer.add({"above", "values above the bracket"},
               Cell(found.above)
                   .with(found.stable_above.empty() ? "none stable"
                                                    : "NOT MONOTONE: stable again at " +
                                                          join(found.stable_above, " ", shortest)));
  answer.add({"looked_for", "growth looked for over", kTime},
             Cell(first.scene->duration()).with("what grows more slowly counts as stable"));
  answer.add({"cases"}, found.probes.size());
  answer.add({"ran", "of which were run now"}, result.ran + both.acceptable.ran);
  Table probes{
      "probes", "what was run", {{"value", question.of, unit, 7}, {"status"}, {"step"}, {"case"}}};
  for (std::size_t i = 0; i < found.probes.size(); ++i) {
    const Probed& probe = found.probes[i];
    Cell id(result.records[i].id);
    id.key = result.records[i].key;
    probes.rows.push_back({probe.value, cell_of(probe.status.kind).with(probe.status.reason.text()),
                           probe.status.step >= 0 ? Cell(probe.status.step) : Cell(), id});
  }
  probes.detail = true;
  answer.add(std::move(probes));
  return answer;
}

Answer answer_of(const std::vector<std::pair<FrontierQuestion, BothFrontiers>>& found,
                 const std::string& acceptable) {
  const FrontierQuestion& first = found.front().first;
  const Unit unit = unit_of(first);
  Answer answer{"frontier", first.base.scene + ": largest " + first.of + " of each solver"};
  answer.add(Column("of").in_detail(), first.of);
  Table table{"frontiers",
              "acceptable: " + acceptable,
              {{"solver"},
               {"stable", "stable up to", unit, 4},
               {"stable_end", "then"},
               {"acceptable", "acceptable up to", unit, 4},
               {"acceptable_end", "then"}}};
  const auto value = [](const Frontier& frontier) {
    return frontier.kind == Frontier::Kind::bracketed || frontier.kind == Frontier::Kind::all_stable
               ? Cell(frontier.stable)
               : Cell("none");
  };
  for (const auto& [question, both] : found) {
    const Frontier &stable = both.stable.frontier, &accepted = both.acceptable.frontier;
    const std::string& solver = question.base.solver;
    if (stable.kind == Frontier::Kind::not_answered)
      table.rows.push_back({solver, Cell(), not_answered_because(both.stable), Cell(), ""});
    else
      table.rows.push_back(
          {solver, value(stable), ends_with(stable), value(accepted), ends_with(accepted)});
  }
  answer.add(std::move(table));
  return answer;
}

std::string not_answered_because(const CaseFrontier& result) {
  for (const Record& record : result.records)
    if (record.status.kind != Status::Kind::ok) return record.id + ": " + describe(record.status);
  return "";
}

}  // namespace taut
