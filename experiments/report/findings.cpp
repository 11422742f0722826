#include "experiments/report/findings.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <type_traits>

#include "core/model/solver.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

namespace taut::report {

namespace {

/// How far a finding is on the way to its tolerance; 1: at it.
double share_of_tolerance(const JsonReader& finding) {
  const double off =
      std::abs(finding.at("measured").number_or_null() - finding.at("expected").number_or_null());
  const double tolerance = finding.at("tolerance").number_or_null();
  return tolerance > 0 ? off / tolerance : off;
}

/// A row of the model: a closed form or a published number beside what was measured.
Json row_of(const JsonReader& truth, const JsonReader& finding) {
  const std::string si = finding.at("unit").text(), unit = si == "1" ? "" : " " + si,
                    verdict = finding.at("verdict").text();
  const double expected = finding.at("expected").number_or_null(),
               slack = finding.at("tolerance").number_or_null();
  Json row{{"section", truth.at("section_title").text()},
           {"statement", typeset(truth.at("statement").text())},
           {"source", typeset(truth.at("source").text())},
           {"subject", finding.at("subject").text()},
           {"expected", ""},
           {"measured", ""},
           {"verdict", verdict}};
  add_if(row, "why", typeset(finding.at("why").text()));
  if (verdict == "not applicable") return row;
  const double measured = finding.at("measured").number_or_null();
  const auto say = [&](const std::string& wanted, const std::string& found) {
    row["expected"] = typeset(wanted), row["measured"] = typeset(found);
    return row;
  };
  if (expected == 0)
    return say("at most " + significant(slack, 2) + unit, significant(measured, 2) + unit);
  // As many digits as the tolerance lets matter.
  if (slack >= 1e-6 && std::abs(measured) < 1e6) {
    const int decimals = decimals_for(slack);
    return say(fixed(expected, decimals) + " ± " + fixed(slack, decimals) + unit,
               fixed(measured, decimals) + unit);
  }
  if (slack > 0)
    return say(significant(expected, 6) + " ± " + significant(slack, 2) + unit,
               significant(measured, 6) + unit);
  return say("exactly " + significant(expected, 3) + unit, significant(measured, 3) + unit);
}

/// What `read` makes of a file; nothing if there is none or another program wrote it. Throws
/// InputError if it is damaged.
template <class Read>
auto read_found(const std::filesystem::path& file, const char* schema, std::string_view program,
                Read read) {
  using Found = std::optional<std::invoke_result_t<Read, JsonReader>>;
  if (!std::filesystem::exists(file)) return Found();
  return read_json(read_text(file), file.string(), [&](const JsonReader& root) {
    root.require_schema(schema);
    return root.at("program").text() == program ? Found(read(root)) : Found();
  });
}

/// Files below `results`/`folder` that end so, sorted.
std::vector<std::filesystem::path> files_below(const std::filesystem::path& folder,
                                               const std::string& ending) {
  std::vector<std::filesystem::path> files;
  if (!std::filesystem::is_directory(folder)) return files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.path().string().ends_with(ending)) files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

}  // namespace

Json stored_requirements(const std::filesystem::path& results, std::string_view program) {
  Json rows;
  for (const auto& file : files_below(results / "require", "found.json"))
    if (auto row = read_found(file, "taut-require-1", program, [](const JsonReader& root) {
          const auto text = [&](const char* key) { return root.at("summary").at(key).text(); };
          const std::string chaotic = text("chaotic");
          return Json::array({text("scene"), solver_title(solver_name(text("solver"))),
                              chaotic.empty() ? "no" : chaotic, text("answers"), text("drop"),
                              text("keep"), text("time")});
        }))
      rows.push_back(std::move(*row));
  return rows;
}

std::vector<ParameterFrontier> stored_frontiers(const std::filesystem::path& results,
                                                std::string_view program) {
  std::vector<ParameterFrontier> all;
  for (const auto& file : files_below(results / kFrontiersFolder, ".json"))
    if (const auto found = read_frontiers(file, program))
      all.insert(all.end(), found->begin(), found->end());
  return all;
}

std::optional<Truths> stored_truths(const std::filesystem::path& results,
                                    std::string_view program) {
  return read_found(results / "verify.json", "taut-truths-2", program, [](const JsonReader& root) {
    Truths truths;
    int count = 0;
    std::map<std::string, int> verdicts;
    Json rows;
    for (const JsonReader& truth : root.at("truths").items()) {
      std::optional<JsonReader> nearest;
      Json apart;
      for (const JsonReader& finding : truth.at("findings").items()) {
        const std::string verdict = finding.at("verdict").text();
        ++count, ++verdicts[verdict];
        if (verdict != "passed")
          apart.push_back(row_of(truth, finding));
        else if (!nearest || share_of_tolerance(finding) > share_of_tolerance(*nearest))
          nearest = finding;
      }
      if (nearest) rows.push_back(row_of(truth, *nearest));
      for (Json& row : apart) rows.push_back(std::move(row));
    }
    truths.shown = {
        {"truths", root.at("truths").items().size()}, {"findings", count}, {"verdicts", verdicts}};
    add_if(truths.shown, "rows", std::move(rows));
    for (const JsonReader& one : root.at("assertions").items())
      truths.assertions[one.at("assertion").text()] = {one.at("verdict").text(),
                                                       one.at("figure").text()};
    return truths;
  });
}

std::optional<Json> stored_regressions(const std::filesystem::path& results,
                                       std::string_view program) {
  return read_found(results / "check.json", "taut-check-1", program, [](const JsonReader& root) {
    Json regressions{{"cases", root.at("cases").integer()},
                     {"values", root.at("values").integer()}};
    for (const JsonReader& f : root.at("findings").items())
      regressions["rows"].push_back({{"study", f.at("study").text()},
                                     {"case", f.at("case").text()},
                                     {"change", f.at("change").text()}});
    return regressions;
  });
}

}  // namespace taut::report
