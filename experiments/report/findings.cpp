#include "experiments/report/findings.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "experiments/report/chart/wording.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

namespace taut::report {

namespace {

std::string with_unit(double value, const std::string& unit, int digits) {
  return significant(value, digits) + (unit == "1" ? "" : " " + unit);
}

/// How far a finding is on the way to its tolerance; 1: at it.
double share_of_tolerance(const JsonReader& finding) {
  const double off =
      std::abs(finding.at("measured").number_or_null() - finding.at("expected").number_or_null());
  const double tolerance = finding.at("tolerance").number_or_null();
  return tolerance > 0 ? off / tolerance : off;
}

TruthRow row_of(const JsonReader& truth, const JsonReader& finding) {
  const std::string unit = finding.at("unit").text(), verdict = finding.at("verdict").text();
  const double expected = finding.at("expected").number_or_null(),
               slack = finding.at("tolerance").number_or_null();
  TruthRow row{truth.at("section_title").text(),
               truth.at("statement").text(),
               truth.at("source").text(),
               finding.at("subject").text(),
               "",
               "",
               verdict,
               finding.at("why").text()};
  if (verdict == "not applicable") return row;
  const double measured = finding.at("measured").number_or_null();
  if (expected == 0) {
    row.expected = "at most " + with_unit(slack, unit, 2),
    row.measured = with_unit(measured, unit, 2);
    return row;
  }
  // As many digits as the tolerance lets matter.
  const int decimals = decimals_for(slack);
  const bool plain = slack >= 1e-6 && std::abs(measured) < 1e6;
  const std::string suffix = unit == "1" ? "" : " " + unit;
  row.expected = plain       ? fixed(expected, decimals) + " ± " + fixed(slack, decimals) + suffix
                 : slack > 0 ? significant(expected, 6) + " ± " + with_unit(slack, unit, 2)
                             : "exactly " + with_unit(expected, unit, 3);
  row.measured =
      plain ? fixed(measured, decimals) + suffix : with_unit(measured, unit, slack > 0 ? 6 : 3);
  return row;
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

RequiredModel required_of(const JsonReader& json) {
  const auto text = [&](const char* key) { return json.at(key).text(); };
  return {text("scene"), text("solver"), text("chaotic"), text("answers"),
          text("drop"),  text("keep"),   text("time"),    text("command")};
}

}  // namespace

std::vector<RequiredModel> stored_requirements(const std::filesystem::path& results,
                                               std::string_view program) {
  std::vector<RequiredModel> all;
  for (const auto& file : files_below(results / "require", "found.json"))
    if (auto found = read_found(file, "taut-require-1", program, [](const JsonReader& root) {
          return required_of(root.at("summary"));
        }))
      all.push_back(std::move(*found));
  return all;
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
    for (const JsonReader& truth : root.at("truths").items()) {
      std::optional<JsonReader> nearest;
      std::vector<TruthRow> apart;
      for (const JsonReader& finding : truth.at("findings").items()) {
        const std::string verdict = finding.at("verdict").text();
        ++truths.findings, ++truths.verdicts[verdict];
        if (verdict != "passed")
          apart.push_back(row_of(truth, finding));
        else if (!nearest || share_of_tolerance(finding) > share_of_tolerance(*nearest))
          nearest = finding;
      }
      ++truths.truths;
      if (nearest) truths.rows.push_back(row_of(truth, *nearest));
      for (TruthRow& row : apart) truths.rows.push_back(std::move(row));
    }
    for (const JsonReader& one : root.at("assertions").items())
      truths.assertions[one.at("assertion").text()] = {one.at("verdict").text(),
                                                       one.at("figure").text()};
    return truths;
  });
}

std::optional<Regressions> stored_regressions(const std::filesystem::path& results,
                                              std::string_view program) {
  return read_found(results / "check.json", "taut-check-1", program, [](const JsonReader& root) {
    Regressions regressions{root.at("cases").integer(), root.at("values").integer(), {}};
    for (const JsonReader& f : root.at("findings").items())
      regressions.rows.push_back(
          {f.at("study").text(), f.at("case").text(), f.at("change").text()});
    return regressions;
  });
}

}  // namespace taut::report
