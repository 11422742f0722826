#include "experiments/command_line/study_options.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/external/external.hpp"
#include "experiments/history/history_answer.hpp"
#include "experiments/history/walk.hpp"
#include "experiments/report/plot/plot.hpp"
#include "experiments/results/store.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"

namespace taut::verb::history {

namespace {

struct Options : Walk {
  std::string metric = kErrorMetric, out, baselines, junit, plot;
  double disk = 20;
  Format format;
};

/// Exit code; continuous integration asks about the last build.
int exit_code(const History& history) {
  if (history.compared == 0) return kNothing;
  if (history.last_stepped()) return kRegression;
  for (std::size_t i = 0; i < history.builds.size(); ++i)
    if (history.is_gap(i) || history.missing(i) > 0) return kIncomplete;
  return kPass;
}

void draw(const History& history, const Options& options) {
  const std::filesystem::path file = std::filesystem::absolute(options.plot);
  try {
    std::cerr
        << report::plot_history(history, options.metric, file.parent_path(), file.stem()).string()
        << '\n';
  } catch (const report::PlotError& error) {
    std::cerr << error.what() << '\n';
  }
}

int history(Options options) {
  Store store(options.out);
  Walked walked;
  if (!options.junit.empty()) test_writable(options.junit);
  if (options.repository.empty()) {
    walked.study = study_name(options.study);
  } else {
    const BaselineOptions how = baseline_options();
    options.run = how.run;
    options.say = how.say;
    options.silence = external::why_silent;
    options.limits.bytes = 1e9 * options.disk;
    options.timing.progress = Countdown("case");
    walked = walk(options, store);
  }
  const Tolerances tolerances =
      read_tolerances(std::filesystem::path(options.baselines) / walked.study);
  const History found = history_of(store, walked.study, tolerances, walked.builds);
  Answer answer = answer_of(found, options.metric);
  if (!walked.named.empty()) answer.add({"named", "bisection"}, walked.named);

  if (!options.junit.empty()) write_file(options.junit, junit(found));
  if (!options.plot.empty() && !found.rows.empty()) draw(found, options);
  print(answer, options.format);
  return exit_code(found);
}

void add_options(Arguments& args, Options& o) {
  add_study(args, o.study).required();
  add_preset(args, o.preset);
  args.add_option("--metric", o.metric, "Value of the tables and of the figure")
      .check(metric_value())
      .shows_default();
  args.add_option("--plot", o.plot, "Also draw it over builds: NAME.svg, with its data");
  args.add_option("--junit", o.junit, "Also write a JUnit file about the last build");
  add_results(args, o.out);
  add_baselines(args, o.baselines);
  args.add_option("--git", o.repository,
                  "A repository; runs the commits whose results are missing first")
      .needs("--commits");
  const auto of_git = [](Argument& one) { one.needs("--git").group("With --git"); };
  of_git(args.add_option("--commits", o.range, "A..B: A and all commits from there to B"));
  of_git(args.add_option("--build", o.build,
                         "The shell command that builds a commit, run in its checkout"));
  of_git(args.add_option("--solver", o.solver,
                         "The solver, run in the checkout: 'python3 mine.py', or "
                         "mine:cmd='...',iterations=8; it replaces those of the study"));
  of_git(args.add_option("--taut", o.taut,
                         "Without --solver: the taut of that commit, which runs the study itself")
             .shows_default());
  of_git(args.add_option("--bisect", o.bisect,
                         "Run only what it takes to name the first commit at which this value "
                         "changed; cpu.per_step and wall.per_step: the cost"));
  of_git(args.add_flag("--speed", o.speed, "Also time each build in turns with the one before"));
  of_git(args.add_flag("--again", o.again, "Try commits again that could not be built"));
  of_git(args.add_option("--build-timeout", o.limits.seconds, "Seconds that a build may take")
             .check(above_zero_seconds())
             .shows_default());
  of_git(args.add_option("--disk", o.disk, "Gigabytes that a checkout with its build may take")
             .check(above_zero())
             .shows_default());
  add_jobs(args, o.jobs);
  add_limits(args, o.case_limits);
  add_format(args, o.format, "Print every build, every step and every value");
}

}  // namespace

}  // namespace taut::verb::history

TAUT_VERB(history) = {
    .name = "history",
    .group = VerbGroup::trust,
    .summary = "Finds which build, or which commit, changed what a study measures",
    .example =
        "taut history iterations\n"
        "  taut history ./mine.toml --git . --commits v1.0..HEAD --solver 'python3 mine.py'\n"
        "  taut history ./mine.toml --git . --commits v1.0..HEAD --build make --solver ./mine "
        "--bisect stretch.rms\n"
        "Exit: 0 nothing changed; 1 the last build differs from the one before; 3 builds have no "
        "results;\n      4 nothing was compared",
    .answer = {{"facts", "builds gaps cases compared steps value_steps last_stepped named"},
               {"steps", "step cases relative build made subject before case solver value was is"},
               {"builds", "build made subject cases shared steps gap"},
               {"rows", "case first last builds steps"},
               {"values", "build made case value status"},
               {"ratios", "case before now host clock ratio control"}},
    .bind = taut::bind_verb<taut::verb::history::add_options, taut::verb::history::history>};
