#include "experiments/baseline/check.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iostream>
#include <limits>
#include <tuple>
#include <utility>

#include "core/model/text.hpp"
#include "experiments/answer/number.hpp"
#include "experiments/baseline/check_answer.hpp"
#include "experiments/case/fingerprint.hpp"
#include "experiments/study/frontier/parameter_frontier.hpp"
#include "experiments/system/process.hpp"

namespace taut {

namespace {

/// Whether the baseline was made with this program's toolchain. Reports it if not.
bool same_toolchain(const BaselineStudy& study, const BaselineOptions& options, bool strict) {
  const std::string mine(toolchain());
  if (study.toolchain == mine) return true;
  const std::string text = study.name + ": the baseline was made with\n    " + study.toolchain +
                           "\n  this program is made with\n    " + mine;
  if (strict)
    std::cerr << text << '\n';
  else
    options.say(text);
  return false;
}

CheckEnd end_of(const BaselineStudy& study, const Comparison& comparison) {
  if (study.interrupted) return CheckEnd::interrupted;
  if (study.conflict) return CheckEnd::conflict;
  if (comparison.regressed()) return CheckEnd::moved;
  if (comparison.mismatched() || comparison.cases == 0) return CheckEnd::nothing;
  return study.not_run.empty() ? CheckEnd::passed : CheckEnd::not_run;
}

constexpr std::size_t kMostRows = 12;  ///< moved values printed unless all are asked for

/// The largest change of a group: "strip, 2.64 -> 2.81 %".
std::string largest_text(const MovedValue& moved) {
  const Change& change = *moved.largest;
  const Unit unit = unit_of_value(change.value);
  std::string text = change.scene;
  if (moved.group.kind == MovedGroup::Kind::status) return text + ", " + change.text;
  if (moved.group.kind == MovedGroup::Kind::others) text += " " + change.value;
  const auto number = [&](int digits) {
    return std::pair(number_text(change.before * unit.scale, digits),
                     number_text(change.now * unit.scale, digits));
  };
  auto [before, now] = number(3);
  for (int digits = 4; before == now && digits < 17; ++digits)
    std::tie(before, now) = number(digits);
  return text + ", " + before + " -> " + now +
         (unit.shown.empty() ? "" : " " + std::string(unit.shown));
}

/// Collects the comparisons of studies.
class Report {
 public:
  explicit Report(const BaselineOptions& options) : title_of_(options.title) {}
  /// `typed`: the study as the user named it.
  void add(const std::string& typed, const BaselineStudy& study, const Comparison& comparison,
           CheckEnd end) {
    const auto moved = std::ranges::count_if(comparison.findings, &Change::is_regression);
    const auto mismatched = std::ranges::count_if(comparison.findings, &Change::is_mismatch);
    cases_ += comparison.cases;
    values_ += comparison.values;
    const Cell verdict = moved                      ? Cell("moved").toned(Cell::Tone::bad)
                         : mismatched               ? Cell("does not match the study")
                         : end == CheckEnd::passed  ? Cell("passed").toned(Cell::Tone::good)
                         : end == CheckEnd::nothing ? Cell("nothing compared")
                                                    : Cell("not complete");
    studies_.rows.push_back({study.name, verdict, comparison.cases, comparison.values, moved,
                             mismatched, study.not_run.size()});
    if (moved || mismatched)
      accept_ += (accept_.empty() ? "" : "; ") + ("taut baseline update " + shell_word(typed)) +
                 " --why \"...\"";
    add_moved(study, comparison);
    add_mismatches(study, comparison);
    add_findings(findings_, study.name, study.now, comparison);
    for (const std::string& id : study.not_run) not_run_.rows.push_back({study.name, id});
  }
  void add_nothing(const std::string& study, const std::string& why) {
    studies_.rows.push_back({study, "nothing to compare with: " + why, 0, 0, 0, 0, 0});
  }
  std::size_t cases() const { return cases_; }

  Answer answer() {
    Answer all{"check"};
    add_compared(all, cases_, values_);
    findings_.detail = true;
    fill_moved();
    for (Table* table : {&studies_, &findings_, &not_run_, &mismatches_, &moved_})
      all.add(std::move(*table));
    if (!accept_.empty()) all.tables.back().caption = "if this was meant to change: " + accept_;
    return all;
  }

