#include "experiments/study/frontier/frontier.hpp"

#include <cmath>
#include <iterator>

#include "core/model/text.hpp"
#include "experiments/baseline/baseline.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/plot/plot.hpp"
#include "experiments/require/require.hpp"
#include "experiments/study/frontier/parameter_frontier.hpp"
#include "experiments/system/files.hpp"

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

Unit unit_of(const Options& options, const SolverChoice& choice) {
  if (options.of == "dt") return kTime;
  for (const ParamSpec& spec : choice.entry->params)
    if (spec.name == options.of && !spec.unit.empty()) return {spec.unit, spec.unit};
  return kNumber;
}

/// How theory and the bracket agree.
std::string agreement(const Prediction& theory, const Frontier& found) {
  if (theory.kind != found.kind)
    return std::string("theory says ") + std::string(to_string(theory.kind)) + " here";
  if (theory.kind != Frontier::Kind::bracketed) return "agrees";
  if (theory.value >= found.stable && theory.value <= found.unstable) return "inside the bracket";
  const double nearest = theory.value < found.stable ? found.stable : found.unstable;
  const double off = nearest / theory.value - 1;
  return "measured " + std::string(off < 0 ? "" : "+") + number_text(off, kShare, 2) + " from it";
}

void add_theory(Answer& answer, const std::optional<Prediction>& theory, const Frontier& found,
                const Unit& unit) {
  const Column column("theory", "theory", unit, 5);
  if (!theory)
    return answer.add(column, Cell().with("none for these settings; there is one for few links, "
                                          "with jakobsen in order=mesh"));
  const bool bracketed = theory->kind == Frontier::Kind::bracketed;
  answer.add(column, (bracketed ? Cell(theory->value) : Cell(to_string(theory->kind)))
                         .with(agreement(*theory, found) + ": " + theory->law));
  if (theory->growth > 1 + 1e-6 && theory->kind == Frontier::Kind::none_stable)
    answer.add({"growth", "growth per step, theory", kNumber, 5}, theory->growth);
}

/// One solver: how far it is stable, and how far what it does is acceptable, too.
struct Found {
  Case first;
  CaseFrontier stable, acceptable;
};

/// What is accepted of the scene: what was asked for, else its own limits.
std::vector<KeptAnswer> limits_of(const Options& options, const Scene& scene) {
  if (options.keep.empty()) return default_limits(scene);
  std::vector<KeptAnswer> limits;
  read_all(options.keep,
           [&](const std::string& asked) { limits.push_back(parse_limit(asked, scene)); });
  return limits;
}

/// "stretch.rms 31 %, more than 10 %": what ends what is acceptable, at a value that was tried.
std::string ends_with(const Frontier& found) {
  const bool none = found.kind == Frontier::Kind::none_stable;
  const Probed* probe =
      found.kind == Frontier::Kind::all_stable ? nullptr : found.at(found.unstable);
  if (!probe) return none ? "" : "as far as was looked (--to)";
  return probe->symptom.empty() ? describe(probe->status) : probe->symptom;
}

/// The last acceptable value beside the last stable one.
void add_acceptable(Answer& answer, const Frontier& found, const Unit& unit) {
  const Column column("acceptable", "acceptable up to", unit, 7);
  if (found.kind == Frontier::Kind::none_stable)
    answer.add(column, Cell("none").with("from the start: " + ends_with(found)));
  else if (found.kind != Frontier::Kind::not_answered)
    answer.add(column, Cell(found.stable)
                           .with(found.kind == Frontier::Kind::all_stable
                                     ? ends_with(found)
                                     : "then, at " + number_text(found.unstable) + ", " +
                                           ends_with(found)));
}

