// Baselines on disk: JSON lines, and tolerances.toml.
#include <algorithm>
#include <map>
#include <sstream>

#include "core/io/document.hpp"
#include "core/model/text.hpp"
#include "experiments/baseline/baseline.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/case/record_parts.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace {

namespace fs = std::filesystem;

constexpr std::tuple kSpec{Field{"scene", &CaseSpec::scene}, Field{"settings", &CaseSpec::settings},
                           Field{"solver", &CaseSpec::solver}};
/// The same fields in rows of an earlier taut.
constexpr const char* kEarlierSettings = "overrides";
constexpr std::tuple kEarlierSpec{Field{"scene", &CaseSpec::scene},
                                  Field{kEarlierSettings, &CaseSpec::settings},
                                  Field{"solver", &CaseSpec::solver}};

std::string line_of(const BaselineRow& row) {
  Json json{{"id", row.id}};
  json.update(json_of(row.spec, kSpec));
  json["content"] = row.scene;
  json["status"] = row.status.kind;
  add_if(json, "reason", row.status.reason);
  json["projections"] = row.projections;
  if (!row.frontier.empty()) json["frontier"] = row.frontier;
  if (row.flaky) json["flaky"] = true;
  json["values"] = row.values;  // null: the value has no meaning
  return to_text(json) + "\n";
}

BaselineRow row_of(const JsonReader& json) {
  BaselineRow row;
  row.id = printable(json.at("id").text());  // it is printed on terminals
  if (json.find(kEarlierSettings))
    read_into(json, row.spec, kEarlierSpec);
  else
    read_into(json, row.spec, kSpec);
  row.scene = json.at("content").text();
  row.status.kind = json.at("status").text();
  if (row.status.kind.find(" (") != std::string::npos)
    json.at("status").fail(
        "is of an earlier taut: remove the file, and `taut baseline update` writes it anew");
  if (const auto reason = json.find("reason")) row.status.reason = reason->text();
  row.projections = json.at("projections").count();
  if (const auto frontier = json.find("frontier")) row.frontier = frontier->text();
  if (const auto flaky = json.find("flaky")) row.flaky = flaky->flag();
  for (const auto& [name, value] : json.at("values").members())
    row.values[name] = value.number_or_null();
  return row;
}

std::vector<fs::path> solver_files(const fs::path& folder) {
  std::vector<fs::path> files;
  if (fs::is_directory(folder))
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.path().extension() == ".jsonl") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

FrontierQuestion question_of(Section& section) {
  section.need({"scene", "solver", "of", "from", "to"});
  FrontierQuestion question;
  question.base = {section.string("scene").value_or(""),
                   scene_settings(section.strings("set").value_or(std::vector<std::string>())),
                   section.string("solver").value_or("")};
  question.of = section.string("of").value_or("dt");
  const double from = section.number("from", {-1e9, 1e9}, 0);
  const double to = section.number("to", {-1e9, 1e9}, 0);
  const double tolerance = section.number("tolerance", {1e-9, 0.5}, SearchRange{}.tolerance);
  section.finish();
  section.diagnostics().throw_if_any();
  question.range = range_of(question.base, question.of, from, to);
  question.range.tolerance = tolerance;
  return question;
}

std::string options_of(const FrontierQuestion& question) {
  return "--of " + question.of + " --from " + shortest(question.range.from) + " --to " +
         shortest(question.range.to) + " --tolerance " + shortest(question.range.tolerance);
}

}  // namespace

Baseline read_baseline(const fs::path& folder) {
  Baseline rows;
  std::vector<Diagnostic> found;
  for (const fs::path& file : solver_files(folder)) {
    std::istringstream in(read_text(file));
    int number = 0;
    for (std::string line; std::getline(in, line);) {
      ++number;
      try {
        rows.push_back(read_json(line, file.string(), row_of, number));
        const BaselineRow& row = rows.back();
        if (row.solver() != file.stem())
          found.push_back({file.string(), number, 1, "this row belongs to " + row.solver()});
      } catch (const InputError& error) {
        for (const Diagnostic& d : error.diagnostics())
          found.push_back({file.string(), number, 1, "not a baseline row: " + d.message});
      }
    }
  }
  std::ranges::sort(rows, {}, &BaselineRow::id);
  const auto twice = std::ranges::adjacent_find(rows, {}, &BaselineRow::id);
  if (twice != rows.end())
    found.push_back({folder.string(), 0, 0, "two rows are called '" + twice->id + "'"});
  if (!found.empty()) throw InputError(found);
  return rows;
}

void write_baseline(const fs::path& folder, const Baseline& baseline) {
  Baseline rows = baseline;
  std::ranges::sort(rows, {}, &BaselineRow::id);
  std::map<std::string, std::string> texts;
  for (const BaselineRow& row : rows) texts[row.solver()] += line_of(row);
  make_folder(folder);
  for (const auto& [solver, text] : texts) {
    const fs::path file = folder / (solver + ".jsonl");
    if (!fs::exists(file) || read_text(file) != text) write_durably(file, text);
  }
  for (const fs::path& file : solver_files(folder))
    if (!texts.count(file.stem().string())) fs::remove(file);
}

Tolerances read_tolerances(const fs::path& folder) {
  const fs::path file = folder / "tolerances.toml";
  if (!fs::exists(file)) return {};
  const Document document = read_document(file, {});
  Diagnostics diagnostics(document);
  Section root(diagnostics, document.root, "the tolerances");
  std::map<std::string, Tolerance> by_name;
  for (const Key& key : document.root.keys) {
    const Value* table = root.table(key.text);
    if (!table) continue;
    Section section(diagnostics, *table, "[" + key.text + "]");
    Tolerance tolerance;
    tolerance.absolute = section.number("absolute", Range::non_negative(1e30), 0);
    tolerance.relative = section.number("relative", Range::non_negative(1), 0);
    tolerance.ignored = section.boolean("ignored", false);
    tolerance.reason = section.string("reason").value_or("");
    if (tolerance.reason.empty()) section.missing("reason");
    section.finish();
    by_name[key.text] = tolerance;
  }
  diagnostics.throw_if_any();
  return Tolerances(by_name);
}

std::vector<FrontierQuestion> read_frontiers(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "frontiers.toml";
  std::vector<FrontierQuestion> questions;
  if (!std::filesystem::exists(file)) return questions;
  const Document document = read_document(file, {});
  Diagnostics diagnostics(document);
  Section root(diagnostics, document.root, "the frontiers");
  for (const Value* table : root.tables("frontier")) {
    Section section(diagnostics, *table, "[[frontier]]");
    questions.push_back(question_of(section));
  }
  root.finish();
  diagnostics.throw_if_any();
  return questions;
}

std::string frontier_id(const FrontierQuestion& question) {
  return make_case(question.base).id + ", frontier of " + question.of;
}

BaselineRow frontier_row(const FrontierQuestion& question, const CaseFrontier& found) {
  const Case base = make_case(question.base);
  BaselineRow row;
  row.id = frontier_id(question);
  row.spec = base.spec;
  row.spec.solver = base.choice.brief();
  row.scene = digest(*base.scene);
  row.frontier = options_of(question);
  row.status.kind = to_string(found.frontier.kind);
  row.values["frontier.stable_above"] = static_cast<double>(found.frontier.stable_above.size());
  if (found.frontier.kind == Frontier::Kind::bracketed) {
    row.values["frontier.stable"] = found.frontier.stable;
    row.values["frontier.unstable"] = found.frontier.unstable;
  }
  return row;
}

}  // namespace taut
