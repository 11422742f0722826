#include "experiments/study/frontier/frontier.hpp"

#include <cmath>
#include <iomanip>
#include <iterator>

#include "core/model/text.hpp"
#include "experiments/baseline/baseline.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/plot/plot.hpp"
#include "experiments/study/frontier/parameter_frontier.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/text.hpp"
#include "experiments/timing/statistics.hpp"

namespace taut::verb::frontier {

namespace {

struct Options {
  CaseOptions which;
  std::vector<std::string> all;  ///< solvers whose every parameter is asked for; empty: one case
  std::string baselines;
  bool check = false, update = false;
  std::string of = "dt", out;
  std::optional<double> from, to;
  double tolerance = SearchRange{}.tolerance;
  int jobs = 1;
  bool json = false;
};

std::string unit_of(const Options& options, const SolverChoice& choice) {
  if (options.of == "dt") return " s";
  for (const ParamSpec& spec : choice.entry->params)
    if (spec.name == options.of && !spec.unit.empty()) return " " + std::string(spec.unit);
  return "";
}

/// How theory and the bracket agree.
std::string agreement(const Prediction& theory, const Frontier& found) {
  if (theory.kind != found.kind)
    return std::string("theory says ") + std::string(to_string(theory.kind)) + " here";
  if (theory.kind != Frontier::Kind::bracketed) return "agrees";
  if (theory.value >= found.stable && theory.value <= found.unstable) return "inside the bracket";
  const double nearest = theory.value < found.stable ? found.stable : found.unstable;
  const double off = 100 * (nearest / theory.value - 1);
  return "measured " + (off < 0 ? "" : std::string("+")) + number_text(off, 2) + " % from it";
}

void print_line(std::string_view label, const std::string& text) {
  std::cout << "  " << std::left << std::setw(16) << label << text << '\n';
}

void print_theory(const Prediction& theory, const Frontier& found, const std::string& unit) {
  std::string text = theory.kind == Frontier::Kind::bracketed ? number_text(theory.value, 5) + unit
                                                              : std::string(to_string(theory.kind));
  print_line("theory", text + ", " + agreement(theory, found) + ": " + theory.law);
  if (theory.growth > 1 + 1e-6 && theory.kind == Frontier::Kind::none_stable)
    print_line("", "growth per step " + number_text(theory.growth, 5));
}

void print_text(const CaseFrontier& result, const std::optional<Prediction>& theory,
                const std::string& unit, double seconds) {
  const Frontier& found = result.frontier;
  const auto outcome = [&](double value) {
    const Probed* probe = found.at(value);
    return shortest(value) + unit + "  " + (probe ? describe(probe->status) : "");
  };
  if (found.kind == Frontier::Kind::all_stable)
    print_line("stable", "as far as was looked (--to): " + outcome(found.stable) +
                             "; stable is not accurate");
  else if (found.kind != Frontier::Kind::none_stable)
    print_line("stable up to", outcome(found.stable));
  if (found.kind != Frontier::Kind::all_stable)
    print_line("unstable from", outcome(found.unstable));
  if (theory)
    print_theory(*theory, found, unit);
  else
    print_line("theory", "none for these settings");
  std::string above = std::to_string(found.above) + " values above the bracket, ";
  if (found.stable_above.empty()) {
    above += "none stable";
  } else {
    above += "NOT MONOTONE: stable again at";
    for (const double value : found.stable_above) above += " " + shortest(value);
  }
  if (found.kind != Frontier::Kind::all_stable) print_line("looked at", above);
  print_line("growth", "looked for over " + number_text(seconds) +
                           " s; what grows more slowly counts as stable");
  print_line("cases", std::to_string(found.probes.size()) + ", of which " +
                          std::to_string(result.ran) + " were run now");
}

Json to_json(const Options& options, const CaseFrontier& result,
             const std::optional<Prediction>& theory) {
  const Frontier& found = result.frontier;
  Json probes = Json::array();
  for (std::size_t i = 0; i < found.probes.size(); ++i)
    probes.push_back({{"value", found.probes[i].value},
                      {"status", to_string(found.probes[i].status.kind)},
                      {"reason", found.probes[i].status.reason},
                      {"step", found.probes[i].status.step},
                      {"id", result.records[i].id},
                      {"key", result.records[i].key}});
  Json all{{"of", options.of}, {"kind", to_string(found.kind)}, {"probes", probes}};
  if (found.kind != Frontier::Kind::none_stable) all["stable"] = found.stable;
  if (found.kind != Frontier::Kind::all_stable) all["unstable"] = found.unstable;
  all["stable_above"] = found.stable_above;
  if (theory) {
    all["theory"] = {{"kind", to_string(theory->kind)}, {"law", theory->law}};
    if (theory->kind == Frontier::Kind::bracketed) all["theory"]["value"] = theory->value;
    if (theory->growth > 0) all["theory"]["growth"] = theory->growth;
  }
  return all;
}

int not_answered(const CaseFrontier& result) {
  if (result.interrupted) return kInterrupted;
  for (const Record& record : result.records)
    if (record.status.kind != Status::Kind::ok) {
      std::cerr << record.id << ": " << describe(record.status) << '\n';
      break;
    }
  return kNothing;
}

/// "0.12 s", "none" or, where nothing goes wrong, "-".
std::string with_unit(double value, const std::string& unit) {
  return std::isnan(value) ? "-" : number_text(value) + (unit.empty() ? "" : " " + unit);
}

std::string theory_text(const ParameterFrontier& one) {
  if (one.law.empty()) return "";
  return (std::isnan(one.theory) ? "beyond" : number_text(one.theory)) + ": " + one.law;
}

/// A row a parameter, three columns a solver; the theory of a single one.
void print_all(const std::vector<ParameterFrontier>& found, std::size_t solvers) {
  const std::size_t parameters = found.size() / solvers;
  Row head{"parameter"}, names{""};
  for (std::size_t s = 0; s < solvers; ++s) {
    head.insert(head.end(), {"good up to", "bad from", "what goes wrong"});
    names.insert(names.end(), {found[s * parameters].solver, "", ""});
  }
  if (solvers == 1) head.emplace_back("theory"), names.emplace_back();
  std::vector<Row> rows{names, head};
  for (std::size_t k = 0; k < parameters; ++k) {
    const std::string& unit = found[k].unit;
    const bool common = found[(solvers - 1) * parameters + k].unit == unit;
    Row row{found[k].parameter + (unit.empty() || !common ? "" : " [" + unit + "]")};
    for (std::size_t s = 0; s < solvers; ++s) {
      const ParameterFrontier& one = found[s * parameters + k];
      if (!one.lacks.empty())
        row.insert(row.end(), {"-", "-", "(" + one.lacks.substr(0, 40) + ")"});
      else
        row.insert(row.end(), {with_unit(one.good, common ? "" : one.unit),
                               with_unit(one.bad, common ? "" : one.unit),
                               std::isnan(one.bad) ? "nothing as far as was asked" : one.symptom});
    }
    if (solvers == 1) row.push_back(theory_text(found[k]));
    rows.push_back(std::move(row));
  }
  print_columns(rows, 1);
  for (const ParameterFrontier& one : found) {
    if (!one.at_start.empty())
      std::cout << one.solver << ", " << one.parameter << ": not counted, for it is so at "
                << with_unit(one.from, one.unit) << " already: " << one.at_start << '\n';
    if (!std::isnan(one.bad))
      std::cout << one.solver << ", " << one.parameter << ", " << one.symptom << ":\n    "
                << reproduce(one.beyond) << '\n';
  }
}

/// As a baseline keeps cases: an id, what is wrong beyond, and the ends.
BaselineRow row_of(const ParameterFrontier& one) {
  BaselineRow row;
  row.id = one.solver + ", " + one.parameter;
  row.spec = one.beyond;
  row.spec.solver = one.beyond.solver.empty() ? one.solver : one.beyond.solver;
  if (!one.lacks.empty()) {
    row.status = "no answer: " + one.lacks;
    return row;
  }
  row.status = one.symptom.empty() ? "nothing wrong" : one.symptom;
  if (!one.at_start.empty()) row.status += "; from the start: " + one.at_start;
  row.values = {{"from", one.from}, {"to", one.to}, {"good", one.good}, {"bad", one.bad}};
  return row;
}

/// Compares with the rows of these solvers in the baseline, or puts what was found in their place.
int check_or_update(const Options& options, const std::vector<ParameterFrontier>& found) {
  const auto folder = std::filesystem::path(options.baselines) / kFrontiersFolder;
  Baseline now, others, before = read_baseline(folder);
  for (const ParameterFrontier& one : found) now.push_back(row_of(one));
  std::erase_if(before, [&](const BaselineRow& row) {
    const bool other = std::ranges::none_of(
        found, [&](const ParameterFrontier& one) { return row.id.starts_with(one.solver + ", "); });
    if (other) others.push_back(row);
    return other;
  });
  const Tolerances tolerances = read_tolerances(folder);
  if (options.update) {
    std::ranges::copy(updated(before, now, tolerances), std::back_inserter(others));
    write_baseline(folder, others);
    progress() << folder.string() << '\n';
    return kPass;
  }
  const Comparison comparison = compare(before, now, tolerances);
  for (const Change& change : comparison.findings)
    std::cerr << (change.id.empty() ? change.solver : change.id) << ": " << change.text << '\n';
  progress() << comparison.cases << " frontiers compared with " << folder.string() << ": "
             << (comparison.regressed() ? "some have moved" : "none has moved") << '\n';
  if (comparison.regressed()) return kRegression;
  return comparison.mismatched() || comparison.cases == 0 ? kNothing : kPass;
}

/// Every parameter of one or two solvers.
int run_all(const Options& options) {
  const Store store(options.out);
  std::vector<std::string> solvers;
  for (const std::string& text : options.all) solvers.push_back(parse_solver(text).brief());
  if (solvers.size() == 2 && solvers[0] == solvers[1])
    throw InputError("--all: " + solvers[0] + " twice");
  store.prepare();
  begin_session(store, "taut frontier --all");
  std::vector<ParameterFrontier> found;
  for (const std::string& solver : solvers) {
    const Countdown countdown("parameter of " + solver);
    const auto frontiers =
        find_frontiers(solver, store, {.jobs = options.jobs, .frames = true},
                       [&](std::size_t done, std::size_t all) { countdown(done, all); });
    if (!frontiers) return kInterrupted;
    const std::filesystem::path folder = std::filesystem::path(options.out) / kFrontiersFolder;
    make_folder(folder);
    write_file(folder / (report::slug(solver) + ".json"), to_json(*frontiers, program_digest()));
    found.insert(found.end(), frontiers->begin(), frontiers->end());
  }
  if (options.json)
    std::cout << to_json(found, program_digest());
  else
    print_all(found, solvers.size());
  try {
    std::string stem = report::slug(solvers[0]);
    if (solvers.size() == 2) stem += "-and-" + report::slug(solvers[1]);
    const auto picture =
        report::plot_frontiers(found, std::filesystem::path(options.out) / kFrontiersFolder, stem);
    (options.json ? progress() : std::cout) << picture.string() << '\n';
  } catch (const report::PlotError& error) {
    std::cerr << "no picture: " << error.what() << '\n';
  }
  return options.check || options.update ? check_or_update(options, found) : kPass;
}

int run(const Options& options) {
  if (!options.all.empty()) return run_all(options);
  if (options.which.spec().scene.empty() || options.which.spec().solver.empty())
    throw InputError("SCENE and SOLVER are required, or --all SOLVER");
  FrontierQuestion question{options.which.spec(), options.of, {}};
  question.range = range_of(question.base, options.of, options.from, options.to);
  question.range.tolerance = options.tolerance;
  const Case first = make_case(question.at(question.range.from));
  const Store store(options.out);
  store.prepare();
  begin_session(store, "taut frontier " + first.id);
  Progress progress;
  const CaseFrontier result = find_frontier(
      question, store,
      {.jobs = options.jobs, .progress = [&](const CampaignProgress& t, const Record* record) {
         if (record) progress.show(t, record);
       }});
  if (result.frontier.kind == Frontier::Kind::not_answered) return not_answered(result);
  const std::optional<Prediction> theory = predicted_frontier(question);
  if (options.json) {
    print_json(to_json(options, result, theory), 2);
    return kPass;
  }
  const CaseSpec spec = question.base;
  std::cout << first.scene->name << ' ' << spec.solver << ": largest stable " << options.of << '\n';
  print_text(result, theory, unit_of(options, first.choice), first.scene->duration());
  return kPass;
}

void add_options(CLI::App& app, Options& options) {
  options.which.bind(app);
  for (const char* name : {"SCENE", "SOLVER"}) app.get_option(name)->required(false);
  auto* all =
      app.add_option(
             "--all", options.all,
             "One or two solvers: every parameter of theirs and of a small standard scene, with "
             "what goes wrong first, as a table and a picture; a minute or so")
          ->expected(1, 2)
          ->excludes("SCENE")
          ->excludes("SOLVER");
  add_baselines(app, options.baselines);
  app.add_flag("--check", options.check,
               "Exit 1 if a frontier of --all is another one than in the baseline")
      ->needs(all);
  app.add_flag("--update", options.update, "Keep what --all finds as the baseline")->needs(all);
  app.add_option("--of", options.of,
                 "What to enlarge: dt, a parameter of the solver, or a scene key with a dot "
                 "(default: dt)");
  app.add_option("--from", options.from, "Where to start (dt: 1e-3 s)");
  app.add_option("--to", options.to, "Where to stop (dt: 0.5 s)");
  app.add_option("--tolerance", options.tolerance, "Relative width of the bracket (default: 0.01)")
      ->check(CLI::Range(1e-9, 0.5));
  add_jobs(app, options.jobs);
  add_results(app, options.out);
  app.add_flag("--json", options.json, "Print JSON");
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
        "  taut frontier --all jakobsen bullet\n"
        "Exit: 0 found; 1 a frontier of --all moved; 4 nothing was answered or compared",
    .bind = taut::bind_verb<taut::verb::frontier::add_options, taut::verb::frontier::run>};
