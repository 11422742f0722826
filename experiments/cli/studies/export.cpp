#include "core/model/text.hpp"
#include "experiments/answer/answer.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/results/database.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/system/files.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut::verb::exporting {

namespace {

using Cells = std::vector<std::string>;

struct Options {
  std::string study, preset, results, output;
  bool tidy = false, series = false;
};

/// A line of CSV: numbers as they are, texts safe for a spreadsheet.
std::string line(const Cells& cells) {
  const auto field = [](const std::string& s) { return whole<double>(s) ? s : csv_field(s); };
  return join(cells, ",", field) + "\n";
}

/// A text of SQL.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "''" : std::string(1, c);
  return out + "'";
}

/// The results file with a table `asked` of the study's cases, as this build would run them (its
/// case_id is NULL if it is not stored or does not match its digest, which is said), and `timed` of
/// what they cost here or, if nothing was timed here, on another host.
class Asked {
 public:
  Asked(const Study& study, const Store& store) : database_(*store.reading()) {
    database_.script(
        "CREATE TEMP TABLE asked (place INTEGER PRIMARY KEY, key, id, scene, solver, case_id, "
        "absent);"
        "CREATE TEMP TABLE timed (key PRIMARY KEY, 'cpu.host', 'cpu.per_second', "
        "'cpu.per_second.low', 'cpu.per_second.high', 'memory.peak')");
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
  std::int64_t count(const std::string& of) { return database_.number_of("SELECT count(*) " + of); }

  /// A row a case: what it was asked for, how it ended, every value, what it cost.
  std::string wide() {
    Cells names{"scene", "solver"}, columns{"asked.scene", "asked.solver"};
    const auto add = [&](const std::string& name, const std::string& column) {
      names.push_back(name), columns.push_back(column);
    };
    for (const std::string& name : list("SELECT DISTINCT value.key FROM asked JOIN cases USING "
                                        "(case_id), json_each(parameters) AS value ORDER BY 1"))
      add(name, "parameters ->> " + quoted("$.\"" + name + "\""));
    for (const std::string& name :
         list("SELECT DISTINCT substr(value, 1, instr(value, '=') - 1) FROM asked JOIN cases USING "
              "(case_id), json_each(settings) ORDER BY 1"))
      add(name,
          "(SELECT trim(substr(value, instr(value, '=') + 1), '\"') FROM json_each(settings) "
          "WHERE substr(value, 1, instr(value, '=')) = " +
              quoted(name + "=") + " ORDER BY json_each.key DESC LIMIT 1)");
    for (const char* name : {"dt", "steps", "vertices", "links"}) add(name, name);
    add("status", "coalesce(status, absent)"), add("reason", "reason"), add("step", "step");
    Database::Rows metric = database_.rows("SELECT name, metric_id FROM metrics ORDER BY name");
    while (metric.next())
      add(metric.text(0),
          "(SELECT value FROM numbers WHERE case_id = asked.case_id AND metric_id = " +
              metric.text(1) + ")");
    if (count("FROM timed") > 0)
      for (const std::string name : {"cpu.host", "cpu.per_second", "cpu.per_second.low",
                                     "cpu.per_second.high", "memory.peak"})
        add(name, "timed.\"" + name + "\"");
    add("case", "asked.id"), add("key", "asked.key");
    return all(
        "SELECT " + join(columns, ", ") +
            " FROM asked LEFT JOIN cases USING (case_id) LEFT JOIN timed ON timed.key = asked.key "
            "ORDER BY place",
        names);
  }

  /// A row for each value of each case.
  std::string tidy() {
    return all(
        "SELECT asked.scene, asked.solver, asked.id, metrics.name, value, metrics.unit, "
        "coalesce(status, absent), asked.key FROM asked CROSS JOIN metrics LEFT JOIN cases "
        "USING (case_id) LEFT JOIN numbers USING (case_id, metric_id) ORDER BY place, metric_id",
        {"scene", "solver", "case", "metric", "value", "unit", "status", "key"});
  }

  /// A row for each value over time of each case.
  std::string series() {
    return all(
        "SELECT asked.scene, asked.solver, asked.id, json_extract(columns, '$.t[' || point.key || "
        "']'), line.key, point.value, asked.key FROM asked JOIN series "
        "USING (case_id), json_each(columns) AS line, json_each(line.value) AS point "
        "WHERE line.key NOT IN ('step', 't') ORDER BY place, line.key, point.key",
        {"scene", "solver", "case", "t", "metric", "value", "key"});
  }

 private:
  Cells list(const std::string& sql) {
    Cells all;
    Database::Rows row = database_.rows(sql);
    while (row.next()) all.push_back(row.text(0));
    return all;
  }
  std::string all(const std::string& sql, const Cells& names) {
    std::string text = line(names);
    Database::Rows row = database_.rows(sql);
    for (Cells cells(names.size()); row.next(); text += line(cells))
      for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = row.exact_text(static_cast<int>(i));
    return text;
  }

  Database& database_;
};

int run(const Options& options) {
  const Study study = load_study(options.study, options.preset);
  const Store store(options.results);
  std::optional<Asked> asked;
  if (store.reading())
    asked.emplace(study, store);
  else
    each_case(study, [](Case&&) {});  // what is wrong with it is said first
  if (!asked || asked->count("FROM asked WHERE case_id IS NOT NULL") == 0)
    throw InputError("no case of study '" + study.name + "' is in " + options.results +
                     " as this build would run it; taut run " + study_words(study) + " makes them" +
                     where_else(study, store));
  const std::string text = options.series ? asked->series()
                           : options.tidy ? asked->tidy()
                                          : asked->wide();
  if (options.output.empty())
    std::cout << text;
  else
    write_durably(options.output, text), std::cout << options.output << '\n';
  const std::int64_t missing = asked->count("FROM asked WHERE case_id IS NULL"),
                     damaged =
                         asked->count("FROM asked WHERE case_id IS NULL AND absent = 'damaged'");
  if (missing > damaged)
    progress() << missing - damaged << " cases were not run" << where_else(study, store) << '\n';
  if (damaged > 0) progress() << damaged << " cases are damaged and left empty\n";
  return missing > 0 ? kIncomplete : kPass;
}

void add_options(CLI::App& app, Options& options) {
  app.add_option("STUDY", options.study, "Name or path of a study that was run")->required();
  add_stored(app, options.preset, options.results);
  auto* tidy = app.add_flag("--tidy", options.tidy, "A row for each value of each case");
  app.add_flag("--series", options.series, "A row for each value over time of each case")
      ->excludes(tidy);
  add_output(app, options.output, "File (default: standard output)");
}

}  // namespace
}  // namespace taut::verb::exporting

TAUT_VERB(export) = {
    .name = "export",
    .group = VerbGroup::studies,
    .summary = "Writes a study as CSV: a row a case, a value or a moment; SI units, costs",
    .example = R"(taut export iterations --preset quick -o x.csv
  taut export iterations --series -o motion.csv
Python:
  import pandas
  cases = pandas.read_csv("x.csv").query("status == 'ok'")
  print(cases.pivot_table("stretch.rms", ["scene", "iterations"], "solver"))
Exit: 0 every case is there; 3 some were not run or are damaged (their status says so))",
    .bind = taut::bind_verb<taut::verb::exporting::add_options, taut::verb::exporting::run>};
