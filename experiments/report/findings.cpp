#include "experiments/report/findings.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/input_error.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

namespace taut::report {

namespace {

double number(const Json& json) { return json.is_number() ? json.get<double>() : std::nan(""); }

std::string with_unit(double value, const std::string& unit, int digits) {
  return significant(value, digits) + (unit == "1" ? "" : " " + unit);
}

/// How far a finding is on the way to its tolerance; 1: at it.
double strain_of(const Json& finding) {
  const double off = std::abs(number(finding.at("measured")) - number(finding.at("expected")));
  const double tolerance = number(finding.at("tolerance"));
  return tolerance > 0 ? off / tolerance : off;
}

TruthRow row_of(const Json& truth, const Json& finding) {
  const std::string unit = finding.at("unit"), verdict = finding.at("verdict");
  const double expected = number(finding.at("expected")), slack = number(finding.at("tolerance"));
  TruthRow row{truth.at("section_title"),
               truth.at("statement"),
               truth.at("source"),
               finding.at("subject"),
               "",
               "",
               verdict,
               finding.at("why")};
  if (verdict == "not claimed") return row;
  const double measured = number(finding.at("measured"));
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

/// Nothing if there is no such file or another program wrote it. Throws InputError if it is
/// damaged.
std::optional<Json> document(const std::filesystem::path& file, const std::string& schema,
                             std::string_view program) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  Json json = parse_json_of(read_text(file), file.string());
  const JsonReader root(json, file.string());
  root.require_schema(schema);
  if (root.at("program").text() != program) return std::nullopt;
  return json;
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
    if (const auto json = document(file, "taut-require-1", program))
      all.push_back(required_of(JsonReader(*json, file.string()).at("summary")));
  return all;
}

std::vector<KnobFrontier> stored_frontiers(const std::filesystem::path& results,
                                           std::string_view program) {
  std::vector<KnobFrontier> all;
  for (const auto& file : files_below(results / kFrontiersFolder, ".json"))
    if (const auto found = read_frontiers(file, program))
      all.insert(all.end(), found->begin(), found->end());
  return all;
}

std::optional<Truths> stored_truths(const std::filesystem::path& results,
                                    std::string_view program) {
  const std::filesystem::path file = results / "verify.json";
  const auto json = document(file, "taut-truths-1", program);
  if (!json) return std::nullopt;
  Truths truths;
  try {
    for (const Json& truth : json->at("truths")) {
      const Json* nearest = nullptr;
      std::vector<TruthRow> apart;
      for (const Json& finding : truth.at("findings")) {
        ++truths.findings, ++truths.verdicts[finding.at("verdict").get<std::string>()];
        if (finding.at("verdict") != "passed")
          apart.push_back(row_of(truth, finding));
        else if (!nearest || strain_of(finding) > strain_of(*nearest))
          nearest = &finding;
      }
      ++truths.truths;
      if (nearest) truths.rows.push_back(row_of(truth, *nearest));
      for (TruthRow& row : apart) truths.rows.push_back(std::move(row));
    }
    for (const Json& claim : json->at("claims"))
      truths.claims[claim.at("claim")] = {claim.at("verdict"), claim.at("figure")};
  } catch (const Json::exception& error) {
    throw InputError(file.string() + ": " + error.what());
  }
  return truths;
}

std::optional<Regressions> stored_regressions(const std::filesystem::path& results,
                                              std::string_view program) {
  const std::filesystem::path file = results / "check.json";
  const auto json = document(file, "taut-check-1", program);
  if (!json) return std::nullopt;
  Regressions regressions;
  try {
    regressions.cases = json->at("cases"), regressions.values = json->at("values");
    for (const Json& f : json->at("findings"))
      regressions.rows.push_back({f.at("study"), f.at("case"), f.at("change")});
  } catch (const Json::exception& error) {
    throw InputError(file.string() + ": " + error.what());
  }
  return regressions;
}

}  // namespace taut::report
