// Comparisons for people and for continuous integration: what moved, commands, JUnit.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "experiments/baseline/baseline.hpp"
#include "experiments/system/process.hpp"
#include "experiments/system/text.hpp"

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

double relative_change(const Change& c) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const double share = c.before == 0 ? kNone : (c.now - c.before) / std::abs(c.before);
  return std::isfinite(share) ? share : kNone;
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

double MovedValue::relative() const { return relative_change(*largest); }

std::vector<MovedValue> roll_up(const Comparison& comparison) {
  std::map<std::pair<std::string, std::string>, MovedValue> groups;
  for (const Change& c : comparison.findings) {
    if (!c.is_regression()) continue;
    MovedValue& group = groups[{c.scene, c.value}];
    group.scene = c.scene, group.value = c.value;
    ++group.cases, group.less += c.now<c.before, group.more += c.now> c.before;
    if (!group.largest || std::abs(relative_change(c)) > std::abs(group.relative()))
      group.largest = &c;
  }
  std::vector<MovedValue> all;
  for (const auto& [name, group] : groups) all.push_back(group);
  std::ranges::stable_sort(all, [](const MovedValue& a, const MovedValue& b) {
    return std::abs(a.relative()) > std::abs(b.relative());
  });
  return all;
}

std::string text(const MovedValue& moved, std::string_view unit) {
  if (moved.largest->kind == Change::Kind::status_changed) return moved.largest->text;
  const std::string change = formatted("%.4g -> %.4g", moved.largest->before, moved.largest->now) +
                             (unit == "1" || unit.empty() ? "" : " " + std::string(unit));
  return std::isfinite(moved.relative())
             ? formatted("%+.3g %% (", 100 * moved.relative()) + change + ")"
             : change;
}

}  // namespace taut
