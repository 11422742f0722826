// Iterations of one step, as a report draws and lists the rows that `taut converge` left.
#include "experiments/report/chart/one_step.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/model/input_error.hpp"
#include "experiments/report/input.hpp"
#include "experiments/report/report.hpp"
#include "experiments/system/json.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut::report::one_step_test {
namespace {

/// Answer for springs that come within 1e-5 m of the exact step, in two orders, and for rigid links
/// with a floor.
Answer found() {
  Answer answer{"converge", "one step of hang, cloth.span=0.7"};
  answer.add({"scene"}, "hang");
  answer.add({"settings"}, "cloth.span=0.7");
  answer.add({"dt"}, 0.01);
  Table& solvers = answer.add(Table{
      "solvers", "", {{"solver"}, {"structural"}, {"contraction"}, {"floor"}, {"moved"}}, {}});
  solvers.rows = {{"vbd:structural=800", 800, 0.9, {}, 1e-15},
                  {"vbd:order=mesh,structural=800", 800, 0.8, {}, 3e-15},
                  {"jakobsen", {}, 0.5, 0.002, 2e-15}};
  Table& points = answer.add(
      Table{"points",
            "",
            {{"solver"}, {"iterations"}, {"distance"}, {"gap"}, {"stretch"}, {"residual"}},
            {}});
  points.rows = {{"vbd:structural=800", 1, 0.1, 0.5, 0.01, 7},
                 {"vbd:structural=800", 16, 1e-5, 1e-8, 0.001, 0},
                 {"vbd:order=mesh,structural=800", 1, 0.2, 0.6, 0.02, 8},
                 {"jakobsen", 1, 0.05, 0.3, 0, {}},
                 {"jakobsen", 16, 0.002, 0.003, 0, {}},
                 {"jakobsen", 17, 0.003, 0.003, 0, {}}};
  Table& reached = answer.add(Table{"reached", "", {{"solver"}, {"below"}, {"iterations"}}, {}});
  reached.rows = {{"vbd:structural=800", 1e-1, 3},
                  {"vbd:structural=800", 1e-2, 5},
                  {"vbd:structural=800", 1e-4, 9},
                  {"jakobsen", 1e-1, 2}};
  return answer;
}

TEST(OneStep, ItsPointsAreCasesWithTheirIterationsAndValues) {
  const OneStep step(found());
  EXPECT_EQ(step.titled_scene(), "hang, cloth.span=0.7");
  ASSERT_EQ(step.records.size(), 6u);
  const Record& r = step.records[1];
  EXPECT_EQ(r.scene + " " + r.solver + " " + r.spec.solver, "hang vbd vbd:structural=800");
  EXPECT_EQ(r.dt, 0.01);
  EXPECT_EQ(r.params.at("structural"), "800");
  EXPECT_EQ(work_of(r), (Work{1, 16}));
  for (const auto& [kind, value] : {std::pair{"distance", 1e-5}, {"gap", 1e-8}, {"stretch", 1e-3}})
    EXPECT_EQ(r.value(step_value(kind)), value) << kind;
  EXPECT_EQ(solver_label(step, "jakobsen"), "Jakobsen") << "alone of its name";
  EXPECT_EQ(solver_label(step, "vbd:structural=800"), solver_title("vbd") + " (structural=800)");
  EXPECT_EQ(solver_label(step, "vbd"), solver_title("vbd")) << "nothing is set";
  Answer other = found();
  other.facts[1].cell = Cell("");
  EXPECT_EQ(OneStep(other).titled_scene(), "hang");
  EXPECT_THROW(step_value("distanse"), InputError);
}

// A logarithmic axis has no place for zeros and unmeasured values.
TEST(OneStep, AChartHasPositiveValuesAndWhereSolversEnd) {
  const OneStep step(found());
  const auto drawn = [&](const char* kind) { return step_records(step, kind).size(); };
  EXPECT_EQ(drawn("distance"), 6u);
  EXPECT_EQ(drawn("stretch"), 3u);
  EXPECT_EQ(drawn("residual"), 2u);
  const Chart distance = step_chart(step, "distance"), gap = step_chart(step, "gap");
  EXPECT_EQ(distance.scene + " | " + distance.title, "hang | One step of hang, cloth.span=0.7");
  EXPECT_EQ(
      distance.caption,
      "These end on a floor, because their fixed point is another one: Jakobsen 2.0\u00A0mm.");
  ASSERT_TRUE(distance.floor);
  EXPECT_EQ(distance.floor->y, 3e-15) << "the largest of all";
  EXPECT_FALSE(gap.floor) << "it is a distance";
  EXPECT_NE(distance.id, gap.id);
  Answer none = found();
  for (auto& row : none.tables[1].rows) row[3] = Cell();
  EXPECT_THROW(step_chart(OneStep(none), "gap"), InputError);
}

TEST(OneStep, TheTableHasForEverySolverHowFarItComes) {
  ReportInput input{
      .studies = {{"one", "?", {synthetic::record("hang", "jakobsen", 4, 0.01)}, 1, {}}}};
  input.steps = {OneStep(found())};
  const Json model = parse_json(make_model(input));
  const Json& rows = model["tables"]["steps"]["rows"];
  const std::string scene = "hang, cloth.span=0.7", vbd = solver_title("vbd");
  EXPECT_EQ(rows, (Json{{scene, vbd + " (structural=800)", "800\u00A0N/m", 0.1, 1e-5, 0.9, nullptr,
                         3.0, 5.0, 9.0},
                        {scene, vbd + " (order=mesh,structural=800)", "800\u00A0N/m", 0.2, nullptr,
                         0.8, nullptr, "not reached", "not reached", "not reached"},
                        {scene, "Jakobsen", "rigid", 0.05, 0.002, 0.5, 0.002, 2.0, "not reached",
                         "not reached"}}));
}

}  // namespace
}  // namespace taut::report::one_step_test
