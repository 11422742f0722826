#include "core/model/text.hpp"
#include "experiments/baseline/frontier_baseline.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/report/plot/plot.hpp"
#include "experiments/require/require.hpp"
#include "experiments/study/frontier/frontier_answer.hpp"
#include "experiments/study/frontier/parameter_frontier.hpp"
#include "experiments/system/text.hpp"

namespace taut::verb::frontier {

namespace {

struct Options {
  CaseOptions which;
  std::vector<std::string> others;  ///< solvers that are asked the same
  std::vector<std::string> keep;    ///< METRIC:LIMIT; empty: what the scene accepts
  std::vector<std::string> all;     ///< solvers whose every parameter is asked for; empty: one case
  std::string baselines;
  bool check = false, update = false;
  std::string of = "dt", out;
  std::optional<double> from, to;
  double tolerance = SearchRange{}.tolerance;
  int jobs = 1;
  Format format;
};

/// What is accepted of the scene: what was asked for, else its own limits.
std::vector<KeptAnswer> limits_of(const Options& options, const Scene& scene) {
  if (options.keep.empty()) return default_limits(scene);
  std::vector<KeptAnswer> limits;
  read_all(options.keep,
           [&](const std::string& asked) { limits.push_back(parse_limit(asked, scene)); });
  return limits;
}

FrontierQuestion question_of(const Options& options, const std::string& solver) {
  FrontierQuestion question{options.which.spec(), options.of, {}};
  question.base.solver = solver;
  question.range = range_of(question.base, options.of, options.from, options.to);
  question.range.tolerance = options.tolerance;
  return question;
}

BothFrontiers find(const FrontierQuestion& question, const std::vector<KeptAnswer>& limits,
                   const Options& options, Store& store) {
  store.begin_session("taut frontier " + make_case(question.at(question.range.from)).id);
  Progress shown;
  return find_both(question, store,
                   {.jobs = options.jobs,
                    .progress =
                        [&](const CampaignProgress& campaign, const Record* record) {
                          if (record) shown.show(campaign, record);
                        }},
                   [&](const Case&, const Record& record) { return beyond(record, limits); });
}

int run_each(const Options& options) {
  std::vector<std::string> solvers{options.which.spec().solver};
  solvers.insert(solvers.end(), options.others.begin(), options.others.end());
  if (options.which.spec().scene.empty() || solvers.front().empty())
    throw InputError("SCENE and SOLVER are required, or --all SOLVER");
  check_solvers(solvers);
  Store store(options.out);
  store.prepare();
  std::vector<std::pair<FrontierQuestion, BothFrontiers>> found;
  std::vector<KeptAnswer> limits;
  for (const std::string& solver : solvers) {
    FrontierQuestion question = question_of(options, solver);
    if (limits.empty())
      limits = limits_of(options, *make_case(question.at(question.range.from)).scene);
    BothFrontiers both = find(question, limits, options, store);
    if (both.stable.interrupted) return kInterrupted;
    found.emplace_back(std::move(question), std::move(both));
  }
  const auto answered = std::ranges::count_if(found, [](const auto& one) {
    return one.second.stable.frontier.kind != Frontier::Kind::not_answered;
  });
  const auto& [question, both] = found.front();
  if (solvers.size() > 1) {
    Answer answer{"frontier", question.base.scene + ": largest " + options.of + " of each solver"};
    answer.add(Column("of").in_detail(), options.of);
    answer.add(table_of(found, join(limits, ", ", [](const KeptAnswer& limit) {
                          return limit.name + " at most " + text(limit, limit.tolerance);
                        })));
    print(answer, options.format);
  } else {
    if (answered == 0) std::cerr << not_answered_because(both.stable) << '\n';
    if (answered > 0 || options.format.is_data())
      print(answer_of(question, both, answered > 0 ? predicted_frontier(question) : std::nullopt),
            options.format);
  }
  return answered > 0 ? kPass : kNothing;
}

/// Compares with what the baseline has of this solver, or puts this answer in its place.
int check_or_update(const Options& options, const std::string& solver, const Answer& now) {
  const FrontierCheck found = check_frontiers(now, solver, options.baselines, options.update);
  for (const Difference& change : found.changes) std::cerr << printable(change.text) << '\n';
  progress() << printable(found.news) << '\n';
  return found.end == CheckEnd::passed  ? kPass
         : found.end == CheckEnd::moved ? kRegression
                                        : kNothing;
}

/// Every parameter of one or two solvers.
int run_all(const Options& options) {
  Store store(options.out);
  std::vector<std::string> solvers;
  for (const std::string& text : options.all) solvers.push_back(parse_solver(text).brief());
  if (solvers.size() == 2 && solvers[0] == solvers[1])
    throw InputError("--all: " + solvers[0] + " twice");
  store.prepare();
  store.begin_session("taut frontier --all");
  std::vector<ParameterFrontier> found;
  int code = kPass;
  for (const std::string& solver : solvers) {
    const Countdown countdown("parameter of " + solver);
    const auto frontiers =
        find_frontiers(solver, store, {.jobs = options.jobs, .frames = true},
                       [&](std::size_t done, std::size_t all) { countdown(done, all); });
    if (!frontiers) return kInterrupted;
    Answer answer = answer_of(*frontiers);
    answer.subject = solver;
    store.keep(answer);
    if (options.check || options.update)
      code = std::max(code, check_or_update(options, solver, answer));
    found.insert(found.end(), frontiers->begin(), frontiers->end());
  }
  Answer answer = answer_of(found);
  answer.subject = join(solvers, " ");
  answer.add(commands_of(found));
  try {
    std::string stem = slug(solvers[0]);
    if (solvers.size() == 2) stem += "-and-" + slug(solvers[1]);
    const auto picture =
        report::plot_frontiers(found, std::filesystem::path(options.out) / kFrontiersFolder, stem);
    answer.add({"picture"}, picture.string());
  } catch (const report::PlotError& error) {
    std::cerr << "no picture: " << error.what() << '\n';
  }
  print(answer, options.format);
  return code;
}

int run(const Options& options) {
  return options.all.empty() ? run_each(options) : run_all(options);
}

void add_options(CLI::App& app, Options& options) {
  options.which.bind(app);
  for (const char* name : {"SCENE", "SOLVER"}) app.get_option(name)->required(false);
  auto* others =
      app.add_option("OTHERS", options.others, "Further solvers: then one table, a row for each");
  app.add_option("--keep", options.keep,
                 "METRIC:LIMIT up to which a case is acceptable, in SI units, in the unit shown "
                 "(stretch.rms:5%); repeat it (default: what the scene accepts, as advise has it)")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  auto* all =
      app.add_option(
             "--all", options.all,
             "One or two solvers: every parameter of theirs and of a small standard scene, with "
             "what goes wrong first, as a table and a picture; a minute or so")
          ->expected(1, 2)
          ->excludes("SCENE")
          ->excludes("SOLVER")
          ->excludes(others)
          ->excludes("--keep");
  for (const char* name : {"--dt", "--duration", "--set", "--fabric"})
    app.get_option(name)->excludes(all);
  add_baselines(app, options.baselines);
  app.add_flag("--check", options.check,
               "Exit 1 if a frontier of --all is another one than in the baseline")
      ->needs(all);
  app.add_flag("--update", options.update, "Keep what --all finds as the baseline")->needs(all);
  app.add_option("--of", options.of,
                 "What to enlarge: dt, a parameter of the solver, or a scene key with a dot "
                 "(default: dt)")
      ->excludes(all);
  app.add_option("--from", options.from, "Where to start (dt: 1e-3 s)")->excludes(all);
  app.add_option("--to", options.to, "Where to stop (dt: 0.5 s)")->excludes(all);
  app.add_option("--tolerance", options.tolerance, "Relative width of the bracket (default: 0.01)")
      ->check(CLI::Range(1e-9, 0.5))
      ->excludes(all);
  add_jobs(app, options.jobs);
  add_results(app, options.out);
  add_format(app, options.format);
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
         {"beyond", "solver parameter override"},
         {"commands", "solver parameter command"}},
    .bind = taut::bind_verb<taut::verb::frontier::add_options, taut::verb::frontier::run>};
