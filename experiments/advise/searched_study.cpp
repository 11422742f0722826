#include "experiments/advise/searched_study.hpp"

#include <filesystem>

#include "experiments/advise/equal_search.hpp"
#include "experiments/answer/number.hpp"
#include "experiments/system/files.hpp"

namespace taut {

namespace {

/// Heading of a file of searched settings.
std::string heading(const Study& study, const std::string& metric, double cpu) {
  return "# Written by `taut advise --study " + study.name +
         (study.preset.empty() ? "" : " --preset " + study.preset) + " --cpu " + number_text(cpu) +
         "`: every solver's levers, searched scene by scene with " + number_text(cpu) +
         " s of CPU\n# time for each solver: half of it without accelerators that others lack, the "
         "rest with all. It began with what the file named best before. All that was tried, with "
         "its error (" +
         (metric.empty() ? std::string(kVerdict) : metric) +
         ")\n# and its cost by a few steps [CPU s per simulated s]. `plain` and `best`: errors for "
         "which it is the cheapest of its solver,\n# without accelerators and with them. "
         "These are what the study runs and times afresh.\n";
}

}  // namespace

Answer search_study(const Study& study, Store& store, const std::string& metric, double cpu,
                    const std::function<void(const std::string&)>& news) {
  if (study.searched.empty())
    throw InputError(study.file.string() + ": the study" +
                     (study.preset.empty() ? "" : "'s preset " + study.preset) +
                     " has no key 'searched': the file to write");
  store.prepare();
  Answer answer{"advise", "study " + study.name + ", every solver on every scene"};
  Table searched{"searched",
                 "what was searched",
                 {{"scene"},
                  {"solver"},
                  {"tried", "settings"},
                  {"cpu", "CPU time", kTime},
                  {"cut_off", "would have tried more"}}};
  std::vector<SearchedSetting> rows;
  std::vector<std::string> missing;
  search_equally(study, store, metric, cpu, [&](const EqualSearch& one) {
    news(one.scene + ", " + one.solver + ": " + std::to_string(one.rows.size()) + " settings, " +
         number_text(one.cpu) + " s of CPU");
    searched.rows.push_back({one.scene, one.solver, one.rows.size(), one.cpu, one.cut_off});
    rows.insert(rows.end(), one.rows.begin(), one.rows.end());
    missing.insert(missing.end(), one.missing.begin(), one.missing.end());
  });
  std::filesystem::create_directories(study.searched.parent_path());
  write_file(study.searched, searched_toml(heading(study, metric, cpu), rows, missing));
  answer.add({"file"}, study.searched.string());
  answer.add(std::move(searched));
  Table none{"missing", "no setting within an error", {{"why"}}};
  for (const std::string& one : missing) none.rows.push_back({one});
  answer.add(std::move(none));
  return answer;
}

std::vector<std::string> solvers_to_search() {
  std::vector<std::string> all;
  for (const SolverEntry* entry : all_solvers())
    if (entry->name != "external" && entry->name != "positions") all.emplace_back(entry->name);
  return all;
}

}  // namespace taut