Answer answer_of(const Options& options, const Found& one,
                 const std::optional<Prediction>& theory) {
  const Case& first = one.first;
  const CaseFrontier& result = one.stable;
  const Frontier& found = result.frontier;
  const Unit unit = unit_of(options, first.choice);
  Answer answer{"frontier", first.scene->name + " " + options.which.spec().solver +
                                ": largest stable " + options.of};
  const auto end = [&](const char* name, const char* heading, double value) {
    const Probed* probe = found.at(value);
    std::string what = probe ? describe(probe->status) : "";
    if (probe && probe->stable() && probe->status.kind == Status::Kind::extreme)
      what += "; a large strain alone is no instability";
    answer.add({name, heading, unit, 7}, Cell(value).with(what));
  };
  answer.add(Column("of").in_detail(), options.of);
  answer.add(Column("kind").in_detail(), to_string(found.kind));
  if (found.kind == Frontier::Kind::all_stable)
    answer.add({"stable", "stable", unit, 7},
               Cell(found.stable).with("as far as was looked (--to); stable is not accurate"));
  else if (found.kind != Frontier::Kind::none_stable)
    end("stable", "stable up to", found.stable);
  if (found.kind != Frontier::Kind::all_stable) end("unstable", "unstable from", found.unstable);
  add_acceptable(answer, one.acceptable.frontier, unit);
  add_theory(answer, theory, found, unit);
  if (found.kind != Frontier::Kind::all_stable)
    answer.add({"above", "values above the bracket"},
               Cell(found.above)
                   .with(found.stable_above.empty() ? "none stable"
                                                    : "NOT MONOTONE: stable again at " +
                                                          join(found.stable_above, " ", shortest)));
  answer.add({"looked_for", "growth looked for over", kTime},
             Cell(first.scene->duration()).with("what grows more slowly counts as stable"));
  answer.add({"cases"}, found.probes.size());
  answer.add({"ran", "of which were run now"}, result.ran + one.acceptable.ran);
  Table probes{
      "probes", "what was run", {{"value", options.of, unit, 7}, {"status"}, {"step"}, {"case"}}};
  for (std::size_t i = 0; i < found.probes.size(); ++i) {
    const Probed& probe = found.probes[i];
    Cell id(result.records[i].id);
    id.key = result.records[i].key;
    probes.rows.push_back({probe.value,
                           Cell(to_string(probe.status.kind)).with(probe.status.reason),
                           probe.status.step >= 0 ? Cell(probe.status.step) : Cell(), id});
  }
  probes.detail = true;
  answer.add(std::move(probes));
  return answer;
}

/// What its first case that did not end well says.
std::string not_answered_because(const CaseFrontier& result) {
  for (const Record& record : result.records)
    if (record.status.kind != Status::Kind::ok) return record.id + ": " + describe(record.status);
  return "";
}

int not_answered(const CaseFrontier& result) {
  if (result.interrupted) return kInterrupted;
  if (const std::string why = not_answered_because(result); !why.empty()) std::cerr << why << '\n';
  return kNothing;
}

FrontierQuestion question_of(const Options& options, const std::string& solver) {
  FrontierQuestion question{options.which.spec(), options.of, {}};
  question.base.solver = solver;
  question.range = range_of(question.base, options.of, options.from, options.to);
  question.range.tolerance = options.tolerance;
  return question;
}

/// Both ends of one solver; the second search finds most of its cases stored.
Found find(const Options& options, const FrontierQuestion& question, Store& store) {
  Found found{make_case(question.at(question.range.from)), {}, {}};
  store.begin_session("taut frontier " + found.first.id);
  const std::vector<KeptAnswer> limits = limits_of(options, *found.first.scene);
  Progress progress;
  const CampaignOptions how{.jobs = options.jobs,
                            .progress = [&](const CampaignProgress& t, const Record* record) {
                              if (record) progress.show(t, record);
                            }};
  found.stable = find_frontier(question, store, how);
  if (found.stable.frontier.kind == Frontier::Kind::not_answered) return found;
  found.acceptable = find_frontier(question, store, how, [&](const Case&, const Record& record) {
    return completed(record.status) ? beyond(record, limits) : describe(record.status);
  });
  return found;
}

