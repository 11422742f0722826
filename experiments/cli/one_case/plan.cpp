#include "experiments/command_line/verb.hpp"

namespace taut::verb::planning {

namespace {

struct Options {
  CaseOptions which;
  Format format;
};

Answer answer_of(const Case& one, const std::vector<PassCost>& step_cost) {
  Answer answer{"plan", one.id};
  Table table{"passes",
              "",
              {{"pass"}, {"items"}, {"repeats"}, {"bytes", "bytes", kBytes}, {"projections"}}};
  std::size_t bytes = 0, projections = 0;
  for (const PassCost& cost : step_cost) {
    const std::size_t work = cost.projections ? cost.items * cost.repeats : 0;
    bytes += cost.bytes, projections += work;
    table.rows.push_back({cost.pass, cost.items, cost.repeats, cost.bytes, work});
  }
  answer.add({"key"}, Cell(one.key));
  answer.add({"bytes", "bytes of a step", kBytes}, bytes);
  answer.add({"projections", "projections per step"}, projections);
  answer.add(std::move(table));
  return answer;
}

int run(const Options& options) {
  const Case one = options.which.make();
  continue_in_right_program(one.choice);
  if (const auto reasons = one.choice.entry->unsupported(*one.scene, one.choice.params);
      !reasons.empty()) {
    Answer answer{"plan", one.id};
    answer.add({"key"}, one.key);
    Table& table = answer.add(Table{"unsupported", "unsupported:", {{"why"}}});
    for (const std::string& reason : reasons) {
      table.rows.push_back({reason});
      std::cerr << one.id << " is unsupported: " << reason << '\n';
    }
    if (options.format.is_data()) print(answer, options.format);
    return kNothing;
  }
  const std::unique_ptr<Solver> solver = one.choice.entry->make(*one.scene, one.choice.params);
  solver->load(one.scene->start);
  print(answer_of(one, solver->step_cost()), options.format);
  return kPass;
}

void add_options(CLI::App& app, Options& o) {
  o.which.bind(app);
  add_format(app, o.format);
}

}  // namespace
}  // namespace taut::verb::planning

TAUT_VERB(plan) = {
    .name = "plan",
    .group = VerbGroup::one_case,
    .summary = "Shows the passes of one step, what they visit and what they hold in memory",
    .example = "taut plan ball jakobsen:iterations=1,substeps=15",
    .bind = taut::bind_verb<taut::verb::planning::add_options, taut::verb::planning::run>};
