// Writes the findings of `taut converge` to an answer, and reads them back.
#include "experiments/steps/one_step.hpp"

#include <algorithm>
#include <cmath>

#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/case/run_case.hpp"
#include "experiments/system/data.hpp"

namespace taut {

namespace {

constexpr std::string_view kStep = "step.";
constexpr const char* kDistance = "step.distance";

constexpr double kGaps[] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6};
constexpr Unit kForce{Unit::Kind::other, "N", "N"}, kStiffness{Unit::Kind::other, "N/m", "N/m"};

/// Text that says what the exact step is, or why there is no such step.
std::string exact_step(const Convergence& c) {
  const std::string step =
      std::ranges::any_of(c.stiffness, [](double k) { return std::isinf(k); })
          ? "the nearest placement that keeps all lengths (augmented Lagrangian)"
          : "implicit Euler's (Newton)";
  return c.problem.empty() ? step : "none: " + c.problem;
}

/// A table with a row for each solver that can be asked: its links, and how its iterations end.
Table summary(const std::vector<Convergence>& all) {
  Table table{"solvers",
              "",
              {{"solver"},
               {"structural", "structural", kStiffness},
               {"shear", "shear", kStiffness},
               {"bend", "bend", kStiffness},
               {"contraction", "contraction per iteration", kNumber, 4},
               {"floor", "floor", kLength},
               {"moved", "last correction of the exact step", kLength},
               {"exact_residual", "residual of the exact step", kForce},
               {"exact", "exact step"}}};
  table.caption =
      "Stiffness of rigid links is empty. A floor is a distance from the exact step at which the "
      "iterations end: their fixed point is another one.";
  for (const Convergence& c : all)
    if (c.refused.empty())
      table.rows.push_back({c.solver, c.stiffness[0], c.stiffness[1], c.stiffness[2], c.contraction,
                            c.floor > 0 ? Cell(c.floor) : Cell(), c.moved, c.exact_residual,
                            exact_step(c)});
  return table;
}

/// A table of the iterations after which the gap stays at or below each of kGaps, with the CPU time
/// of a step with that many.
Table iterations_to_gaps(const std::vector<Convergence>& all) {
  Table table{"reached",
              "iterations until the gap stays below a value",
              {{"solver"}, {"below"}, {"iterations"}, {"cpu", "CPU time", kMilliseconds}}};
  for (const Convergence& c : all)
    for (const double gap : kGaps)
      if (const int i = reached(c, gap); c.refused.empty() && c.problem.empty() && i >= 0) {
        const ConvergencePoint& p = c.points[static_cast<std::size_t>(i)];
        table.rows.push_back({c.solver, gap, p.iterations, p.milliseconds / 1e3});
      }
  return table;
}

Table points(const std::vector<Convergence>& all) {
  Table table{"points",
              "",
              {{"solver"},
               {"iterations"},
               {"residual", "residual", kForce},
               {"stretch", "RMS of C", kLength},
               {"gap"},
               {"distance", "distance from the exact step", kLength},
               {"cpu", "CPU time", kMilliseconds}}};
  table.caption =
      "gap: (G - G*)/(G_0 - G*) of springs; of rigid links the square of the distance over that of "
      "the prediction, weighted by mass. Sweeps that lower the energy lower the gap, not always "
      "the distance: they take out stretch first, and may move the cloth away along its bends.";
  for (const Convergence& c : all)
    for (const ConvergencePoint& p : c.points)
      table.rows.push_back(
          {c.solver, p.iterations, p.residual, p.stretch, p.gap, p.distance, p.milliseconds / 1e3});
  return table;
}

std::string with_settings(const std::string& scene, const std::string& settings) {
  return settings.empty() ? scene : scene + ", " + settings;
}

Record record_of(const std::string& scene, double dt, const Table& points,
                 const std::vector<Cell>& row) {
  const auto number = [&](const char* column) { return points.at(row, column).number(); };
  Record r;
  const std::string solver = points.at(row, "solver").text();
  const SolverChoice choice = parse_solver(solver);
  r.scene = scene;
  r.dt = dt;
  r.spec = {r.scene, {}, solver};
  describe_solver(r, choice);
  r.substeps = 1;
  r.sweeps = static_cast<int>(number("iterations"));
  for (const std::string& kind : step_kinds()) r.values[step_value(kind)] = number(kind.c_str());
  r.id = r.scene + " " + solver + " " + shortest(number("iterations"));
  return r;
}

}  // namespace

Answer one_step(const StepQuestion& question) {
  const Scene scene = load_scene(find_scene(question.scene), question.settings);
  if (scene.self_collision)
    throw InputError(
        "converge: self-collision is not part of the exact step; take a scene without");
  const double at = std::round(question.at / scene.dt) * scene.dt;
  const State state = state_at(scene, parse_solver(question.from), at);
  return one_step_answer(
      {scene.name, join(question.settings, ", ", &SceneSetting::text), question.from, at, scene.dt},
      converge(scene, state, at, question.solvers, question.most));
}

Answer one_step_answer(const StepState& state, const std::vector<Convergence>& all) {
  Answer answer{"converge", "one step of " + with_settings(state.scene, state.settings)};
  answer.add({"scene"}, state.scene);
  answer.add(Column("settings", "settings of the scene").in_detail(), state.settings);
  answer.add({"at", "from its state at", kTime}, state.at);
  answer.add(
      {"from", "of a run of"},
      Cell(state.from).with("multipliers and velocities of earlier steps are unknown to all"));
  answer.add({"dt", "time step", kMilliseconds}, state.dt);
  answer.add(points(all));
  answer.add(summary(all));
  answer.add(iterations_to_gaps(all));
  Table unsupported{"unsupported", "unsupported", {{"solver"}, {"why"}}};
  for (const Convergence& c : all)
    for (const std::string& reason : c.refused) unsupported.rows.push_back({c.solver, reason});
  answer.add(std::move(unsupported));
  return answer;
}

OneStep::OneStep(const Answer& found)
    : subject(found.subject),
      scene(found.fact("scene").text()),
      settings(found.fact("settings").text()) {
  const Table &points = found.table("points"), &ends = found.table("solvers"),
              &reached = found.table("reached");
  for (const auto& row : points.rows)
    records.push_back(record_of(scene, found.fact("dt").number(), points, row));
  for (const auto& end : ends.rows) {
    const auto number = [&](const char* column) { return ends.at(end, column).number(); };
    StepSolver& one =
        solvers.emplace_back(StepSolver{ends.at(end, "solver").text(), number("structural"),
                                        number("contraction"), number("floor"), number("moved")});
    for (const Record& r : records)
      if (r.spec.solver == one.text) one.distances.emplace(r.sweeps, r.value(kDistance));
    for (const auto& row : reached.rows)
      if (reached.at(row, "solver").text() == one.text)
        one.iterations.emplace(reached.at(row, "below").number(),
                               static_cast<int>(reached.at(row, "iterations").number()));
  }
}

std::string OneStep::titled_scene() const { return with_settings(scene, settings); }

std::vector<std::string> step_kinds() { return {"distance", "gap", "stretch", "residual"}; }

std::string step_value(std::string_view kind) {
  const std::vector<std::string> known = step_kinds();
  if (std::ranges::find(known, kind) == known.end())
    throw InputError("unknown kind '" + std::string(kind) + "'" +
                     suggestion(std::string(kind), known));
  return std::string(kStep) + std::string(kind);
}

}  // namespace taut
