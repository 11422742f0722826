#include "experiments/command_line/options.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <thread>

#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/own_words.hpp"
#include "experiments/system/process.hpp"
#include "experiments/system/read_all.hpp"

namespace taut {

Argument& add_jobs(Arguments& args, int& jobs) {
  jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  return args.add_option("-j,--jobs", jobs, "Cases at a time (default: one per core)")
      .check(in_range(1, 1024));
}

Argument& add_results(Arguments& args, std::string& folder) {
  folder = default_results().string();
  return args.add_option("--out", folder, "Results folder (default: " + folder + ")");
}

Argument& add_preset(Arguments& args, std::string& preset) {
  return args.add_option("--preset", preset, "A smaller or larger version that the study defines");
}

/// Throws InputError that names both settings if two of a scene have the same key.
static void refuse_same_key(const SceneSettings& settings) {
  std::map<std::string, std::string> by_key;
  for (const SceneSetting& one : settings)
    if (const auto [at, is_new] = by_key.emplace(one.key(), one.written()); !is_new)
      throw InputError("'" + at->second + "' and '" + one.written() + "' both set " + one.key() +
                       ": leave out one of them");
}

Argument& add_settings(Arguments& args, SceneSettings& settings) {
  args.add_option(
      "--fabric",
      [&settings](const std::string& name) { settings.emplace_back("fabric", '"' + name + '"'); },
      "Mass and bending stiffness of a measured fabric in place of the scene's (taut list "
      "fabrics)");
  return args
      .add_option(
          own_words::kSet,
          // added to the setting of --fabric
          [&settings](const std::vector<std::string>& all) {
            settings.insert(settings.end(), all.begin(), all.end());
            refuse_same_key(settings);
          },
          "Replace a key of the scene, e.g. 'cloth.grid=[16, 16]'; repeat it for each")
      .repeated();
}

Argument& add_scene(Arguments& args, std::string& scene) {
  return args.add_option("SCENE", scene, "Name of a shipped scene, or a path");
}

Argument& add_study(Arguments& args, std::string& study) {
  return args.add_option("STUDY", study, "Name of a shipped study, or a path");
}

Argument& add_solvers(Arguments& args, std::vector<std::string>& solvers, const std::string& what) {
  return args.add_option("--solver", solvers, what + "; repeat it for each").one_each();
}

void add_record(Arguments& args, bool& record) {
  args.add_flag("--record", record, "Also keep what is found for the report");
}

void add_limits(Arguments& args, Limits& limits) {
  args.add_option("--timeout", limits.seconds,
                  "CPU time limit of a case [s] (default: " + as_typed(limits.seconds) +
                      "); wall time: " + as_typed(kWallPerCpu) + " times that")
      .check(above_zero_seconds());
  const auto set = [&limits](double mb) { limits.bytes = static_cast<std::size_t>(mb) << 20; };
  args.add_option(
          "--memory", set,
          "Memory limit of a case [MB] (default: " + std::to_string(limits.bytes >> 20) + ")")
      .check(in_range(64.0, 1e9));
}

void add_stored(Arguments& args, std::string& preset, std::string& results) {
  args.add_option("--preset", preset, "The preset under which it was run");
  add_results(args, results);
}

Argument& add_output(Arguments& args, std::string& path, const std::string& what) {
  return args.add_option("-o,--output", path, what);
}

void add_samples(Arguments& args, int& rounds, double& seconds, int fewest_rounds) {
  args.add_option("--rounds", rounds,
                  "Rounds in alternating order (ABBA), two samples each (default: " +
                      std::to_string(rounds) + ")")
      .check(in_range(fewest_rounds, 1000));
  args.add_option("--seconds", seconds,
                  "CPU time of one sample (default: " + as_typed(seconds) + ")")
      .check(above_zero_seconds());
}

void add_judgement(Arguments& args, std::string& metric, double& tolerance) {
  args.add_option(
          "--metric", metric,
          "What the error is (default: where the cloth is and how stretched, motion.error; RMS "
          "stretch where no reference says where it should be)")
      .check(metric_value());
  args.add_option(
          "--tolerance", tolerance,
          "Smaller relative differences do not count (default: " + as_typed(tolerance) + ")")
      .check(above_zero());
}

void add_baselines(Arguments& args, std::string& folder) {
  folder = baselines_folder();
  args.add_option("--baselines", folder, "Folder of the baselines (default: " + folder + ")");
}

void add_format(Arguments& args, Format& format, const char* details) {
  args.add_flag(own_words::kJson, format.json, "Print it as JSON: numbers in SI, every table")
      .excludes("--csv")
      .excludes("--markdown");
  args.add_flag("--csv", format.csv,
                "Print the first table as CSV; --csv=NAME another one, --csv=facts what "
                "stands above the tables")
      .excludes("--markdown");
  args.add_flag("--markdown", format.markdown, "Print it as Markdown");
  if (details) args.add_flag("--all", format.details, details);
}

Argument& add_json(Arguments& args, bool& json, const std::string& what) {
  return args.add_flag("--json", json, "Print " + what + " as JSON");
}

void check_solvers(const std::vector<std::string>& texts) {
  read_all(texts, [](const std::string& text) { parse_solver(text); });
}

void tell_remarks(const std::vector<std::string>& remarks) {
  for (const std::string& remark : remarks) progress() << remark << '\n';
}

void SceneChanges::bind(Arguments& args) {
  args.add_option("--dt", dt_, "Time step [s], a number or a fraction such as 1/120");
  args.add_option("--duration", duration_, "Simulated time [s]");
  add_settings(args, settings_);
}

SceneSettings SceneChanges::settings() const {
  SceneSettings all = settings_;
  if (!dt_.empty()) all.emplace_back("time.dt", '"' + dt_ + '"');
  if (!duration_.empty()) all.emplace_back("time.duration", '"' + duration_ + '"');
  refuse_same_key(all);
  return all;
}

void CaseOptions::bind(Arguments& args) {
  add_scene(args, scene_).required();
  args.add_option("SOLVER", solver_, "NAME or NAME:key=value,... (taut list solvers)").required();
  changes_.bind(args);
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
  std::string_view unit = text;
  const double value = take_number(unit).value_or(0);
  if (!(unit.empty() || unit == "%") || !(std::isfinite(value) && value > 0))
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
