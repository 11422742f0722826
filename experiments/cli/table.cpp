#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>

#include "core/model/input_error.hpp"
#include "experiments/command_line/invoke.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/system/json.hpp"

namespace taut::verb::table {

namespace {

struct Options {
  std::string study, preset, out = default_results();
  std::vector<std::string> values;
  bool json = false;
};

/// What tells the cases of one scene apart: "jakobsen:iterations=4 dt=1/120".
std::string setting_of(const Case& one, const Study& study) {
  std::string text = one.choice.brief();
  for (const std::string& change : one.spec.overrides)
    if (std::ranges::find(study.settings, change) == study.settings.end()) text += " " + change;
  return text;
}

std::string cell(const Record& record, const std::string& value) {
  if (record.status.kind != Status::Kind::ok && record.status.kind != Status::Kind::unsettled)
    return std::string(to_string(record.status.kind));
  const auto at = record.values.find(value);
  if (at == record.values.end() || std::isnan(at->second)) return "-";
  std::ostringstream text;
  text << std::setprecision(3) << at->second
       << (record.status.kind == Status::Kind::unsettled ? " ~" : "");
  return text.str();
}

/// Rows and columns in the order in which they first come.
struct Table {
  std::vector<std::string> settings, scenes;
  std::map<std::pair<std::string, std::string>, Record> records;  ///< [setting, scene]
};

Table run_all(const Study& study, const Store& store) {
  Table table;
  const auto add = [](std::vector<std::string>& names, const std::string& name) {
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  };
  for (const Case& one : cases_of(study)) {
    const std::string setting = setting_of(one, study);
    add(table.settings, setting), add(table.scenes, one.scene->name);
    table.records[{setting, one.scene->name}] = run_stored(one, store);
  }
  return table;
}

void print(const Table& table, const std::string& value) {
  std::size_t width = value.size();
  for (const std::string& setting : table.settings) width = std::max(width, setting.size());
  const auto first = static_cast<int>(width + 2);
  std::cout << std::left << std::setw(first) << value;
  for (const std::string& scene : table.scenes) std::cout << std::setw(14) << scene;
  for (const std::string& setting : table.settings) {
    std::cout << '\n' << std::setw(first) << setting;
    for (const std::string& scene : table.scenes) {
      const auto at = table.records.find({setting, scene});
      std::cout << std::setw(14) << (at == table.records.end() ? "" : cell(at->second, value));
    }
  }
  std::cout << "\n\n";
}

Json json_of(const Table& table, const std::vector<std::string>& values) {
  Json all = Json::array();
  for (const auto& [where, record] : table.records) {
    Json row{{"setting", where.first},
             {"scene", where.second},
             {"status", to_string(record.status.kind)}};
    for (const std::string& value : values)
      if (const auto at = record.values.find(value); at != record.values.end())
        row["values"][value] = at->second;  // NaN becomes null
    all.push_back(std::move(row));
  }
  return all;
}

int run(Options options) {
  const Study study = load_study(options.study, options.preset);
  if (options.values.empty())
    for (const Plot& plot : study.plots)
      if (const auto y = plot.options.find("y");
          y != plot.options.end() &&
          std::ranges::find(options.values, y->second) == options.values.end())
        options.values.push_back(y->second);
  if (options.values.empty())
    throw InputError("study '" + study.name + "' asks for no plot; use --value");
  std::vector<std::string> words{options.study, "--no-report", "--out", options.out};
  if (!options.preset.empty()) words.insert(words.end(), {"--preset", options.preset});
  std::ostringstream swallowed;  // where it put its results
  std::streambuf* const out = std::cout.rdbuf(swallowed.rdbuf());
  const int code = invoke("run", words);
  std::cout.rdbuf(out);
  if (code != kPass) return code;
  const Table table = run_all(study, Store(options.out));
  if (options.json) {
    std::cout << to_text(json_of(table, options.values), 1) << '\n';
    return kPass;
  }
  for (const std::string& value : options.values) print(table, value);
  std::cout << "~: unsettled\n";
  return kPass;
}

std::function<int()> bind(Arguments& arguments) {
  const auto o = std::make_shared<Options>();
  arguments.option("STUDY", o->study, "Name or path of a study").required();
  arguments.option("--preset", o->preset, "A smaller or larger version that the study defines");
  arguments.option("--value", o->values,
                   "A metric's value; repeat it for each (default: what the study's plots show)");
  arguments.option("--out", o->out, "Results folder (default: " + o->out + ")");
  arguments.flag("--json", o->json, "Every case's values as JSON");
  return [o] { return run(*o); };
}

}  // namespace
}  // namespace taut::verb::table

TAUT_VERB(table) = {
    .name = "table",
    .summary = "Runs a study as far as it was not yet and prints its values, settings x scenes",
    .example =
        "taut table default-setting\n  taut table iterations --preset orders --value "
        "stretch.rms",
    .bind = taut::verb::table::bind};