/// Several solvers, a row each.
int run_several(const Options& options, Store& store) {
  std::vector<std::string> solvers{options.which.spec().solver};
  solvers.insert(solvers.end(), options.others.begin(), options.others.end());
  check_solvers(solvers);
  const Unit unit = unit_of(options, parse_solver(solvers.front()));
  Table table{"frontiers",
              "",
              {{"solver"},
               {"stable", "stable up to", unit, 4},
               {"stable_end", "then"},
               {"acceptable", "acceptable up to", unit, 4},
               {"acceptable_end", "then"}}};
  int answered = 0;
  std::vector<KeptAnswer> limits;
  for (const std::string& solver : solvers) {
    const Found found = find(options, question_of(options, solver), store);
    if (found.stable.interrupted) return kInterrupted;
    const Frontier &stable = found.stable.frontier, &acceptable = found.acceptable.frontier;
    if (limits.empty()) limits = limits_of(options, *found.first.scene);
    if (stable.kind == Frontier::Kind::not_answered) {
      table.rows.push_back({solver, Cell(), not_answered_because(found.stable), Cell(), ""});
      continue;
    }
    ++answered;
    const auto value = [](const Frontier& one) {
      return one.kind == Frontier::Kind::bracketed || one.kind == Frontier::Kind::all_stable
                 ? Cell(one.stable)
                 : Cell("none");
    };
    table.rows.push_back(
        {solver, value(stable), ends_with(stable), value(acceptable), ends_with(acceptable)});
  }
  table.caption = "acceptable: " + join(limits, ", ", [](const KeptAnswer& one) {
                    return one.name + " at most " + text(one, one.tolerance);
                  });
  Answer answer{"frontier",
                options.which.spec().scene + ": largest " + options.of + " of each solver"};
  answer.add(Column("of").in_detail(), options.of);
  answer.add(std::move(table));
  print(answer, options.format);
  return answered > 0 ? kPass : kNothing;
}

/// The commands that run the cases beyond.
Table commands(const std::vector<ParameterFrontier>& found) {
  Table table{"commands", "what runs the case beyond", {{"solver"}, {"parameter"}, {"command"}}};
  for (const ParameterFrontier& one : found)
    if (!std::isnan(one.bad))
      table.rows.push_back({one.solver, one.parameter, reproduce(one.beyond)});
  return table;
}

/// Compares with what the baseline has of this solver, or puts this answer in its place.
int check_or_update(const Options& options, const std::string& solver, const Answer& now) {
  constexpr double kBracket = 0.02;  // twice the width of a bracket
  const auto file =
      std::filesystem::path(options.baselines) / kFrontiersFolder / (slug(solver) + ".json");
  if (options.update) {
    make_folder(file.parent_path());
    write_durably(file, to_json(now));
    progress() << file.string() << '\n';
    return kPass;
  }
  if (!std::filesystem::exists(file)) {
    std::cerr << solver << ": no baseline " << printable(file.string()) << '\n';
    return kNothing;
  }
  const Answer before = answer_from_json(read_text(file), file.string());
  const Table& found = now.table("parameters");
  const auto changes =
      differences(before.table("parameters"), found, {"solver", "parameter"},
                  {"lacks", "symptom", "at_start", "from", "to", "good", "bad"}, kBracket);
  for (const Difference& change : changes) std::cerr << printable(change.text) << '\n';
  progress() << found.rows.size() << " frontiers compared with " << file.string() << ": "
             << changes.size() << " differ\n";
  if (std::ranges::any_of(changes, &Difference::moved)) return kRegression;
  return changes.empty() ? kPass : kNothing;
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
  answer.add(commands(found));
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
  if (!options.all.empty()) return run_all(options);
  if (options.which.spec().scene.empty() || options.which.spec().solver.empty())
    throw InputError("SCENE and SOLVER are required, or --all SOLVER");
  Store store(options.out);
  store.prepare();
  if (!options.others.empty()) return run_several(options, store);
  const FrontierQuestion question = question_of(options, options.which.spec().solver);
  const Found found = find(options, question, store);
  if (found.stable.frontier.kind == Frontier::Kind::not_answered) {
    if (options.format.is_data()) print(answer_of(options, found, {}), options.format);
    return not_answered(found.stable);
  }
  print(answer_of(options, found, predicted_frontier(question)), options.format);
  return kPass;
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
        "of kind stable acceptable theory looked_for cases ran picture unstable growth above; "
        "probes: value status step case; "
        "frontiers: solver stable stable_end acceptable acceptable_end; "
        "parameters: solver parameter unit good bad symptom at_start theory law lacks from to "
        "downwards cases beyond_scene beyond_solver; "
        "beyond: solver parameter override; "
        "commands: solver parameter command",
    .bind = taut::bind_verb<taut::verb::frontier::add_options, taut::verb::frontier::run>};
