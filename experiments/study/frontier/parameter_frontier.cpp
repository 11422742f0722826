#include "experiments/study/frontier/parameter_frontier.hpp"

#include <algorithm>
#include <utility>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/case/trajectory.hpp"

namespace taut {

namespace {

/// Whether the case ran to its end.
bool ran(const Record& record) {
  const Status::Kind kind = record.status.kind;
  return kind == Status::Kind::ok || kind == Status::Kind::unsettled ||
         kind == Status::Kind::extreme;
}

JudgedRun judged_run(const Case& one, const Record& record, const Store& store) {
  JudgedRun seen{one, record, {}};
  if (!ran(record) || !store.has_frames(one.key)) return seen;
  seen.end = store.motion(one.key).frames.back().state.x;
  return seen;
}

void tell_theory(const FrontierSetting& setting, ParameterFrontier& found) {
  if (!setting.theory) return;
  found.law = setting.theory->law;
  const double end = setting.theory->value;
  if (setting.theory->kind == Frontier::Kind::bracketed && end < setting.question.range.to)
    found.theory = setting.question.setting(end);
}

void fill(const Frontier& frontier, const FrontierQuestion& question, ParameterFrontier& found) {
  using Kind = Frontier::Kind;
  if (frontier.kind == Kind::not_answered) {
    found.lacks = "not answered: no time or memory, or interrupted";
    return;
  }
  if (frontier.kind != Kind::none_stable) found.good = question.setting(frontier.stable);
  if (frontier.kind == Kind::all_stable) return;
  found.bad = question.setting(frontier.unstable);
  found.symptom = frontier.at(frontier.unstable)->symptom;
  found.beyond = question.at(frontier.unstable);
}

/// Searches along one parameter; returns nothing if interrupted.
std::optional<ParameterFrontier> search(const FrontierSetting& setting, const std::string& solver,
                                        Store& store, const CampaignOptions& options) {
  ParameterFrontier found;
  found.solver = solver;
  found.parameter = setting.name;
  found.unit = setting.unit;
  found.lacks = setting.lacks;
  if (!found.lacks.empty()) return found;
  const FrontierQuestion& question = setting.question;
  found.downwards = question.direction != Direction::up;
  found.from = question.setting(question.range.from);
  found.to = question.setting(question.range.to);
  const Case first = make_case(question.at(question.range.from));
  const std::optional<Record> record = run_and_read({first}, store, options).records.front();
  if (!record) return {};
  if (!ran(*record)) {
    found.lacks = record->status.reason.empty() ? std::string(to_string(record->status.kind))
                                                : record->status.reason.text();
    return found;
  }
  const JudgedRun start = judged_run(first, *record, store);
  const std::vector<std::string> known = symptoms(start, nullptr);
  found.at_start = join(known, ", ");
  tell_theory(setting, found);
  const Judge judge = [&](const Case& one, const Record& r) {
    std::vector<std::string> wrong = symptoms(judged_run(one, r, store), &start);
    std::erase_if(wrong, [&](const std::string& name) { return std::ranges::count(known, name); });
    return join(wrong, ", ");
  };
  const CaseFrontier result = find_frontier(question, store, options, judge);
  found.cases = result.frontier.probes.size();
  found.ran = result.ran;
  fill(result.frontier, question, found);
  if (result.interrupted) return {};
  return found;
}

}  // namespace

std::optional<std::vector<ParameterFrontier>> find_frontiers(
    const std::string& solver, Store& store, const CampaignOptions& options,
    const std::function<void(std::size_t done, std::size_t all)>& progress) {
  std::vector<ParameterFrontier> frontiers;
  const std::vector<FrontierSetting> settings = frontier_settings(solver);
  const std::string name = parse_solver(solver).brief();
  for (const FrontierSetting& setting : settings) {
    const auto found = search(setting, name, store, options);
    if (!found) return {};
    frontiers.push_back(*found);
    progress(frontiers.size(), settings.size());
  }
  return frontiers;
}

Answer answer_of(const std::vector<ParameterFrontier>& frontiers) {
  Table table{"parameters",
              "how far every parameter goes, and what goes wrong first",
              {{"solver"},
               {"parameter"},
               {"unit"},
               {"good", "good up to"},
               {"bad", "bad from"},
               {"symptom", "what goes wrong"},
               {"at_start", "wrong at the start already, not counted"},
               {"theory"},
               Column("law").in_detail(),
               {"lacks", "no answer"},
               Column("from").in_detail(),
               Column("to").in_detail(),
               Column("downwards", "smaller is harder").in_detail(),
               Column("cases").in_detail(),
               Column("beyond_scene").in_detail(),
               Column("beyond_solver").in_detail()}},
      beyond{"beyond", "the cases beyond", {{"solver"}, {"parameter"}, {"scene_setting", "--set"}}};
  for (const ParameterFrontier& one : frontiers) {
    table.rows.push_back({one.solver, one.parameter, one.unit, one.good, one.bad, one.symptom,
                          one.at_start, one.theory, one.law, one.lacks, one.from, one.to,
                          one.downwards, one.cases, one.beyond.scene, one.beyond.solver});
    for (const SceneSetting& setting : one.beyond.settings)
      beyond.rows.push_back({one.solver, one.parameter, setting.text()});
  }
  beyond.detail = true;
  Answer answer{"frontier"};
  answer.add(std::move(table));
  answer.add(std::move(beyond));
  return answer;
}

std::vector<ParameterFrontier> frontiers_of(const Answer& answer) {
  std::vector<ParameterFrontier> all;
  const Table &table = answer.table("parameters"), &beyond = answer.table("beyond");
  const bool earlier = std::ranges::count(beyond.columns, "override", &Column::name) > 0;
  const char* const set = earlier ? "override" : "scene_setting";
  for (const auto& row : table.rows) {
    const auto text = [&](const char* column) { return table.at(row, column).text(); };
    const auto number = [&](const char* column) { return table.at(row, column).number(); };
    ParameterFrontier one{.solver = text("solver"),
                          .parameter = text("parameter"),
                          .unit = text("unit"),
                          .lacks = text("lacks"),
                          .downwards = table.at(row, "downwards").is_true(),
                          .from = number("from"),
                          .to = number("to"),
                          .good = number("good"),
                          .bad = number("bad"),
                          .symptom = text("symptom"),
                          .at_start = text("at_start"),
                          .theory = number("theory"),
                          .law = text("law"),
                          .beyond = {text("beyond_scene"), {}, text("beyond_solver")}};
    if (std::isnan(one.from) || std::isnan(one.to))
      throw InputError("this is not an answer of taut frontier --all: no range of " +
                       one.parameter);
    for (const auto& own : beyond.rows)
      if (beyond.at(own, "solver").text() == one.solver &&
          beyond.at(own, "parameter").text() == one.parameter)
        one.beyond.settings.emplace_back(beyond.at(own, set).text());
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace taut
