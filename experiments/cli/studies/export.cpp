#include <map>
#include <set>

#include "core/model/text.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/system/files.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut::verb::exporting {

namespace {

struct Options {
  std::string study, preset, results, output;
  bool json = false;
};

/// Numbers as they are, text safe for a spreadsheet.
std::string cell(const std::string& text) {
  return whole<double>(text) ? text : report::csv_field(text);
}

/// The value that a case has of a scene key, as typed in the study: the last assignment holds.
std::string axis_value(const CaseSpec& spec, const std::string& key) {
  std::string value;
  for (const std::string& text : spec.overrides)
    if (text.starts_with(key + "=")) value = text.substr(key.size() + 1);
  if (value.size() > 1 && value.front() == '"' && value.back() == '"')
    value = value.substr(1, value.size() - 2);
  return value;
}

/// What `taut bench STUDY` measured on one host, on this one if it did so here.
struct Costs {
  std::string host;
  std::map<std::string, BenchedCase> of;  ///< by the key of the case
};

Costs stored_costs(const Store& store, const Study& study) {
  Costs costs;
  std::vector<StudyBench> benches = stored_benches(store, study.name);
  if (benches.empty()) return costs;
  StudyBench& session = benches.front();
  costs.host = session.host;
  for (SceneBench& scene : session.scenes)
    for (BenchedCase& c : scene.cases)
      if (c.timing.failure.empty()) costs.of[c.record.key] = std::move(c);
  return costs;
}

/// One line a case; the names of the columns are the first.
class TidyTable {
 public:
  TidyTable(const StudyRecords& known, Costs costs) : costs_(std::move(costs)) {
    std::set<std::string> params;
    for (const Case& one : known.cases)
      for (const ParamSpec& spec : one.choice.entry->params) params.insert(std::string(spec.name));
    params_.assign(params.begin(), params.end());
    for (const StudyAxis& axis : known.study.axes)
      if (axis.of_scene()) axes_.push_back(axis.name);
    values_ = value_names();
    for (const Record& record : known.records) records_[record.key] = &record;
  }

  std::string csv(const std::vector<Case>& cases) const {
    std::string out = line(head());
    for (const Case& one : cases) out += line(row(one));
    return out;
  }
  /// A list of objects; a cell without a value is left out.
  Json json(const std::vector<Case>& cases) const {
    Json all = Json::array();
    const Cells names = head();
    for (const Case& one : cases) {
      const Cells cells = row(one);
      Json& object = all.emplace_back(Json::object());
      for (std::size_t i = 0; i < cells.size(); ++i)
        if (const auto number = whole<double>(cells[i]); number && names[i] != "key")
          object[names[i]] = *number;
        else if (!cells[i].empty())
          object[names[i]] = cells[i];
    }
    return all;
  }

 private:
  using Cells = std::vector<std::string>;
  Cells head() const {
    Cells head{"scene", "solver"};
    append(head, params_), append(head, axes_);
    append(head, {"dt", "steps", "vertices", "links", "status", "reason", "step"});
    append(head, values_);
    if (!costs_.of.empty())
      append(head, {"cpu.host", "cpu.per_second", "cpu.per_second.low", "cpu.per_second.high",
                    "memory.peak"});
    append(head, {"case", "key"});
    return head;
  }
  static void append(Cells& row, const Cells& more) {
    row.insert(row.end(), more.begin(), more.end());
  }
  static std::string line(const Cells& cells) { return join(cells, ",", cell) + "\n"; }

  Cells row(const Case& one) const {
    const auto at = records_.find(one.key);
    const Record* record = at == records_.end() ? nullptr : at->second;
    const auto specs = one.choice.params.specs();
    Cells cells{one.scene->name, std::string(one.choice.entry->name)};
    for (const std::string& name : params_) {
      const bool has = std::ranges::find(specs, name, &ParamSpec::name) != specs.end();
      cells.push_back(has ? std::string(one.choice.params.value(name)) : "");
    }
    for (const std::string& name : axes_) cells.push_back(axis_value(one.spec, name));
    const Status status = record ? record->status : Status{};
    append(cells, {report::exact(one.scene->dt), std::to_string(one.scene->steps),
                   std::to_string(one.scene->mesh.size()), std::to_string(one.scene->links.size()),
                   record ? std::string(to_string(status.kind)) : "not run", status.reason,
                   status.step < 0 ? "" : std::to_string(status.step)});
    for (const std::string& name : values_) {
      const bool has = record && record->values.contains(name);
      cells.push_back(has ? report::exact(record->values.at(name)) : "");
    }
    const auto cost = costs_.of.find(one.key);
    if (cost != costs_.of.end()) {
      const Interval cpu = cost->second.cost();
      append(cells, {costs_.host, report::exact(cpu.mid), report::exact(cpu.low),
                     report::exact(cpu.high), std::to_string(cost->second.timing.peak_bytes)});
    } else if (!costs_.of.empty()) {
      cells.resize(cells.size() + 5);
    }
    append(cells, {one.id, one.key});
    return cells;
  }

  Costs costs_;
  std::map<std::string, const Record*> records_;
  std::vector<std::string> params_, axes_, values_;
};

int run(const Options& options) {
  const Study study = load_study(options.study, options.preset);
  const Store store(options.results);
  const StudyRecords known = collect(study, store);
  if (known.records.empty())
    throw InputError("none of the " + std::to_string(known.cases.size()) + " cases of study '" +
                     study.name + "' is in " + options.results +
                     " as this build would run them; taut run makes them");
  const TidyTable table(known, stored_costs(store, study));
  const std::string text =
      options.json ? to_text(table.json(known.cases), 1) + "\n" : table.csv(known.cases);
  if (options.output.empty()) {
    std::cout << text;
  } else {
    write_durably(options.output, text);
    std::cout << options.output << '\n';
  }
  const std::size_t missing = known.cases.size() - known.records.size();
  if (missing > 0) progress() << missing << " cases were not run\n";
  return missing > 0 ? kIncomplete : kPass;
}

void add_options(CLI::App& app, Options& options) {
  app.add_option("STUDY", options.study, "Name or path of a study that was run")->required();
  add_stored(app, options.preset, options.results);
  add_output(app, options.output, "File (default: standard output)");
  add_json(app, options.json, "The same rows");
}

}  // namespace
}  // namespace taut::verb::exporting

TAUT_VERB(export) = {
    .name = "export",
    .group = VerbGroup::studies,
    .summary = "Writes a study as a tidy CSV: a row a case, SI units, costs",
    .example = R"(taut export iterations --preset quick -o x.csv
Python:
  import pandas
  cases = pandas.read_csv("x.csv").query("status == 'ok'")
  print(cases.pivot_table("stretch.rms", ["scene", "iterations"], "solver"))
R:
  cases <- read.csv("x.csv", check.names = FALSE)
  ok <- subset(cases, status == "ok")
  print(aggregate(ok["stretch.rms"], ok[c("scene", "solver", "iterations")], mean))
Exit: 0 every case is there; 3 some were not run (their status says so))",
    .bind = taut::bind_verb<taut::verb::exporting::add_options, taut::verb::exporting::run>};
