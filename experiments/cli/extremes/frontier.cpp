#include "core/model/text.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/report/every_frontier.hpp"
#include "experiments/require/accepted_frontiers.hpp"

namespace taut::verb::frontier {

namespace {

struct Options {
  CaseOptions which;
  std::vector<std::string> others;  ///< solvers that get the same question
  std::vector<std::string> keep;    ///< METRIC:LIMIT; empty: the default limits of the scene
  std::vector<std::string> all;  ///< solvers of which every parameter is searched; empty: one case
  std::string baselines;
  bool check = false, update = false;
  std::string of = "dt", out;
  std::optional<double> from, to;
  double tolerance = SearchRange{}.tolerance;
  int jobs = 1;
  Format format;
};

/// Searches one setting of one scene.
int run_setting(const Options& options) {
  std::vector<std::string> solvers{options.which.spec().solver};
  solvers.insert(solvers.end(), options.others.begin(), options.others.end());
  if (options.which.spec().scene.empty() || solvers.front().empty())
    throw InputError("SCENE and SOLVER are required, or --all SOLVER");
  check_solvers(solvers);
  CaseSpec one = options.which.spec();
  for (const std::string& solver : solvers) {  // a bad setting is refused before a store is made
    one.solver = solver;
    range_of(one, options.of, options.from, options.to);
  }
  Store store(options.out);
  store.prepare();
  const auto found =
      find_accepted_frontiers({.base = options.which.spec(),
                               .solvers = solvers,
                               .of = options.of,
                               .from = options.from,
                               .to = options.to,
                               .tolerance = options.tolerance,
                               .keep = options.keep,
                               .how = {.jobs = options.jobs, .progress = show_ended_cases()}},
                              store);
  if (!found) return kInterrupted;
  const bool answered = found->any_answered();
  if (!answered && solvers.size() == 1)
    std::cerr << not_answered_because(found->of_solvers.front().second.stable) << '\n';
  if (answered || solvers.size() > 1 || options.format.is_data())
    print(answer_of(*found), options.format);
  return answered ? kPass : kNothing;
}

/// Searches every parameter of one or two solvers.
int run_every_parameter(const Options& options) {
  using report::Baseline;
  Store store(options.out);
  const auto found = report::find_every_frontier(
      {.solvers = options.all,
       .baseline = options.update  ? Baseline::update
                   : options.check ? Baseline::check
                                   : Baseline::ignore,
       .baselines = options.baselines,
       .jobs = options.jobs,
       .countdown = [](const std::string& solver) { return Countdown("parameter of " + solver); }},
      store);
  if (!found) return kInterrupted;
  int code = kPass;
  for (const FrontierCheck& check : found->checks) {
    for (const Difference& change : check.changes) std::cerr << printable(change.text) << '\n';
    progress() << printable(check.news) << '\n';
    code = std::max(code, exit_code(check.end));
  }
  if (!found->no_picture.empty()) std::cerr << "no picture: " << found->no_picture << '\n';
  print(found->answer, options.format);
  return code;
}

int run(const Options& options) {
  return options.all.empty() ? run_setting(options) : run_every_parameter(options);
}

void add_options(Arguments& args, Options& options) {
  options.which.bind(args);
  for (const char* name : {"SCENE", "SOLVER"}) args.at(name).required(false);
  args.add_option("OTHERS", options.others, "Further solvers: then one table, a row for each");
  args.add_option(
          "--keep", options.keep,
          "METRIC:LIMIT up to which a case is acceptable, in SI units or in the unit shown "
          "(stretch.rms:5%); repeat it for each (default: what the scene accepts, see `taut "
          "advise --help`)")
      .repeated();
  args.add_option(
          "--all", options.all,
          "One or two solvers: every parameter of theirs and of a small standard scene, with "
          "what goes wrong first, as a table and a picture; takes about a minute")
      .expected(1, 2)
      .excludes("SCENE")
      .excludes("SOLVER")
      .excludes("OTHERS")
      .excludes("--keep");
  for (const char* name : {"--dt", "--duration", "--set", "--fabric"})
    args.at(name).excludes("--all");
  add_baselines(args, options.baselines);
  args.add_flag("--check", options.check, "Exit 1 if a frontier of --all differs from the baseline")
      .needs("--all");
  args.add_flag("--update", options.update, "Keep what --all finds as the baseline").needs("--all");
  args.add_option("--of", options.of,
                  "What to enlarge: dt, a parameter of the solver, or a scene key with a dot "
                  "(default: " +
                      options.of + ")")
      .excludes("--all");
  args.add_option("--from", options.from,
                  "Where to start (dt: " + as_typed(kTimeSteps.from) + " s)")
      .excludes("--all");
  args.add_option("--to", options.to, "Where to stop (dt: " + as_typed(kTimeSteps.to) + " s)")
      .excludes("--all");
  args.add_option("--tolerance", options.tolerance,
                  "Relative width of the bracket (default: " + as_typed(options.tolerance) + ")")
      .check(in_range(1e-9, 0.5))
      .excludes("--all");
  add_jobs(args, options.jobs);
  add_results(args, options.out);
  add_format(args, options.format);
}

}  // namespace
}  // namespace taut::verb::frontier

TAUT_VERB(frontier) = {
    .name = "frontier",
    .group = VerbGroup::extremes,
    .summary = "Finds how far a setting can go before a solver fails, beside theory",
    .example =
        "taut frontier chain mass-spring:substeps=1 --tolerance 0.001\n"
        "  taut frontier chain jakobsen:iterations=1,substeps=1,order=mesh --of omega --from 1\n"
        "  taut frontier flag bullet --of wind.strength --from 0.1 --to 1000\n"
        "  taut frontier ball jakobsen pd xpbd --keep stretch.rms:5%\n"
        "  taut frontier --all jakobsen bullet\n"
        "Exit: 0 found; 1 a frontier of --all moved; 4 nothing was answered or compared",
    .answer =
        {{"facts",
          "of kind stable acceptable theory looked_for cases ran picture unstable growth above"},
         {"probes", "value status step case"},
         {"frontiers", "solver stable stable_end acceptable acceptable_end"},
         {"parameters",
          "solver parameter unit good bad symptom at_start theory law lacks from to downwards "
          "cases beyond_scene beyond_solver"},
         {"beyond", "solver parameter scene_setting"},
         {"commands", "solver parameter command"}},
    .bind = taut::bind_verb<taut::verb::frontier::add_options, taut::verb::frontier::run>};
