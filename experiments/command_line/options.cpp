#include "experiments/command_line/options.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <thread>

#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/report/plot/plot.hpp"
#include "experiments/results/store.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/own_words.hpp"
#include "experiments/system/process.hpp"

namespace taut {

CLI::Validator above_zero() {
  return CLI::Validator(
      [](std::string& text) {
        double value = 0;
        const bool number = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
        return number && value > 0 ? "" : "'" + text + "' is not a number above 0";
      },
      "above 0");
}

CLI::Validator above_zero_seconds() {
  return CLI::Validator(
      [](std::string& text) {
        double value = 0;
        const bool number = CLI::detail::lexical_cast(text, value);
        return number && value > 0 && value <= kLongestSeconds
                   ? ""
                   : "'" + text + "' is not a number above 0, at most " + as_typed(kLongestSeconds);
      },
      "above 0");
}

CLI::Validator known(const std::string& what, std::vector<std::string> names) {
  return CLI::Validator(
      [what, names = std::move(names)](std::string& text) {
        if (std::ranges::find(names, text) != names.end()) return std::string();
        return "unknown " + what + " '" + text + "'" + suggestion(text, names) +
               (names.size() < 12 ? " (one of " + join(names, ", ") + ")" : "");
      },
      "");
}

CLI::Validator metric_value() { return known("metric value", value_names()); }

CLI::Option* add_jobs(CLI::App& app, int& jobs) {
  jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  return app.add_option("-j,--jobs", jobs, "Cases at a time (default: one per core)")
      ->check(CLI::Range(1, 1024));
}

CLI::Option* add_results(CLI::App& app, std::string& folder) {
  folder = default_results().string();
  return app.add_option("--out", folder, "Results folder (default: " + folder + ")");
}

CLI::Option* add_preset(CLI::App& app, std::string& preset) {
  return app.add_option("--preset", preset, "A smaller or larger version that the study defines");
}

/// Throws InputError that names both settings if two of a scene have the same key.
static void refuse_same_key(const SceneSettings& settings) {
  std::map<std::string, std::string> by_key;
  for (const SceneSetting& one : settings)
    if (const auto [at, is_new] = by_key.emplace(one.key(), one.written()); !is_new)
      throw InputError("'" + at->second + "' and '" + one.written() + "' both set " + one.key() +
                       ": leave out one of them");
}

CLI::Option* add_settings(CLI::App& app, SceneSettings& settings) {
  app.add_option_function<std::string>(
      "--fabric",
      [&settings](const std::string& name) { settings.emplace_back("fabric", '"' + name + '"'); },
      "Mass and bending stiffness of a measured fabric in place of the scene's (taut list "
      "fabrics)");
  return app
      .add_option_function<std::vector<std::string>>(
          own_words::kSet,
          // added to the setting of --fabric
          [&settings](const std::vector<std::string>& all) {
            settings.insert(settings.end(), all.begin(), all.end());
            refuse_same_key(settings);
          },
          "Replace a key of the scene, e.g. 'cloth.grid=[16, 16]'; repeat it for each")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

CLI::Option* add_scene(CLI::App& app, std::string& scene) {
  return app.add_option("SCENE", scene, "Name of a shipped scene, or a path");
}

CLI::Option* add_study(CLI::App& app, std::string& study) {
  return app.add_option("STUDY", study, "Name of a shipped study, or a path");
}

CLI::Option* add_solvers(CLI::App& app, std::vector<std::string>& solvers,
                         const std::string& what) {
  return app.add_option("--solver", solvers, what + "; repeat it for each")
      ->allow_extra_args(false);
}

void add_record(CLI::App& app, bool& record) {
  app.add_flag("--record", record, "Also keep what is found for the report");
}

void add_limits(CLI::App& app, Limits& limits) {
  app.add_option("--timeout", limits.seconds,
                 "CPU time limit of a case [s] (default: " + as_typed(limits.seconds) +
                     "); wall time: " + as_typed(kWallPerCpu) + " times that")
      ->check(above_zero_seconds());
  const auto set = [&limits](double mb) { limits.bytes = static_cast<std::size_t>(mb) << 20; };
  app.add_option_function<double>(
         "--memory", set,
         "Memory limit of a case [MB] (default: " + std::to_string(limits.bytes >> 20) + ")")
      ->check(CLI::Range(64.0, 1e9));
}

void add_stored(CLI::App& app, std::string& preset, std::string& results) {
  app.add_option("--preset", preset, "The preset under which it was run");
  add_results(app, results);
}

CLI::Option* add_output(CLI::App& app, std::string& path, const std::string& what) {
  return app.add_option("-o,--output", path, what);
}

void add_samples(CLI::App& app, int& rounds, double& seconds, int fewest_rounds) {
  app.add_option("--rounds", rounds,
                 "Rounds in alternating order (ABBA), two samples each (default: " +
                     std::to_string(rounds) + ")")
      ->check(CLI::Range(fewest_rounds, 1000));
  app.add_option("--seconds", seconds,
                 "CPU time of one sample (default: " + as_typed(seconds) + ")")
      ->check(above_zero_seconds());
}

void add_judgement(CLI::App& app, std::string& metric, double& tolerance) {
  app.add_option(
         "--metric", metric,
         "What the error is (default: where the cloth is and how stretched, motion.error; RMS "
         "stretch where no reference says where it should be)")
      ->check(metric_value());
  app.add_option("--tolerance", tolerance,
                 "Smaller relative differences do not count (default: " + as_typed(tolerance) + ")")
      ->check(above_zero());
}

void add_baselines(CLI::App& app, std::string& folder) {
  folder = results_folder() / "baselines";
  app.add_option("--baselines", folder, "Folder of the baselines (default: " + folder + ")");
}

BaselineOptions baseline_options() {
  BaselineOptions options;
  options.run = [](const std::vector<StudyCases>& studies, Store& store, const std::string& command,
                   const CampaignOptions& campaign) {
    return run_missing(studies, store, command, campaign);
  };
  options.say = [](const std::string& news) { progress() << news << '\n'; };
  options.title = [](const std::string& value) {
    const ValueSpec* spec = find_value(value).second;
    return spec && spec->role != Role::none ? report::quantity(value).title : "";
  };
  return options;
}

void add_baseline_options(CLI::App& app, BaselineOptions& options) {
  options = baseline_options();
  add_baselines(app, options.baselines);
  add_results(app, options.out);
  add_jobs(app, options.jobs);
}

void add_format(CLI::App& app, Format& format, const char* details) {
  auto* json =
      app.add_flag(own_words::kJson, format.json, "Print it as JSON: numbers in SI, every table");
  auto* csv = app.add_flag("--csv", format.csv,
                           "Print the first table as CSV; --csv=NAME another one, --csv=facts what "
                           "stands above the tables");
  auto* markdown = app.add_flag("--markdown", format.markdown, "Print it as Markdown");
  json->excludes(csv)->excludes(markdown);
  csv->excludes(markdown);
  if (details) app.add_flag("--all", format.details, details);
}

CLI::Option* add_json(CLI::App& app, bool& json, const std::string& what) {
  return app.add_flag("--json", json, "Print " + what + " as JSON");
}

Study load_study_to_plot(const std::string& name, const std::string& preset) {
  Study study = load_study(name, preset);
  std::vector<Diagnostic> wrong;
  std::vector<std::string> known = report::quantity_names();
  known.emplace_back("setting");
  for (const StudyAxis& axis : study.axes) known.push_back(axis.name);
  const auto report = [&](std::size_t i, const char* key, const std::string& text) {
    const SourceLocation& place = study.plots[i].places.at(key);
    wrong.push_back({study.file, place.line, place.column, text});
  };
  for (std::size_t i = 0; i < study.plots.size(); ++i) {
    try {
      report::find_plot_kind(study.plots[i].kind);
    } catch (const InputError& error) {
      report(i, "kind", error.diagnostics().front().text());
    }
    for (const char* axis : {"x", "y", "along"})
      if (const auto at = study.plots[i].options.find(axis);
          at != study.plots[i].options.end() && std::ranges::count(known, at->second) == 0)
        report(i, axis,
               "unknown value '" + at->second + "'" + suggestion(at->second, known) +
                   " (`taut list metrics`)");
  }
  if (!wrong.empty()) throw InputError(wrong);
  return study;
}

std::vector<Study> load_studies_to_plot(const std::vector<std::string>& names,
                                        const std::string& preset,
                                        const std::vector<std::string>& steps) {
  std::vector<Study> studies;
  read_all(names, [&](const std::string& name) {
    studies.push_back(at_time_steps(load_study_to_plot(name, preset), steps));
  });
  return studies;
}

std::vector<StudyCases> cases_of_each(const std::vector<Study>& studies) {
  std::vector<StudyCases> all;
  read_all(studies, [&](const Study& study) { all.push_back({study.name, cases_of(study)}); });
  return all;
}

std::string study_words(const Study& study) {
  const std::vector<std::string> known = shipped("studies");
  const bool is_shipped = std::ranges::find(known, study.name) != known.end();
  return shell_word(is_shipped ? study.name : study.file.string()) +
         (study.preset.empty() ? "" : " --preset " + study.preset);
}

std::string where_else(const Study& study, const Store& store) {
  const std::vector<std::string> stored = store.keys();
  const std::set<std::string> keys(stored.begin(), stored.end());
  std::vector<std::string> presets = study.presets;
  presets.insert(presets.begin(), "");
  std::vector<std::string> whole;
  for (const std::string& preset : presets) {
    if (preset == study.preset) continue;
    bool all = true;
    each_case(load_study(study.file.string(), preset),
              [&](Case&& one) { all = all && keys.contains(one.key); });
    if (all) whole.push_back(preset);
  }
  if (whole.empty()) return "";
  if (whole.front().empty()) return "; without --preset all results are there";
  return "; preset " + whole.front() + " has all of its results: --preset " + whole.front();
}

void check_solvers(const std::vector<std::string>& texts) {
  read_all(texts, [](const std::string& text) { parse_solver(text); });
}

void tell_remarks(const std::vector<std::string>& remarks) {
  for (const std::string& remark : remarks) progress() << remark << '\n';
}

void SceneChanges::bind(CLI::App& app) {
  app.add_option("--dt", dt_, "Time step [s], a number or a fraction such as 1/120");
  app.add_option("--duration", duration_, "Simulated time [s]");
  add_settings(app, settings_);
}

SceneSettings SceneChanges::settings() const {
  SceneSettings all = settings_;
  if (!dt_.empty()) all.emplace_back("time.dt", '"' + dt_ + '"');
  if (!duration_.empty()) all.emplace_back("time.duration", '"' + duration_ + '"');
  refuse_same_key(all);
  return all;
}

void CaseOptions::bind(CLI::App& app) {
  add_scene(app, scene_)->required();
  app.add_option("SOLVER", solver_, "NAME or NAME:key=value,... (taut list solvers)")->required();
  changes_.bind(app);
}

CaseSpec CaseOptions::spec() const { return {scene_, changes_.settings(), solver_}; }

Case CaseOptions::make() const { return make_case(spec()); }

void continue_in_right_program(const SolverChoice& choice) {
  const std::string needed(choice.entry->program ? choice.entry->program(choice.params) : "");
  if (needed.empty() || needed == this_program().filename()) return;
  std::vector<std::string> words = typed_words();
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const std::string program = sibling_program(needed);
  execv(program.c_str(), argv.data());
  throw InputError(choice.brief() + " needs the program " + program + ", which cannot be run");
}

double error_of(const std::string& text, const Unit& of) {
  std::size_t used = 0;
  double value = 0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  const std::string unit = text.substr(used);
  if (used == 0 || !(unit.empty() || unit == "%") || !(std::isfinite(value) && value > 0))
    throw InputError("--error " + text + ": expected a number above 0 such as 0.01 or 1%");
  if (unit.empty() && of.kind == Unit::Kind::share && value >= 1)
    throw InputError("--error " + text + ": " + text + "% or " + number_text(100 * value) +
                     "%? a share of 1 or more needs its sign");
  return unit == "%" ? value / 100 : value;
}

std::vector<std::string> typed_words() {
  std::ifstream in("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> words;
  for (std::string word; std::getline(in, word, '\0');) words.push_back(word);
  return words;
}

std::string typed_command() {
  std::vector<std::string> words = typed_words();
  if (!words.empty()) words[0] = std::filesystem::path(words[0]).filename();
  return printable(join(words, " ", shell_word));
}

}  // namespace taut
