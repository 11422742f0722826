#include "experiments/require/requirement_answer.hpp"

#include <cmath>

#include "core/model/text.hpp"
#include "experiments/system/process.hpp"

namespace taut {

namespace {

/// Share of the full model's time that an effect costs; empty if it was not timed.
Cell time_of(const Requirement& found, const std::optional<Interval>& ratio) {
  if (!ratio) return {};
  const bool none = ratio->contains(1) || std::abs(1 - ratio->mid) <= spread(found.control);
  return none ? Cell("none seen") : Cell(1 - ratio->mid);
}

std::string verdict(const EffectTrial& effect) {
  if (!effect.done()) return "not done";
  if (effect.chosen) return "drop";
  if (effect.may_go()) return "keep: may go, but not with the others";
  return effect.representative().why.empty() ? "keep" : "keep: " + effect.representative().why;
}

Column column_of(const KeptQuantity& answer) { return {answer.name, "", unit_of(answer)}; }

/// A table of the kept answers and by how much they may move.
Table answers_of(const Requirement& found) {
  Table table{"answers",
              "answers that are kept",
              {{"name", "answer"},
               {"shown", "shown in"},
               {"value", "full model"},
               {"tolerance", "may move by"},
               {"noise", "moves by rounding"},
               {"order", "by order of links"},
               Column("unit").in_detail()}};
  for (std::size_t i = 0; i < found.answers.size(); ++i) {
    const KeptQuantity& answer = found.answers[i];
    const Unit unit = unit_of(answer);
    const auto said = [&](double value, const std::string& remark = "") {
      std::string note = unit.shown.empty() ? "" : text(answer, value);
      if (!note.empty() && !remark.empty()) note += ", ";
      return Cell(value).with(note + remark);
    };
    const bool vacuous = !answer.is_shape() && answer.tolerance > std::abs(found.values[i]);
    const bool noisy = i < found.noise.size() && found.noise[i] > answer.tolerance;
    table.rows.push_back(
        {answer.name, unit.shown.empty() ? "1" : unit.shown,
         answer.is_shape() ? Cell() : said(found.values[i]),
         said(answer.tolerance, vacuous ? "LARGER THAN THE VALUE: SAYS NOTHING" : ""),
         i < found.noise.size() ? said(found.noise[i], noisy ? "MORE THAN THE TOLERANCE" : "")
                                : Cell(),
         i < found.by_order.size() ? said(found.by_order[i]) : Cell(), unit.si});
  }
  return table;
}

/// A table of the effects: how far the answers move without each of them, and what it costs.
Table effects_of(const Requirement& found, std::size_t bytes) {
  Table table{"effects", "by how much the answers move without", {{"name", "effect"}, {"change"}}};
  for (const KeptQuantity& answer : found.answers) table.columns.push_back(column_of(answer));
  table.columns.insert(table.columns.end(), {{"time", "its time", kShare, 2},
                                             {"bytes", "its memory", kKilobytes},
                                             {"verdict"},
                                             Column("may_go").in_detail()});
  const auto add = [&](const std::string& name, const ModelTrial& trial,
                       const std::optional<Interval>& time, const std::string& verdict,
                       bool may_go) {
    auto& row = table.rows.emplace_back();
    row = {name, trial.change};
    for (std::size_t i = 0; i < found.answers.size(); ++i)
      row.push_back(i < trial.moved.size() ? Cell(trial.moved[i]) : Cell());
    const double less = static_cast<double>(bytes) - static_cast<double>(bytes_of(trial.cost));
    row.insert(row.end(),
               {time_of(found, time), trial.cost.empty() ? Cell() : Cell(less), verdict, may_go});
  };
  for (const EffectTrial& effect : found.effects)
    add(effect.name, effect.representative(), effect.time, verdict(effect), effect.may_go());
  if (found.smallest)
    add("(smallest model)", *found.smallest, found.time_ratio,
        found.verified ? "verified: the same bits from its file" : "NOT VERIFIED", true);
  return table;
}

/// A table of everything that was tried.
Table trials_of(const Requirement& found) {
  Table table{"trials",
              "all that was tried",
              {{"effect"},
               {"change"},
               {"done"},
               {"within"},
               {"why"},
               {"bytes", "bytes of a step", kBytes},
               {"work_per_step"},
               {"steps"},
               {"scene"},
               {"solver"}}};
  for (const KeptQuantity& answer : found.answers) table.columns.push_back(column_of(answer));
  for (const EffectTrial& effect : found.effects)
    for (const ModelTrial& trial : effect.trials) {
      auto& row = table.rows.emplace_back();
      row = {effect.name,      trial.change,         trial.done,          trial.within,
             trial.why,        bytes_of(trial.cost), work_of(trial.cost), trial.steps,
             trial.spec.scene, trial.spec.solver};
      for (std::size_t i = 0; i < found.answers.size(); ++i)
        row.push_back(i < trial.moved.size() ? Cell(trial.moved[i]) : Cell());
    }
  table.detail = true;
  return table;
}

std::string command_of(const CaseSpec& spec) {
  return "taut case " + shell_word(spec.scene) + " " +
         shell_word(parse_solver(spec.solver).brief());
}

Table list(const char* name, const char* title, const std::vector<std::string>& lines) {
  Table table{name, title, {{"what"}}};
  for (const std::string& line : lines) table.rows.push_back({line});
  return table;
}

}  // namespace

RequirementSummary summary_of(const Requirement& found) {
  std::string drop, keep;
  for (const EffectTrial& effect : found.effects) {
    std::string& list = effect.chosen ? drop : keep;
    list += (list.empty() ? "" : ", ") + effect.name;
    const ModelTrial& told =
        effect.chosen ? effect.trials[*effect.chosen] : effect.representative();
    if (effect.chosen && !told.removes) list += " " + told.change;
  }
  for (const std::string& what : found.not_done)
    drop += (drop.empty() ? "not done: " : "; not done: ") + what;
  RequirementSummary summary;
  summary.scene = found.full.scene->name;
  summary.solver = found.full.choice.brief();
  summary.chaotic = found.chaotic ? "after " + number_text(found.horizon, kTime, 2) : "no";
  summary.kept = join(found.answers, ", ", &KeptQuantity::name);
  if (!drop.empty()) summary.can_go = drop;
  if (!found.effects.empty()) summary.required = keep.empty() ? "nothing" : keep;
  if (found.time_ratio) summary.time_left = found.time_ratio->mid;
  return summary;
}

RequirementTable::RequirementTable()
    : table_{"scenes",
             "",
             {{"scene"},
              {"chaotic"},
              {"kept"},
              {"can_go", "can go"},
              {"required"},
              {"time_left", "CPU time left", kShare, 2}}} {}

void RequirementTable::add(const Requirement& found) {
  const RequirementSummary summary = summary_of(found);
  table_.rows.push_back({summary.scene, summary.chaotic, summary.kept, summary.can_go,
                         summary.required, found.time_ratio});
}

void RequirementTable::add_refused(const std::string& scene, const std::string& reason) {
  table_.rows.push_back({scene, {}, {}, {}, reason, {}});
}

Answer answer_of(const Requirement& found, const Store& store, const std::string& picture,
                 double seconds, double patience) {
  const auto full = store.find(found.full);
  const std::size_t bytes = full ? bytes_of(full->step_cost) : 0;
  Answer answer{"require", found.full.id};
  const RequirementSummary summary = summary_of(found);
  answer.add(Column("key").in_detail(), found.full.key);
  answer.add(Column("scene").in_detail(), found.full.scene->name);
  answer.add(Column("solver").in_detail(), found.full.choice.brief());
  answer.add({"can_go", "can go"}, summary.can_go);
  answer.add({"required"}, summary.required);
  answer.add(Column("kept").in_detail(), summary.kept);
  answer.add({"chaotic"},
             Cell(summary.chaotic)
                 .with(found.chaotic ? "a rounding error at the start moves the shape beyond its "
                                       "tolerance; only statistics are kept"
                                     : ""));
  answer.add(Column("horizon", "", kTime).in_detail(),
             found.chaotic ? Cell(found.horizon) : Cell());
  answer.add({"bytes", "memory of a step", kKilobytes}, bytes);
  if (found.smallest) {
    answer.add(Column("smallest", "smallest model").of_commands(),
               command_of(found.smallest->spec));
    answer.add({"file", "its scene"}, found.file.string());
    answer.add({"verified", "run again from its file, the same bits"}, found.verified);
    answer.add({"time_left", "its CPU time", kShare}, found.time_ratio);
    answer.add({"control", "the full model against itself"}, found.control);
  }
  if (!picture.empty()) answer.add({"picture"}, picture);
  answer.add({"cases", "cases looked at"}, found.cases);
  answer.add({"ran", "of which were run now"}, found.ran);
  answer.add({"seconds", "time", kTime}, seconds);
  answer.add({"patience", "of", kTime}, patience);
  answer.add({"complete"}, found.not_done.empty() && !found.interrupted);
  answer.add(answers_of(found));
  answer.add(effects_of(found, bytes));
  answer.add(list("not_kept", "not kept", found.given_up));
  answer.add(list("not_done", "NOT DONE: stopped by --patience; the same command goes on",
                  found.not_done));
  answer.add(trials_of(found));
  return answer;
}

RequirementSummary requirement_in(const Answer& answer) {
  const auto text = [&](const char* fact) { return answer.fact(fact).text(); };
  RequirementSummary summary;
  summary.scene = text("scene");
  summary.solver = text("solver");
  summary.chaotic = text("chaotic");
  summary.kept = text("kept");
  summary.can_go = text("can_go");
  summary.required = text("required");
  summary.time_left = answer.fact("time_left").number();
  return summary;
}

}  // namespace taut
