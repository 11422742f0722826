#include "experiments/timing/study_csv.hpp"

#include <utility>
#include <vector>

#include "core/io/text_file.hpp"
#include "core/model/text.hpp"
#include "experiments/answer/answer.hpp"
#include "experiments/results/database.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut {

namespace {

using Cells = std::vector<std::string>;

/// Columns of costs, in the order of their table and of the file.
const Cells& cost_columns() {
  static const Cells kColumns{"cpu.host", kCpuPerSecond, kCpuPerSecond + std::string(".low"),
                              kCpuPerSecond + std::string(".high"), kPeakMemory};
  return kColumns;
}

/// A line of CSV. Numbers stay as they are; texts are made safe for spreadsheets.
std::string line(const Cells& cells) {
  const auto field = [](const std::string& s) { return whole<double>(s) ? s : csv_field(s); };
  return join(cells, ",", field) + "\n";
}

/// A text as an SQL literal.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "''" : std::string(1, c);
  return out + "'";
}

std::int64_t count(Database& database, const std::string& of) {
  return database.number_of("SELECT count(*) " + of);
}

Cells list(Database& database, const std::string& sql) {
  Cells all;
  Database::Rows row = database.rows(sql);
  while (row.next()) all.push_back(row.text(0));
  return all;
}

std::string all(Database& database, const std::string& sql, const Cells& names) {
  std::string text = line(names);
  Database::Rows row = database.rows(sql);
  for (Cells cells(names.size()); row.next(); text += line(cells))
    for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = row.exact_text(static_cast<int>(i));
  return text;
}

}  // namespace

/// Creates a table `asked` of the study's cases (case_id is NULL if there is no sound result), and
/// a table `timed` of their costs.
StudyCsv::StudyCsv(const Study& study, const Store& store) : database_(*store.reading()) {
  database_.script(
      "CREATE TEMP TABLE asked (place INTEGER PRIMARY KEY, key, id, scene, solver, case_id, "
      "absent);"
      "CREATE TEMP TABLE timed (key PRIMARY KEY, " +
      join(cost_columns(), ", ", quoted) + ")");
  each_case(study, [&](Case&& one) {
    const bool sound = store.find(one).has_value();
    database_.run(
        "INSERT INTO asked (key, id, scene, solver, case_id, absent) SELECT ?1, ?2, ?3, ?4, "
        "iif(?5, case_id, NULL), iif(case_id IS NULL, 'not run', 'damaged') "
        "FROM (SELECT 1) LEFT JOIN cases ON cases.key = ?1",
        one.key, one.id, one.scene->name, std::string(one.choice.entry->name),
        static_cast<int>(sound));
  });
  const std::vector<StudyBench> benches = stored_benches(store, study.name);
  if (benches.empty()) return;
  for (const SceneBench& scene : benches.front().scenes)
    for (const BenchedCase& c : scene.cases)
      if (const Interval cost = c.cost(); c.timing.failure.empty())
        database_.run("INSERT INTO timed VALUES (?, ?, ?, ?, ?, ?)", c.record.key,
                      benches.front().host, cost.mid, cost.low, cost.high, c.timing.peak_bytes);
}

std::int64_t StudyCsv::stored() { return count(database_, "FROM asked WHERE case_id IS NOT NULL"); }
std::int64_t StudyCsv::damaged() {
  return count(database_, "FROM asked WHERE case_id IS NULL AND absent = 'damaged'");
}
std::int64_t StudyCsv::not_run() {
  return count(database_, "FROM asked WHERE case_id IS NULL") - damaged();
}

std::string StudyCsv::wide() {
  Cells names{"scene", "solver"}, columns{"asked.scene", "asked.solver"};
  const auto add = [&](const std::string& name, const std::string& column) {
    names.push_back(name);
    columns.push_back(column);
  };
  for (const std::string& name : list(database_,
                                      "SELECT DISTINCT value.key FROM asked JOIN cases USING "
                                      "(case_id), json_each(parameters) AS value ORDER BY 1"))
    add(name, "parameters ->> " + quoted("$.\"" + name + "\""));
  for (const std::string& name :
       list(database_,
            "SELECT DISTINCT substr(value, 1, instr(value, '=') - 1) FROM asked JOIN cases USING "
            "(case_id), json_each(settings) ORDER BY 1"))
    add(name,
        "(SELECT trim(substr(value, instr(value, '=') + 1), '\"') FROM json_each(settings) "
        "WHERE substr(value, 1, instr(value, '=')) = " +
            quoted(name + "=") + " ORDER BY json_each.key DESC LIMIT 1)");
  for (const char* name : {"dt", "steps", "vertices", "links"}) add(name, name);
  add("status", "coalesce(status, absent)");
  add("reason", "reason");
  add("step", "step");
  Database::Rows metric = database_.rows("SELECT name, metric_id FROM metrics ORDER BY name");
  while (metric.next())
    add(metric.text(0),
        "(SELECT value FROM numbers WHERE case_id = asked.case_id AND metric_id = " +
            metric.text(1) + ")");
  if (count(database_, "FROM timed") > 0)
    for (const std::string& name : cost_columns()) add(name, "timed.\"" + name + "\"");
  add("case", "asked.id");
  add("key", "asked.key");
  return all(
      database_,
      "SELECT " + join(columns, ", ") +
          " FROM asked LEFT JOIN cases USING (case_id) LEFT JOIN timed ON timed.key = asked.key "
          "ORDER BY place",
      names);
}

std::string StudyCsv::tidy() {
  return all(
      database_,
      "SELECT asked.scene, asked.solver, asked.id, metrics.name, value, metrics.unit, "
      "coalesce(status, absent), asked.key FROM asked CROSS JOIN metrics LEFT JOIN cases "
      "USING (case_id) LEFT JOIN numbers USING (case_id, metric_id) ORDER BY place, metric_id",
      {"scene", "solver", "case", "metric", "value", "unit", "status", "key"});
}

std::string StudyCsv::series() {
  return all(
      database_,
      "SELECT asked.scene, asked.solver, asked.id, json_extract(columns, '$.t[' || point.key || "
      "']'), line.key, point.value, asked.key FROM asked JOIN series "
      "USING (case_id), json_each(columns) AS line, json_each(line.value) AS point "
      "WHERE line.key NOT IN ('step', 't') ORDER BY place, line.key, point.key",
      {"scene", "solver", "case", "t", "metric", "value", "key"});
}

}  // namespace taut
