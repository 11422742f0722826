#include "experiments/results/schema.hpp"

#include "core/model/text.hpp"
#include "experiments/case/record_columns.hpp"

namespace taut {

namespace {

std::string sql_type(const RecordColumn& column) {
  const std::string_view type = column.type();
  const std::string name = type == "number" ? "REAL" : type == "whole number" ? "INTEGER" : "TEXT";
  return name + (column.may_be_null() ? "" : " NOT NULL");
}

std::string table_of_cases() {
  std::string sql = "CREATE TABLE cases (\n  case_id INTEGER PRIMARY KEY,\n";
  for (const RecordColumn& column : record_columns())
    if (!column.column.empty())
      sql += "  " + std::string(column.column) + " " + sql_type(column) + ",\n";
  return sql +
         "  is_result INTEGER NOT NULL,\n  result_digest TEXT NOT NULL,\n"
         "  errors TEXT NOT NULL,\n  UNIQUE (key));\n";
}

constexpr const char* kOtherTables = R"SQL(
CREATE TABLE metrics (
  metric_id INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE,
  unit TEXT,
  definition TEXT);

-- A value without a type keeps the sign of a zero.
CREATE TABLE numbers (
  case_id INTEGER NOT NULL REFERENCES cases ON DELETE CASCADE,
  metric_id INTEGER NOT NULL REFERENCES metrics,
  value,
  PRIMARY KEY (case_id, metric_id)) WITHOUT ROWID;

CREATE TABLE series (
  case_id INTEGER PRIMARY KEY REFERENCES cases ON DELETE CASCADE,
  columns TEXT NOT NULL,
  digest TEXT NOT NULL);

CREATE TABLE frames (
  case_id INTEGER PRIMARY KEY REFERENCES cases ON DELETE CASCADE,
  motion BLOB NOT NULL,
  digest TEXT NOT NULL);

CREATE TABLE conflicts (
  key TEXT NOT NULL,
  result_digest TEXT NOT NULL,
  found TEXT NOT NULL,
  record TEXT NOT NULL,
  PRIMARY KEY (key, result_digest)) WITHOUT ROWID;

CREATE TABLE sessions (
  session TEXT PRIMARY KEY,
  command TEXT NOT NULL,
  started TEXT NOT NULL,
  host TEXT NOT NULL,
  toolchain TEXT NOT NULL,
  shard INTEGER NOT NULL,
  shards INTEGER NOT NULL,
  cases INTEGER NOT NULL);

CREATE TABLE planned (
  study TEXT NOT NULL,
  key TEXT NOT NULL,
  id TEXT NOT NULL,
  shard INTEGER NOT NULL,
  shards INTEGER NOT NULL,
  missing INTEGER NOT NULL DEFAULT 0,
  PRIMARY KEY (study, key)) WITHOUT ROWID;
CREATE INDEX planned_key ON planned (key);

-- Which build ran which case of a study; builds whose keys are equal share the case.
CREATE TABLE builds (
  study TEXT NOT NULL,
  build TEXT NOT NULL,
  made TEXT NOT NULL,
  place INTEGER NOT NULL,
  subject TEXT NOT NULL,
  asked TEXT NOT NULL,
  gap TEXT NOT NULL,
  PRIMARY KEY (study, build)) WITHOUT ROWID;

CREATE TABLE ran (
  study TEXT NOT NULL,
  build TEXT NOT NULL,
  id TEXT NOT NULL,
  key TEXT NOT NULL,
  PRIMARY KEY (study, build, id),
  FOREIGN KEY (study, build) REFERENCES builds) WITHOUT ROWID;
CREATE INDEX ran_key ON ran (key);

-- CPU time [s] of the last run of a case: of its process, and of its metrics in it.
CREATE TABLE spent (
  key TEXT PRIMARY KEY,
  cpu REAL NOT NULL,
  metrics REAL NOT NULL) WITHOUT ROWID;

-- CPU and wall time of a step of one build over that of another, timed in turns.
CREATE TABLE ratios (
  study TEXT NOT NULL,
  id TEXT NOT NULL,
  before TEXT NOT NULL,
  now TEXT NOT NULL,
  host TEXT NOT NULL,
  clock TEXT NOT NULL,
  low REAL NOT NULL,
  ratio REAL NOT NULL,
  high REAL NOT NULL,
  control_low REAL NOT NULL,
  control REAL NOT NULL,
  control_high REAL NOT NULL,
  made TEXT NOT NULL,
  PRIMARY KEY (study, id, before, now, host, clock)) WITHOUT ROWID;

CREATE TABLE answers (
  kind TEXT NOT NULL,
  subject TEXT NOT NULL,
  program TEXT NOT NULL,
  made TEXT NOT NULL,
  answer TEXT NOT NULL,
  digest TEXT NOT NULL,
  PRIMARY KEY (kind, subject)) WITHOUT ROWID;

CREATE TABLE benches (
  bench_id INTEGER PRIMARY KEY,
  study TEXT NOT NULL,
  host TEXT NOT NULL,
  build TEXT NOT NULL,
  machine TEXT NOT NULL,
  made TEXT NOT NULL,
  scene TEXT NOT NULL,
  in_turns INTEGER NOT NULL,
  control_low REAL,
  control REAL,
  control_high REAL,
  digest TEXT NOT NULL);

CREATE TABLE timings (
  timing_id INTEGER PRIMARY KEY,
  bench_id INTEGER NOT NULL REFERENCES benches ON DELETE CASCADE,
  key TEXT NOT NULL,
  peak_bytes INTEGER NOT NULL,
  failure TEXT NOT NULL,
  remark TEXT NOT NULL);
CREATE INDEX timings_of_bench ON timings (bench_id);

CREATE TABLE samples (
  timing_id INTEGER NOT NULL REFERENCES timings ON DELETE CASCADE,
  sample INTEGER NOT NULL,
  cpu REAL NOT NULL,
  wall REAL NOT NULL,
  PRIMARY KEY (timing_id, sample)) WITHOUT ROWID;

CREATE VIEW results AS
SELECT study, scene, solver, setting, dt,
  substeps, sweeps AS iterations,
  metrics.name AS metric, numbers.value, metrics.unit, status, cases.key, parameters, settings,
  (SELECT build FROM ran JOIN builds USING (study, build) WHERE ran.key = cases.key
    ORDER BY made DESC, place DESC, build LIMIT 1) AS build
FROM metrics CROSS JOIN cases LEFT JOIN numbers USING (case_id, metric_id)
  LEFT JOIN planned ON planned.key = cases.key;

CREATE VIEW history AS
SELECT study, build, made, subject, scene, solver, setting,
  dt, substeps, sweeps AS iterations, metrics.name AS metric, numbers.value, metrics.unit, status,
  (SELECT count(*) FROM ran AS other WHERE other.key = ran.key AND other.study = ran.study)
    AS builds, ran.key
FROM ran JOIN builds USING (study, build) JOIN cases ON cases.key = ran.key
  LEFT JOIN numbers USING (case_id) LEFT JOIN metrics USING (metric_id);

CREATE VIEW curves AS
SELECT scene, solver, setting, dt,
  substeps, sweeps AS iterations,
  CAST(json_extract(columns, '$.step[' || point.key || ']') AS INTEGER) AS step,
  json_extract(columns, '$.t[' || point.key || ']') AS t, line.key AS metric,
  point.value, metrics.unit, status, cases.key
FROM series JOIN cases USING (case_id), json_each(series.columns) AS line,
  json_each(line.value) AS point LEFT JOIN metrics ON metrics.name = line.key
WHERE line.key NOT IN ('step', 't');

CREATE VIEW costs AS
WITH ranked AS (
  SELECT timing_id, cpu, wall, count(*) OVER (PARTITION BY timing_id) AS taken,
    row_number() OVER (PARTITION BY timing_id ORDER BY cpu) AS by_cpu,
    row_number() OVER (PARTITION BY timing_id ORDER BY wall) AS by_wall
  FROM samples),
medians AS (
  SELECT timing_id, taken,
    avg(cpu) FILTER (WHERE by_cpu IN ((taken + 1) / 2, (taken + 2) / 2)) AS cpu,
    avg(wall) FILTER (WHERE by_wall IN ((taken + 1) / 2, (taken + 2) / 2)) AS wall
  FROM ranked GROUP BY timing_id)
SELECT study, cases.scene, solver, setting, dt,
  substeps, sweeps AS iterations,
  cpu, cpu / dt AS cpu_per_second, wall, peak_bytes AS memory, coalesce(taken, 0) AS samples,
  failure, remark, status, host, benches.build AS program, cases.key
FROM timings JOIN benches USING (bench_id) JOIN cases USING (key)
  LEFT JOIN medians USING (timing_id);
)SQL";

}  // namespace

std::string tables() { return table_of_cases() + kOtherTables; }

std::vector<std::string> case_columns() {
  std::vector<std::string> names;
  for (const RecordColumn& column : record_columns())
    if (!column.column.empty()) names.emplace_back(column.column);
  return names;
}

}  // namespace taut
