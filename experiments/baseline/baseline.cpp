#include "experiments/baseline/baseline.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <tuple>

#include "core/model/input_error.hpp"
#include "core/model/names.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/answer/number.hpp"
#include "experiments/system/process.hpp"

namespace taut {

namespace {

RowStatus row_status(const Status& status) {
  const bool with_reason = status.kind != Status::Kind::unsupported;
  return {std::string(to_string(status.kind)), with_reason ? status.reason.text() : ""};
}

std::string readable(double value) { return std::isnan(value) ? "none" : number_text(value, 7); }

/// "stretch.max 0.0123 -> 0.0145 (by 0.0022, allowed 1e-06)".
std::string moved_text(const std::string& name, double before, double now, const Tolerance& t) {
  std::string text = name + " " + readable(before) + " -> " + readable(now);
  if (readable(before) == readable(now))  // the difference lies beyond the seventh digit
    text = name + " " + general(before, 17) + " -> " + general(now, 17);
  if (std::isnan(before) || std::isnan(now)) return text;
  const double allowed = t.absolute + t.relative * std::abs(before);
  return text + " (by " + number_text(now - before) + ", allowed " + number_text(allowed) + ")";
}

/// The number rounded to as few digits as the tolerance allows.
double rounded(double value, const Tolerance& t) {
  if (!std::isfinite(value)) return value;
  const double slack = (t.absolute + t.relative * std::abs(value)) / 100;
  for (int count = 1; count < 17; ++count) {
    const double shorter = rounded_to(value, count);
    if (std::abs(shorter - value) <= slack) return shorter;
  }
  return value;
}

/// Compares two rows that ask the same question.
class RowComparison {
 public:
  RowComparison(const BaselineRow& before, const BaselineRow& now, const Tolerances& tolerances,
                const std::set<std::string>& known, Comparison& result)
      : now_(now), result_(result) {
    ++result_.cases;
    if (before.status != now.status) {
      add(Change::Kind::status_changed,
          "status " + before.status.text() + " -> " + now.status.text());
      result_.findings.back().scene = now_.spec.scene;
      result_.findings.back().value = "status";
    }
    if (before.flaky || now.flaky) {
      if (!before.flaky) add(Change::Kind::value_new, "does not repeat bit for bit: now flaky");
      return;
    }
    if (before.projections != now.projections)
      move(kProjections, static_cast<double>(before.projections),
           static_cast<double>(now.projections),
           "projections per step " + std::to_string(before.projections) + " -> " +
               std::to_string(now.projections));
    for (const ComparedValue& one : compare_values(before.values, now.values, tolerances))
      add(one, tolerances.of(one.value), known.contains(one.value));
  }

 private:
  void add(Change::Kind kind, const std::string& text) {
    result_.findings.push_back({kind, now_.id, now_.solver(), text});
  }
  void move(const std::string& name, double before, double now, const std::string& text) {
    add(Change::Kind::value_moved, text);
    Change& change = result_.findings.back();
    change.scene = now_.spec.scene;
    change.value = name;
    change.before = before;
    change.now = now;
  }
  void add(const ComparedValue& one, const Tolerance& tolerance, bool known) {
    using Kind = ComparedValue::Kind;
    if (one.kind == Kind::lost)
      add(Change::Kind::value_missing,
          one.value + " " + readable(one.before) + " -> no such value");
    if (one.kind == Kind::gained && !std::isnan(one.now))
      add(known ? Change::Kind::value_unrecorded : Change::Kind::value_new,
          one.value + " has no baseline" + (known ? " in this row alone" : "") + "; now " +
              readable(one.now));
    if (one.kind == Kind::lost || one.kind == Kind::gained) return;
    ++result_.values;
    if (one.kind == Kind::moved)
      move(one.value, one.before, one.now, moved_text(one.value, one.before, one.now, tolerance));
  }