 private:
  void add_moved(const BaselineStudy& study, const Comparison& comparison) {
    for (const MovedValue& m : roll_up(comparison, title_of_)) {
      const bool of_status = m.group.kind == MovedGroup::Kind::status;
      const bool judged = m.group.kind != MovedGroup::Kind::others &&
                          unit_of_value(m.largest->value).less_is_better;
      const auto number = [&](std::size_t n) { return of_status ? Cell() : Cell(n); };
      moved_rows_.push_back(
          {m.group.kind,
           m.relative(),
           {study.name, m.solver, m.group.title(), m.cases, number(m.less), number(m.more),
            largest_text(m), m.relative(), judged ? "less is better" : "", m.largest->id}});
    }
    moved_.most = kMostRows;
  }
  /// Statuses first, then the largest changes.
  void fill_moved() {
    std::ranges::stable_sort(moved_rows_, {}, [](const MovedRow& row) {
      constexpr double kMost = std::numeric_limits<double>::infinity();
      return std::pair(row.kind != MovedGroup::Kind::status,
                       std::isnan(row.relative) ? -kMost : -std::abs(row.relative));
    });
    for (MovedRow& row : moved_rows_) moved_.rows.push_back(std::move(row.cells));
    moved_rows_.clear();
  }
  /// Adds cases and solvers without a counterpart, one row for each kind and solver.
  void add_mismatches(const BaselineStudy& study, const Comparison& comparison) {
    for (const Change& c : comparison.findings) {
      if (!c.is_mismatch()) continue;
      const Cell kind(to_string(c.kind));
      const auto at = std::ranges::find_if(mismatches_.rows, [&](const std::vector<Cell>& row) {
        return row[0] == Cell(study.name) && row[1] == Cell(c.solver) && row[2] == kind;
      });
      if (at == mismatches_.rows.end())
        mismatches_.rows.push_back(
            {study.name, c.solver, kind, 1, c.id.empty() ? "solver " + c.solver : c.id, c.text});
      else
        (*at)[3] = Cell((*at)[3].number() + 1);
    }
    mismatches_.most = kMostRows / 2;
  }

  /// A row of the table of moved values, and the values by which it is sorted.
  struct MovedRow {
    MovedGroup::Kind kind;
    double relative;
    std::vector<Cell> cells;
  };
  std::function<std::string(const std::string& value)> title_of_;
  std::vector<MovedRow> moved_rows_;
  std::size_t cases_ = 0, values_ = 0;
  std::string accept_;
  Table studies_{"studies",
                 "",
                 {{"study"},
                  {"verdict"},
                  {"cases"},
                  {"values"},
                  {"moved"},
                  {"mismatched", "not matching"},
                  {"not_run"}}},
      findings_ = findings_table(), not_run_{"not_run", "not run", {{"study"}, {"case"}}},
      mismatches_{"mismatches",
                  "the baseline does not match the study",
                  {{"study"}, {"solver"}, {"kind"}, {"number"}, {"first"}, {"change"}}},
      moved_{"moved",
             "what moved",
             {{"study"},
              {"solver"},
              {"value"},
              {"cases"},
              {"less", "less in"},
              {"more", "more in"},
              {"largest", "largest change"},
              Column("relative", "relative", kShare),
              {"judged"},
              Column("case").in_detail()}};
};

CheckEnd check_study(const std::string& name, const BaselineOptions& options, bool strict,
                     std::string& xml, Report& report) {
  const BaselineStudy study = baseline_study(name, options, true);
  if (study.before.empty()) {
    const std::string folder = study.folder.parent_path().string();
    report.add_nothing(
        study.name, std::filesystem::is_directory(folder)
                        ? "no baseline in " + printable(study.folder.string()) +
                              "; taut baseline update " + shell_word(name) +
                              " --why \"...\" makes one"
                        : "no folder '" + printable(folder) + "' here; --baselines names another");
    return CheckEnd::nothing;
  }
  const bool same = same_toolchain(study, options, strict);
  if (!same && strict) return CheckEnd::environment;
  const Comparison comparison = study.compare();
  const CheckEnd end = end_of(study, comparison);
  report.add(name, study, comparison, end);
  xml += junit(study.name, study.now, comparison);
  return end;
}

}  // namespace

std::vector<std::string> studies_with_baseline(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none))
    if (entry.is_directory() && entry.path().filename() != kFrontiersFolder)
      names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

Check check_studies(std::vector<std::string> studies, const BaselineOptions& options, bool strict) {
  if (studies.empty()) studies = studies_with_baseline(options.baselines);
  Report report(options);
  if (studies.empty()) report.add_nothing("-", "no baseline in " + options.baselines);
  Check all{{}, studies.empty() ? CheckEnd::nothing : CheckEnd::passed, 0, {}};
  std::string suites;
  for (const std::string& study : studies)
    all.end = std::max(all.end, check_study(study, options, strict, suites, report));
  all.junit =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n" + suites + "</testsuites>\n";
  all.cases = report.cases();
  all.answer = report.answer();
  return all;
}

}  // namespace taut
