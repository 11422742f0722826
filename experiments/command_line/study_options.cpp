#include "experiments/command_line/study_options.hpp"

#include <algorithm>
#include <set>

#include "core/model/text.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/report/plot/plot.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/read_all.hpp"

namespace taut {

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

void add_baseline_options(Arguments& args, BaselineOptions& options) {
  options = baseline_options();
  add_baselines(args, options.baselines);
  add_results(args, options.out);
  add_jobs(args, options.jobs);
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

}  // namespace taut
