// Files of settings that a search chose for a study.
#include <cmath>

#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/study/study.hpp"

namespace taut {

namespace {

std::string quoted(const std::string& text) {
  std::string all = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') all += '\\';
    all += c == '\n' || c == '\t' ? ' ' : c;
  }
  return all + '"';
}

std::string list_of(const std::vector<double>& numbers) {
  return "[" + join(numbers, ", ", [](double one) { return shortest(one); }) + "]";
}

std::vector<double> read_errors(Section& row, const std::string& key) {
  std::vector<double> all;
  const Value* list = row.find(key);
  if (!list) return all;
  if (!list->is_array()) row.report(key, "must be a list of numbers, not " + describe(*list));
  for (const Value& item : list->items)
    if (item.is_number())
      all.push_back(item.number);
    else
      row.diagnostics().report(item.place, "'" + key + "' holds numbers, not " + describe(item));
  return all;
}

SearchedSetting read_row(Section& row) {
  SearchedSetting one;
  one.scene = row.string("scene").value_or("");
  one.solver = row.string("solver").value_or("");
  row.need({"scene", "solver"});
  one.error = row.number("error", {}, std::nan(""));
  one.cost = row.number("cost", {}, std::nan(""));
  one.refused = row.string("refused").value_or("");
  one.cheapest = row.boolean("cheapest", false);
  one.plain = read_errors(row, "plain");
  one.best = read_errors(row, "best");
  row.finish();
  if (!one.solver.empty()) try {
      parse_solver(one.solver);
    } catch (const InputError& error) {
      row.report("solver", error.diagnostics().front().message);
    }
  return one;
}

}  // namespace

std::string searched_toml(const std::string& heading, const std::vector<SearchedSetting>& rows,
                          const std::vector<std::string>& missing) {
  std::string text = heading + "\nmissing = [\n";
  for (const std::string& one : missing) text += "  " + quoted(one) + ",\n";
  text += "]\n\ntried = [\n";
  for (const SearchedSetting& row : rows) {
    text += "  { scene = " + quoted(row.scene) + ", solver = " + quoted(row.solver);
    if (std::isfinite(row.error)) text += ", error = " + general(row.error, 4);
    if (std::isfinite(row.cost)) text += ", cost = " + general(row.cost, 4);
    if (!row.refused.empty()) text += ", refused = " + quoted(row.refused);
    if (row.cheapest) text += ", cheapest = true";
    if (!row.plain.empty()) text += ", plain = " + list_of(row.plain);
    if (!row.best.empty()) text += ", best = " + list_of(row.best);
    text += " },\n";
  }
  return text + "]\n";
}

std::vector<SearchedSetting> read_searched(const std::filesystem::path& file) {
  const Document document = read_document(file, {});
  Diagnostics diagnostics(document);
  Section section(diagnostics, document.root, "the searched settings");
  section.strings("missing");
  section.need({"tried"});
  std::vector<SearchedSetting> rows;
  for (const Value* table : section.tables("tried")) {
    Section row(diagnostics, *table, "[[tried]]");
    rows.push_back(read_row(row));
  }
  section.finish();
  diagnostics.throw_if_any();
  return rows;
}

}  // namespace taut
