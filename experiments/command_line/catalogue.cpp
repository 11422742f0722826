#include "experiments/command_line/catalogue.hpp"

#include "core/io/fabrics.hpp"
#include "core/io/scene_io.hpp"
#include "core/model/scene_keys.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/case/record_columns.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/study/study.hpp"
#include "experiments/system/data.hpp"
#include "experiments/truths/assertions/assertions.hpp"

namespace taut {

namespace {

std::string allowed(const ParamSpec& spec) {
  if (spec.kind == ParamSpec::Kind::choice) return std::string(spec.choices);
  if (spec.kind == ParamSpec::Kind::text) return "any text";
  if (spec.kind == ParamSpec::Kind::integer)
    return std::to_string(static_cast<long>(spec.min)) + " to " +
           std::to_string(static_cast<long>(spec.max));
  return shortest(spec.min) + " to " + shortest(spec.max);
}

void list_scenes(Answer& all) {
  Table table{"scenes",
              "scenes",
              {{"name"},
               {"vertices"},
               {"links"},
               {"dt", "time step", kTime},
               {"duration", "duration", kTime},
               {"summary"}}};
  for (const std::string& name : shipped("scenes")) {
    const Scene scene = load_scene(find_scene(name));
    table.rows.push_back(
        {name, scene.mesh.size(), scene.links.size(), scene.dt, scene.duration(), scene.summary});
  }
  all.add(std::move(table));
}

/// Adds a table of all solvers, or of the one with this name.
void list_solvers(Answer& all, const std::string& only) {
  Table table{"solvers", "solvers", {{"name"}, {"summary"}, {"source"}}},
      parameters{"parameters",
                 "parameters of solvers",
                 {{"solver"}, {"name", "parameter"}, {"default"}, {"unit"}, {"allowed"}, {"help"}}};
  for (const SolverEntry* entry : all_solvers()) {
    if (!only.empty() && entry->name != only) continue;
    table.rows.push_back({entry->name, entry->summary, entry->source});
    for (const ParamSpec& spec : entry->params)
      parameters.rows.push_back(
          {entry->name, spec.name, spec.defaults(), spec.unit, allowed(spec), spec.help});
  }
  all.add(std::move(table));
  all.add(std::move(parameters));
}

void list_every_solver(Answer& all) { list_solvers(all, ""); }

void list_metrics(Answer& all) {
  Table table{"metrics", "metrics", {{"name"}, {"summary"}, {"source"}}},
      values{"values",
             "their values",
             {{"metric"}, {"name", "value"}, {"unit"}, {"in_series", "over time"}, {"help"}}};
  for (const MetricEntry* entry : metrics()) {
    table.rows.push_back({entry->name, entry->summary, entry->source});
    for (const ValueSpec& spec : entry->values)
      values.rows.push_back({entry->name, spec.name, spec.unit.si, spec.in_series, spec.help});
  }
  all.add(std::move(table));
  all.add(std::move(values));
}

void list_studies(Answer& all) {
  Table table{"studies", "studies", {{"name"}, {"presets"}, {"question"}, {"scenes"}, {"solvers"}}};
  for (const std::string& name : shipped("studies")) {
    const Study study = load_study(name);
    table.rows.push_back({name, join(study.presets, ", "), study.question, join(study.scenes, ", "),
                          join(study.solvers, "; ")});
  }
  all.add(std::move(table));
}

void list_fabrics(Answer& all) {
  Table table{"fabrics",
              "measured fabrics",
              {{"name"},
               {"mass", "mass", {Unit::Kind::other, "kg/m^2", "g/m\u00B2", 1e3}},
               {"warp", "bending, warp", {Unit::Kind::other, "N m", "\u00B5N m", 1e6}},
               {"weft", "weft", {Unit::Kind::other, "N m", "\u00B5N m", 1e6}},
               {"drape", "drape coefficient", kShare},
               {"source"},
               {"licence"}}};
  for (const Fabric& f : fabrics())
    table.rows.push_back({f.name, f.mass, f.warp, f.weft, f.drape, f.source, f.licence});
  all.add(std::move(table));
}

void list_keys(Answer& all) {
  Table table{"keys",
              "keys of scenes",
              {{"key"},
               Column("type").in_detail(),
               {"unit"},
               Column("range").in_detail(),
               {"default"},
               Column("example").in_detail(),
               {"help", "meaning"}}};
  for (const SceneKey& key : scene_keys())
    table.rows.push_back({key.path, key.type, key.unit, key.allowed(), key.default_text(),
                          key.example, key.meaning()});
  all.add(std::move(table));
  Table studies{"study_keys", "keys of studies", {{"key"}, {"help", "meaning"}}};
  for (const StudyKey& key : study_keys()) studies.rows.push_back({key.name, key.help});
  all.add(std::move(studies));
}

void list_record(Answer& all) {
  Table table{"record",
              "fields of a record",
              {{"key"}, {"column", "column of cases"}, {"type"}, {"help", "meaning"}}};
  for (const RecordColumn& column : record_columns())
    table.rows.push_back({column.json, column.column, column.type(), column.help});
  all.add(std::move(table));
}

/// Adds a table of what each verb prints with --json, with a row for its facts and a row for each
/// table.
void list_answers(Answer& all) {
  Table table{"answers", "answers of verbs", {{"verb"}, {"table"}, {"columns", "names"}}};
  for (const VerbEntry* verb : verbs())
    for (const AnswerPart& part : verb->answer)
      table.rows.push_back({verb->name, part.of, part.names});
  all.add(std::move(table));
}

/// Adds a table of what publications assert.
void list_assertions(Answer& all) {
  Table table{"assertions",
              "what publications assert",
              {{"source"},
               {"name", "section"},
               {"summary", "assertion"},
               {"verdict"},
               {"because"},
               {"truth"}}};
  for (const Assertion& assertion : assertions())
    table.rows.push_back({assertion.source, assertion.place, assertion.assertion,
                          cell_of(assertion.verdict), assertion.because,
                          assertion.truth.empty() ? Cell() : Cell(assertion.truth)});
  all.add(std::move(table));
}

constexpr std::pair<const char*, void (*)(Answer&)> kKinds[] = {{"scenes", list_scenes},
                                                                {"solvers", list_every_solver},
                                                                {"metrics", list_metrics},
                                                                {"studies", list_studies},
                                                                {"keys", list_keys},
                                                                {"fabrics", list_fabrics},
                                                                {"assertions", list_assertions},
                                                                {"record", list_record},
                                                                {"answers", list_answers}};

}  // namespace

Answer catalogue(const std::string& what) {
  Answer all{"list", ""};
  for (const auto& [kind, list] : kKinds)
    if (what.empty() || what == kind) list(all);
  if (!all.tables.empty()) return all;
  // Look up solvers only here, since it may start the programs of registered ones.
  list_solvers(all, what);
  std::vector<std::string> known;
  for (const auto& [kind, list] : kKinds) known.emplace_back(kind);
  for (const SolverEntry* entry : all_solvers()) known.emplace_back(entry->name);
  if (std::ranges::find(known, what) == known.end())
    throw InputError("unknown kind '" + what + "'" + suggestion(what, known));
  return all;
}

}  // namespace taut
