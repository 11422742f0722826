// Comparisons for people and for continuous integration.
#include <map>
#include <set>

#include "experiments/baseline/baseline.hpp"
#include "experiments/system/process.hpp"

namespace taut {

namespace {

std::string escaped(const std::string& text) {
  std::string xml;
  for (const char c : text) {
    if (c == '&')
      xml += "&amp;";
    else if (c == '<')
      xml += "&lt;";
    else if (c == '>')
      xml += "&gt;";
    else if (c == '"')
      xml += "&quot;";
    else
      xml += c;
  }
  return xml;
}

}  // namespace

std::string reproduce(const CaseSpec& spec) {
  std::string command = "taut case " + shell_word(spec.scene) + " " + shell_word(spec.solver);
  for (const std::string& text : spec.overrides) command += " --set " + shell_word(text);
  return command;
}

std::string reproduce(const BaselineRow& row) {
  const std::string command = reproduce(row.spec);
  if (row.frontier.empty()) return command;
  return "taut frontier" + command.substr(std::string_view("taut case").size()) + " " +
         row.frontier;
}

std::string junit(const std::string& study, const Baseline& now, const Comparison& comparison) {
  std::map<std::string, std::string> failures;  // by test case
  std::set<std::string> names;
  for (const BaselineRow& row : now) names.insert(row.id);
  for (const Change& finding : comparison.findings) {
    if (!finding.is_regression() && !finding.is_mismatch()) continue;
    const std::string name = finding.id.empty() ? "solver " + finding.solver : finding.id;
    names.insert(name);
    failures[name] += finding.text + "\n";
  }
  std::string xml = "<testsuite name=\"" + escaped(study) + "\" tests=\"" +
                    std::to_string(names.size()) + "\" failures=\"" +
                    std::to_string(failures.size()) + "\">\n";
  for (const std::string& name : names) {
    xml += "  <testcase classname=\"" + escaped(study) + "\" name=\"" + escaped(name) + "\"";
    const auto failure = failures.find(name);
    xml += failure == failures.end()
               ? "/>\n"
               : "><failure>" + escaped(failure->second) + "</failure></testcase>\n";
  }
  return xml + "</testsuite>\n";
}

}  // namespace taut