  const BaselineRow& now_;
  Comparison& result_;
};

bool same_question(const BaselineRow& a, const BaselineRow& b) {
  return a.scene == b.scene && a.spec.solver == b.spec.solver && a.frontier == b.frontier;
}

std::set<std::string> solvers_of(const Baseline& rows) {
  std::set<std::string> names;
  for (const BaselineRow& row : rows) names.insert(row.solver());
  return names;
}

/// A row of `in` that asks the same question as `row` under an id that `own` does not have.
const BaselineRow* renamed(const BaselineRow& row, const Baseline& in, const Baseline& own) {
  for (const BaselineRow& other : in)
    if (same_question(row, other) && !find_row(own, other.id)) return &other;
  return nullptr;
}

void compare_case(const BaselineRow& row, const Baseline& before, const Baseline& now,
                  const Tolerances& tolerances, const std::set<std::string>& known,
                  Comparison& result) {
  const auto add = [&](Change::Kind kind, const std::string& text) {
    result.findings.push_back({kind, row.id, row.solver(), text});
  };
  const BaselineRow* old = find_row(before, row.id);
  if (!old) {
    const BaselineRow* other = renamed(row, before, now);
    if (other)
      add(Change::Kind::case_renamed, "renamed: the baseline calls it '" + other->id + "'");
    else
      add(Change::Kind::case_new, "new: the baseline does not have this case");
  } else if (old->scene != row.scene) {
    add(Change::Kind::scene_changed, "the scene changed: content " + old->scene.substr(0, 12) +
                                         " -> " + row.scene.substr(0, 12));
  } else {
    RowComparison(*old, row, tolerances, known, result);
  }
}

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

const BaselineRow* find_row(const Baseline& rows, const std::string& id) {
  const auto at = std::ranges::find(rows, id, &BaselineRow::id);
  return at == rows.end() ? nullptr : &*at;
}

BaselineRow baseline_row(const Record& record, const std::string& scene) {
  BaselineRow row{record.id,          record.spec,  scene, row_status(record.status),
                  record.projections, record.values};
  row.spec.solver = parse_solver(record.spec.solver).brief();
  return row;
}

bool Comparison::regressed() const { return std::ranges::any_of(findings, &Change::is_regression); }
bool Comparison::mismatched() const { return std::ranges::any_of(findings, &Change::is_mismatch); }

Comparison compare(const Baseline& before, const Baseline& now, const Tolerances& tolerances) {
  Comparison result;
  const auto old_solvers = solvers_of(before), new_solvers = solvers_of(now);
  for (const std::string& solver : old_solvers)
    if (!new_solvers.count(solver))
      result.findings.push_back({Change::Kind::solver_missing, "", solver,
                                 "the baseline has this solver, the study does not run it"});
  for (const std::string& solver : new_solvers)
    if (!old_solvers.count(solver))
      result.findings.push_back({Change::Kind::solver_new, "", solver,
                                 "the study runs this solver, which has no baseline"});
  std::set<std::string> known;  // values of some row; any other value belongs to a new metric
  for (const BaselineRow& row : before)
    for (const auto& [name, value] : row.values) known.insert(name);
  for (const BaselineRow& row : now)
    if (old_solvers.count(row.solver())) compare_case(row, before, now, tolerances, known, result);
  for (const BaselineRow& row : before)
    if (new_solvers.count(row.solver()) && !find_row(now, row.id) && !renamed(row, now, before))
      result.findings.push_back({Change::Kind::case_missing, row.id, row.solver(),
                                 "missing: the study does not have this case of the baseline"});
  std::stable_sort(result.findings.begin(), result.findings.end(),
                   [](const Change& a, const Change& b) {
                     return std::tie(a.solver, a.id) < std::tie(b.solver, b.id);
                   });
  return result;
}

Baseline updated(const Baseline& before, const Baseline& now, const Tolerances& tolerances) {
  Baseline rows;
  for (BaselineRow row : now) {
    const BaselineRow* old = find_row(before, row.id);
    if (old && !same_question(*old, row)) old = nullptr;
    std::erase_if(row.values, [&](const auto& v) { return tolerances.of(v.first).ignored; });
    for (auto& [name, value] : row.values) {
      const Tolerance& tolerance = tolerances.of(name);
      const auto was = old ? old->values.find(name) : row.values.end();
      const bool kept = old && was != old->values.end() && tolerance.holds(value, was->second);
      value = kept ? was->second : rounded(value, tolerance);
    }
    rows.push_back(std::move(row));
  }
  std::ranges::sort(rows, {}, &BaselineRow::id);
  return rows;
}

static std::string command_of(const std::string& verb, const CaseSpec& spec) {
  std::string command =
      "taut " + verb + " " + shell_word(spec.scene) + " " + shell_word(spec.solver);
  for (const SceneSetting& one : spec.settings) command += " --set " + shell_word(one.text());
  return command;
}

std::string reproduce(const CaseSpec& spec) { return command_of("case", spec); }

std::string reproduce(const BaselineRow& row) {
  if (row.frontier.empty()) return reproduce(row.spec);
  return command_of("frontier", row.spec) + " " + row.frontier;
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

double MovedValue::relative() const { return relative_change(largest->before, largest->now); }

std::string MovedGroup::title() const {
  switch (kind) {
    case Kind::status:
      return "status";
    case Kind::projections:
      return kProjections;
    case Kind::titled:
      return value_title;
    case Kind::others:
      break;
  }
  return "other values";
}

MovedGroup group_of(const Change& change,
                    const std::function<std::string(const std::string&)>& title_of) {
  using Kind = MovedGroup::Kind;
  if (change.kind == Change::Kind::status_changed) return {Kind::status};
  if (change.value == kProjections) return {Kind::projections};
  const std::string title = title_of(change.value);
  return title.empty() ? MovedGroup{Kind::others} : MovedGroup{Kind::titled, title};
}

std::vector<MovedValue> roll_up(const Comparison& comparison,
                                const std::function<std::string(const std::string&)>& title_of) {
  std::vector<MovedValue> all;
  for (const Change& c : comparison.findings) {
    if (!c.is_regression()) continue;
    const MovedGroup group = group_of(c, title_of);
    auto at = std::ranges::find_if(
        all, [&](const MovedValue& m) { return m.solver == c.solver && m.group == group; });
    if (at == all.end()) at = all.insert(all.end(), MovedValue{c.solver, group});
    ++at->cases;
    at->less += c.now < c.before;
    at->more += c.now > c.before;
    if (!at->largest || std::abs(relative_change(c.before, c.now)) > std::abs(at->relative()))
      at->largest = &c;
  }
  return all;
}

namespace {
constexpr Names<Change::Kind::value_new> kKinds{
    "value moved",   "status changed",   "case missing",   "case new",
    "case renamed",  "scene changed",    "solver missing", "solver new",
    "value missing", "value unrecorded", "value new"};
}

std::string_view to_string(Change::Kind kind) { return kKinds[kind]; }

Change::Kind change_kind(std::string_view name) {
  if (const auto kind = kKinds.find(name)) return *kind;
  throw InputError("unknown kind of change '" + std::string(name) + "'");
}

}  // namespace taut
