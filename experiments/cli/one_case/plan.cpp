#include "experiments/case/record_io.hpp"
#include "experiments/command_line/verb.hpp"

namespace taut::verb::planning {

namespace {

struct Options {
  CaseOptions which;
  bool json = false;
};

void print_text(const Case& one, const std::vector<PassCost>& step_cost) {
  std::vector<Row> rows{{"pass", "items", "repeats", "bytes", "projections"}};
  std::size_t bytes = 0, projections = 0;
  for (const PassCost& cost : step_cost) {
    const std::size_t work = cost.projections ? cost.items * cost.repeats : 0;
    bytes += cost.bytes, projections += work;
    rows.push_back({cost.pass, std::to_string(cost.items), std::to_string(cost.repeats),
                    std::to_string(cost.bytes), std::to_string(work)});
  }
  rows.push_back({"in one step", "", "", std::to_string(bytes), std::to_string(projections)});
  std::cout << one.id << "\nkey " << one.key << "\n\n";
  print_columns(rows, 1);
}

int run(const Options& options) {
  const Case one = options.which.make();
  continue_in_right_program(one.choice);
  if (const auto reasons = one.choice.entry->unsupported(*one.scene, one.choice.params);
      !reasons.empty()) {
    std::cerr << one.id << " is unsupported:\n";
    for (const std::string& reason : reasons) std::cerr << "  " << reason << '\n';
    return kNothing;
  }
  const std::unique_ptr<Solver> solver = one.choice.entry->make(*one.scene, one.choice.params);
  solver->load(one.scene->start);
  if (options.json)
    print_json(Json{{"id", one.id}, {"key", one.key}, {"passes", solver->step_cost()}}, 2);
  else
    print_text(one, solver->step_cost());
  return kPass;
}

void add_options(CLI::App& app, Options& o) {
  o.which.bind(app);
  add_json(app, o.json, "The passes");
}

}  // namespace
}  // namespace taut::verb::planning

TAUT_VERB(plan) = {
    .name = "plan",
    .group = VerbGroup::one_case,
    .summary = "Shows the passes of one step, what they visit and what they hold in memory",
    .example = "taut plan ball jakobsen:iterations=1,substeps=15",
    .bind = taut::bind_verb<taut::verb::planning::add_options, taut::verb::planning::run>};
