#include "experiments/command_line/page.hpp"

#include <iostream>
#include <set>

#include "core/io/scene_io.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "core/solver/simd/kernels.hpp"
#include "experiments/baseline/baseline.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/fingerprint.hpp"
#include "experiments/command_line/options.hpp"
#include "experiments/command_line/output.hpp"
#include "experiments/command_line/study_options.hpp"
#include "experiments/history/history.hpp"
#include "experiments/render/film/film_plan.hpp"
#include "experiments/report/findings.hpp"
#include "experiments/report/report.hpp"
#include "experiments/report/stored.hpp"
#include "experiments/study/main_job.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/distinct.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/process.hpp"

namespace taut {

namespace {

std::string command_of(const PageRequest& options) {
  std::string what, films;
  for (const std::string& study : options.studies) what += " " + shell_word(study);
  if (!options.preset.empty()) what += " --preset " + options.preset;
  for (const std::string& scene : options.films) films += " --film " + shell_word(scene);
  return "./taut run" + what + (options.studies.empty() ? "" : " && ./taut report" + what + films);
}

/// Every solver, with the reasons for which it refuses shipped scenes at its default settings.
std::vector<report::SolverInfo> introductions() {
  std::vector<report::SolverInfo> all;
  for (const SolverEntry* entry : solvers())
    all.push_back(
        {std::string(entry->name), std::string(entry->summary), std::string(entry->source), {}});
  for (const std::string& name : shipped("scenes")) {
    const Scene scene = load_scene(find_scene(name));
    for (std::size_t i = 0; i < all.size(); ++i)
      for (const std::string& reason :
           solvers()[i]->unsupported(scene, parse_solver(all[i].name).params))
        group_of(all[i].unsupported, reason).push_back(name);
  }
  return all;
}

/// Whether a scene is drawn without being requested. Bullet needs minutes for bodies that deform;
/// `--film` films such a scene.
bool is_drawn_unasked(const std::string& name) {
  const Scene scene = load_scene(find_scene(name));
  return std::ranges::none_of(scene.colliders,
                              [](const Collider& c) { return c.frames != nullptr; });
}

/// Converts "20261121T205040Z" to "2026-11-21 20:50 UTC".
std::string readable(const std::string& stamp) {
  return stamp.substr(0, 4) + "-" + stamp.substr(4, 2) + "-" + stamp.substr(6, 2) + " " +
         stamp.substr(9, 2) + ":" + stamp.substr(11, 2) + " UTC";
}

std::vector<Study> load_all(const std::vector<std::string>& names, const std::string& preset) {
  std::vector<Study> studies;
  for (const std::string& name : names) studies.push_back(load_study(name, preset));
  return studies;
}

/// Input of `taut report A B [STUDY...]`: the differences, and the contents of B.
report::ReportInput compared_folders(const PageRequest& options) {
  if (options.studies.size() < 2 || !Store::is_at(options.studies[1]))
    throw InputError("report " + options.studies[0] +
                     ": one results folder; --out shows it, a second one is compared with it");
  if (!options.output.empty()) test_writable(options.output);
  const Store a(options.studies[0]), b(options.studies[1]);
  std::vector<std::string> names(options.studies.begin() + 2, options.studies.end());
  std::string preset = options.preset;
  if (names.empty()) {
    const MainJob job = main_job();
    names = job.studies;
    if (preset.empty()) preset = job.preset;
  }
  report::ReportInput input = report::stored_anywhere(load_all(names, preset), b);
  input.differences = report::stored_differences(a, b);
  if (input.differences->pairs.empty())
    throw InputError("no case is in both " + options.studies[0] + " and " + options.studies[1]);
  input.question =
      "What differs between " + options.studies[0] + " and " + options.studies[1] + "?";
  input.title = options.studies[0] + " and " + options.studies[1];
  input.command = "./taut report " + options.studies[0] + " " + options.studies[1];
  input.solvers = introductions();
  input.vectors = to_string(widest());
  input.provenance = {{"program", program_digest().substr(0, 10)},
                      {"made", readable(utc_stamp())},
                      {"toolchain", std::string(toolchain())}};
  return input;
}

/// Adds the findings of other verbs with this build. Reports and leaves out answers that cannot be
/// read.
void add_findings(report::ReportInput& input, const Store& store, const std::string& program) {
  const auto add = [&](const char* verb, auto& to, const auto& stored) {
    try {
      to = stored(store, program);
    } catch (const InputError& error) {
      input.left_out.emplace_back(verb, error.what());
      std::cerr << "left out: " << error.what() << '\n';
    }
  };
  add("taut verify", input.truths, report::stored_truths);
  add("taut check", input.regressions, report::stored_regressions);
  add("taut converge", input.steps, report::stored_steps);
  add("taut require", input.required, report::stored_requirements);
  add("taut frontier --all", input.frontiers, report::stored_frontiers);
}

report::ReportInput input_of(PageRequest options) {
  if (!options.studies.empty() && Store::is_at(options.studies[0]))
    return compared_folders(options);
  if (options.studies.size() > 1 && Store::is_at(options.studies[1]))
    throw InputError(options.studies[0] + ": no results folder to compare with " +
                     options.studies[1]);
  const std::string command = command_of(options);
  std::vector<OtherScene> shown;
  for (const std::string& scene : options.films) shown.push_back({scene});
  if (options.studies.empty() && shown.empty())
    for (const std::string& scene : shipped("scenes"))
      if (is_drawn_unasked(scene)) shown.push_back({scene, true});
  std::vector<std::string> maps = options.studies;
  if (options.studies.empty()) {
    const MainJob job = main_job();
    options.studies = job.studies;
    maps = job.maps;
    if (options.preset.empty()) options.preset = job.preset;
  }
  if (!options.output.empty()) test_writable(options.output);
  const std::vector<Study> studies = load_all(options.studies, options.preset);
  const Store store(options.results);
  report::ReportInput input = report::stored_results(studies, store);
  if (!std::filesystem::exists(options.results))
    throw InputError("no results folder " + options.results + "; taut run makes it");
  const auto none = [](const report::StudyResult& study) { return study.records.empty(); };
  if (const std::size_t others = store.keys().size();
      others > 0 && std::ranges::all_of(input.studies, none))
    throw InputError(options.results + ": " + std::to_string(others) +
                     " cases are there, but this build would run none of them for " +
                     join(options.studies, ", ") + "; taut run " + join(studies, " ", study_words) +
                     " makes them" + where_else(studies.front(), store));
  report::add_stored_maps(input, load_all(maps, options.preset), store);
  for (const Study& study : studies)
    input.histories.push_back(
        history_of(store, study.name, read_tolerances(baselines_folder() / study.name)));
  input.command = command;
  input.solvers = introductions();
  input.vectors = to_string(widest());
  const std::string program = program_digest();
  if (studies.size() == 1) input.question = studies.front().question;
  input.provenance = {{"program", program.substr(0, 10)},
                      {"made", readable(utc_stamp())},
                      {"toolchain", std::string(toolchain())},
                      {"preset", options.preset}};
  if (options.preset.empty()) input.provenance.pop_back();
  add_findings(input, store, program);
  if (!options.model && options.media) {
    const auto tell = [countdown = Countdown("pictured scene")](const std::string& news,
                                                                std::size_t done, std::size_t all) {
      progress() << news << '\n';
      countdown(done, all);
    };
    add_films(input, shown, std::filesystem::path(options.results) / "films", tell);
  }
  return input;
}

}  // namespace

Page make_page(const PageRequest& request) {
  const report::ReportInput input = input_of(request);
  return {request.model ? report::make_model(input, 1) + "\n" : report::make_report(input),
          report::in_few_lines(input)};
}

}  // namespace taut
