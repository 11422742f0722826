#include <cmath>
#include <cstdio>

#include "core/io/scene_io.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/system/data.hpp"
#include "experiments/timing/convergence.hpp"

namespace taut::verb::convergence {

namespace {

struct Options {
  std::string scene, from = "jakobsen:iterations=50,substeps=1,precision=double";
  std::vector<std::string> solvers, settings;
  double at = 0.5;
  int most = 256;
  bool json = false;
};

constexpr double kGaps[] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6};

std::string number(double value, const char* format = "%.3g") {
  if (!std::isfinite(value)) return "-";
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

bool is_rigid(const Convergence& c) {
  return std::ranges::any_of(c.stiffness, [](double k) { return std::isinf(k); });
}

/// What the exact step is, and where the iterations end.
std::string explained(const Convergence& c) {
  std::string text = is_rigid(c)
                         ? "rigid links: the exact step is the nearest placement that keeps all "
                           "lengths (augmented Lagrangian)"
                         : "springs of " + number(c.stiffness[0]) + ", " + number(c.stiffness[1]) +
                               ", " + number(c.stiffness[2]) +
                               " N/m: the exact step is implicit Euler's (Newton)";
  if (!c.problem.empty()) return text + "; there is none here: " + c.problem;
  text += ", to " + number(c.exact_residual) + " N";
  if (c.floor > 0)
    text +=
        "; its iterations end on a floor of their own, " + number(1e3 * c.floor) + " mm from it";
  return text;
}

void print_text(const Convergence& c) {
  std::cout << '\n' << c.solver << '\n';
  if (!c.refused.empty()) {
    for (const std::string& reason : c.refused) std::cout << "  unsupported: " << reason << '\n';
    return;
  }
  std::cout << "  " << explained(c) << "\n\n";
  std::vector<Row> rows{
      {"iterations", "residual [N]", "RMS of C [mm]", "gap", "distance [mm]", "CPU time [ms]"}};
  for (const ConvergencePoint& p : c.points)
    rows.push_back({std::to_string(p.iterations), number(p.residual), number(1e3 * p.stretch),
                    number(p.gap), number(1e3 * p.distance), number(p.milliseconds)});
  print_columns(rows, 1);
  std::cout << "\n  contraction per iteration: " << number(c.contraction, "%.4f") << '\n';
}

void print_summary(const std::vector<Convergence>& all) {
  Row head{"iterations (CPU time [ms]) to a gap of"};
  for (const double gap : kGaps) head.push_back(number(gap));
  std::vector<Row> rows{head};
  for (const Convergence& c : all) {
    if (!c.refused.empty() || !c.problem.empty()) continue;
    Row row{c.solver};
    for (const double gap : kGaps) {
      const int i = reached(c, gap);
      const auto at = static_cast<std::size_t>(std::max(i, 0));
      row.push_back(i < 0 ? "-"
                          : std::to_string(c.points[at].iterations) + " (" +
                                number(c.points[at].milliseconds) + ")");
    }
    rows.push_back(std::move(row));
  }
  if (rows.size() == 1) return;
  std::cout << '\n';
  print_columns(rows, 1);
}

Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json to_json(const Convergence& c) {
  Json j{{"solver", c.solver}, {"unsupported", c.refused}};
  if (!c.refused.empty()) return j;
  for (const double k : c.stiffness) j["stiffness"].push_back(finite(k));
  j["rigid"] = is_rigid(c);
  j["no_exact_step"] = c.problem;
  j["exact_residual"] = finite(c.exact_residual);
  j["contraction"] = finite(c.contraction);
  j["floor"] = c.floor;
  for (const ConvergencePoint& p : c.points)
    j["points"].push_back({{"iterations", p.iterations},
                           {"residual", finite(p.residual)},
                           {"stretch_rms", finite(p.stretch)},
                           {"gap", finite(p.gap)},
                           {"distance_rms", finite(p.distance)},
                           {"cpu_ms", p.milliseconds}});
  return j;
}

/// Bullet in float and in double are two programs, and all solvers start from one state in one.
void continue_in_one_program(const std::vector<std::string>& solvers) {
  std::string_view program;
  for (const std::string& solver : solvers) {
    const SolverChoice choice = parse_solver(solver);
    if (!choice.entry->program) continue;
    const std::string_view needed = choice.entry->program(choice.params);
    if (needed.empty()) continue;
    if (!program.empty() && needed != program)
      throw InputError("converge: Bullet in float and in double are two programs; ask for one");
    program = needed;
  }
  for (const std::string& solver : solvers) continue_in_right_program(parse_solver(solver));
}

int run(const Options& options) {
  check_solvers(options.solvers);
  const Scene scene = load_scene(find_scene(options.scene), options.settings);
  if (!scene.colliders.empty() || scene.self_collision)
    throw InputError("converge: contact is no part of the exact step; take a scene without");
  continue_in_one_program(options.solvers);
  const double at = std::round(options.at / scene.dt) * scene.dt;
  const State state = state_at(scene, parse_solver(options.from), at);
  std::vector<Convergence> all;
  for (const std::string& solver : options.solvers)
    all.push_back(converge(scene, state, at, solver, options.most));
  if (options.json) {
    Json solvers = Json::array();
    for (const Convergence& c : all) solvers.push_back(to_json(c));
    print_json(Json{{"scene", scene.name},
                    {"at", at},
                    {"dt", scene.dt},
                    {"from", options.from},
                    {"solvers", solvers}},
               2);
  } else {
    std::cout << "One step of " << scene.name << " (" << number(scene.dt) << " s) at " << number(at)
              << " s of " << options.from
              << ", 1, 2, ... iterations of each, anew from that state:\n"
              << "multipliers and velocities of earlier steps are unknown to all.\n"
              << "gap: (G - G*)/(G_0 - G*) of springs; of rigid links the square of the distance "
                 "over that\nof the prediction, weighted by mass.\n";
    for (const Convergence& c : all) print_text(c);
    print_summary(all);
  }
  return std::ranges::any_of(all, [](const Convergence& c) { return c.refused.empty(); })
             ? kPass
             : kNothing;
}

void add_options(CLI::App& app, Options& o) {
  app.add_option("SCENE", o.scene, "Name of a shipped scene, or a scene file")->required();
  app.add_option("--solver", o.solvers, "Solver, once for each; its iterations are set")
      ->required()
      ->allow_extra_args(false);
  app.add_option("--at", o.at, "Time of the state [s]; 0: the scene's start")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--from", o.from, "Solver whose run gives the state");
  app.add_option("--most", o.most, "Iterations, at most")->check(CLI::Range(1, 1 << 20));
  add_settings(app, o.settings);
  add_json(app, o.json, "All points");
}

}  // namespace
}  // namespace taut::verb::convergence

TAUT_VERB(converge) = {
    .name = "converge",
    .group = VerbGroup::cost,
    .summary = "Error over iterations inside one step, against the exact step",
    .example = "taut converge chain --solver jakobsen --solver admm --at 0.5",
    .bind = taut::bind_verb<taut::verb::convergence::add_options, taut::verb::convergence::run>};
