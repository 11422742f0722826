#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/report/chart/one_step.hpp"
#include "experiments/report/plot/plot.hpp"
#include "experiments/results/store.hpp"

namespace taut::verb::convergence {

namespace {

struct Options : StepQuestion {
  std::string kind = "distance", figures, out;
  bool record = false;
  Format format;
};

/// Continues in the program that all solvers need, since all start from one state in one process.
/// Bullet in float and in double are two programs.
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

std::string draw(const Answer& answer, const Options& options) {
  const OneStep step(answer);
  const report::PlotSpec spec{.kind = "convergence",
                              .x = report::kSweeps,
                              .y = step_value(options.kind),
                              .title = answer.subject,
                              .file = slug("converge-" + step.titled_scene() + "-" + options.kind)};
  return report::make_plot(spec, {{"", report::step_records(step, options.kind)}}, options.figures)
      .svg.string();
}

int run(const Options& options) {
  continue_in_one_program(options.solvers);
  check_solvers(options.solvers);
  Answer answer = one_step(options);
  const bool any = !answer.table("solvers").rows.empty();
  if (options.record) {
    Store store(options.out);
    store.prepare();
    store.keep(answer);
  }
  if (!options.figures.empty()) answer.add({"picture"}, draw(answer, options));
  print(answer, options.format);
  return any ? kPass : kNothing;
}

void add_options(Arguments& args, Options& o) {
  add_scene(args, o.scene).required();
  add_solvers(args, o.solvers, "A solver, of which only the iterations vary").required();
  args.add_option("--at", o.at,
                  "Time of the state from which the step is made [s]; 0: the scene's start")
      .check(in_range(0.0, 1e6));
  args.add_option("--from", o.from, "The solver whose run gives that state");
  args.add_option("--most", o.most, "The most iterations").check(in_range(1, 1 << 20));
  add_settings(args, o.settings);
  add_output(args, o.figures, "Draw the curves into this folder, as SVG with data and script");
  args.add_option("--kind", o.kind, "What is drawn: distance, gap, stretch, residual")
      .check(known("kind", step_kinds()))
      .needs("--output");
  add_record(args, o.record);
  add_results(args, o.out);
  add_format(args, o.format);
}

}  // namespace

}  // namespace taut::verb::convergence

TAUT_VERB(converge) = {
    .name = "converge",
    .group = VerbGroup::cost,
    .summary = "Shows the error over the iterations of one step, against the exact step",
    .example = "taut converge chain --solver jakobsen --solver admm --at 0.5 -o figures",
    .answer = {{"facts", "scene settings at from dt picture"},
               {"points", "solver iterations residual stretch gap distance cpu"},
               {"solvers",
                "solver structural shear bend contraction floor moved exact_residual exact"},
               {"reached", "solver below iterations cpu"},
               {"unsupported", "solver why"}},
    .bind = taut::bind_verb<taut::verb::convergence::add_options, taut::verb::convergence::run>};
