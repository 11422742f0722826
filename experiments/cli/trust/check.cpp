#include <tuple>

#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/fingerprint.hpp"
#include "experiments/cli/calls.hpp"
#include "experiments/command_line/baseline_study.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/study/frontier/parameter_frontier.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/process.hpp"

namespace taut::verb::check {

namespace {

struct Options : BaselineOptions {
  std::vector<std::string> studies;
  std::string junit;
  bool strict = false, record = false;
  Format format;
};

/// Names of the studies that have a baseline, sorted.
std::vector<std::string> studies_with_baseline(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none))
    if (entry.is_directory() && entry.path().filename() != kFrontiersFolder)
      names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

/// The worse of two: an alarm before a regression, that before a baseline that does not match, that
/// before what was not run.
int worse(int a, int b) {
  for (const int code : {kInterrupted, kConflict, kEnvironment, kRegression, kNothing, kIncomplete})
    if (a == code || b == code) return code;
  return kPass;
}

bool same_toolchain(const BaselineStudy& study, bool strict) {
  if (study.toolchain == toolchain()) return true;
  (strict ? std::cerr : progress())
      << study.name << ": the baseline was made with\n    " << study.toolchain
      << "\n  this program is made with\n    " << toolchain() << '\n';
  return false;
}

int exit_code(const BaselineStudy& study, const Comparison& comparison) {
  if (study.interrupted) return kInterrupted;
  if (study.conflict) return kConflict;
  if (comparison.regressed()) return kRegression;
  if (comparison.mismatched() || comparison.cases == 0) return kNothing;
  return study.not_run.empty() ? kPass : kIncomplete;
}

constexpr std::size_t kMostRows = 12;  ///< of what moved, printed unless all is asked for
constexpr const char* kOthers = "other values";

/// The value's title if charts and claims tell of it.
std::string group_of(const std::string& value) {
  const ValueSpec* spec = find_value(value).second;
  if (value == "status" || value == "projections") return value;
  return spec && spec->role != Role::none ? report::quantity(value).title : kOthers;
}

/// "strip, 2.64 -> 2.81 %": the largest change.
std::string largest_text(const Change& change) {
  const Unit unit = unit_of_value(change.value);
  std::string text = change.scene;
  if (change.kind == Change::Kind::status_changed) return text + ", " + change.text;
  if (group_of(change.value) == kOthers) text += " " + change.value;
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

/// What the studies' comparisons come to.
class Report {
 public:
  /// `typed`: as the study was asked for.
  void add(const std::string& typed, const BaselineStudy& study, const Comparison& comparison,
           int code) {
    const auto moved = std::ranges::count_if(comparison.findings, &Change::is_regression);
    const auto mismatched = std::ranges::count_if(comparison.findings, &Change::is_mismatch);
    cases_ += comparison.cases, values_ += comparison.values;
    const char* verdict = moved              ? "moved"
                          : mismatched       ? "does not match the study"
                          : code == kPass    ? "passed"
                          : code == kNothing ? "nothing compared"
                                             : "not complete";
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
    for (Table* table : {&studies_, &findings_, &not_run_, &mismatches_, &moved_})
      all.add(std::move(*table));
    if (!accept_.empty()) all.tables.back().caption = "if this was meant to change: " + accept_;
    return all;
  }

 private:
  void add_moved(const BaselineStudy& study, const Comparison& comparison) {
    for (const MovedValue& m : roll_up(comparison, group_of)) {
      const bool judged = m.group != kOthers && unit_of_value(m.largest->value).less_is_better;
      const auto number = [&](std::size_t n) { return m.group == "status" ? Cell() : Cell(n); };
      moved_.rows.push_back({study.name, m.solver, m.group, m.cases, number(m.less), number(m.more),
                             largest_text(*m.largest), m.relative(), judged ? "less is better" : "",
                             m.largest->id});
    }
    std::ranges::stable_sort(moved_.rows, {}, [](const std::vector<Cell>& row) {
      const std::string group = row[2].text();
      return group == "status" ? 0 : group == kOthers ? 2 : 1;
    });
    moved_.most = kMostRows;
  }
  /// Cases and solvers without a counterpart, a row for each kind and solver.
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

int check_study(const std::string& name, const Options& options, std::string& xml, Report& report) {
  const BaselineStudy study = baseline_study(name, options, true);
  if (study.before.empty()) {
    const std::string folder = study.folder.parent_path().string();
    report.add_nothing(
        study.name, std::filesystem::is_directory(folder)
                        ? "no baseline in " + printable(study.folder.string()) +
                              "; taut baseline update " + shell_word(name) +
                              " --why \"...\" makes one"
                        : "no folder '" + printable(folder) + "' here; --baselines names another");
    return kNothing;
  }
  const bool same = same_toolchain(study, options.strict);
  if (!same && options.strict) return kEnvironment;
  const Comparison comparison = study.compare();
  const int code = exit_code(study, comparison);
  report.add(name, study, comparison, code);
  xml += junit(study.name, study.now, comparison);
  return code;
}

/// What the studies come to, and the exit code.
std::pair<Answer, int> compare_all(Options options) {
  if (options.studies.empty()) options.studies = studies_with_baseline(options.baselines);
  Report report;
  if (options.studies.empty()) report.add_nothing("-", "no baseline in " + options.baselines);
  int code = options.studies.empty() ? kNothing : kPass;
  std::string suites;
  for (const std::string& study : options.studies)
    code = worse(code, check_study(study, options, suites, report));
  if (!options.junit.empty())
    write_file(options.junit, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n" +
                                  suites + "</testsuites>\n");
  const bool record = options.record && report.cases() > 0;
  Answer answer = report.answer();
  if (record) Store(options.out).keep(answer);
  return {std::move(answer), code};
}

int check(const Options& options) {
  const auto [answer, code] = compare_all(options);
  print(answer, options.format);
  return code;
}

void add_options(CLI::App& app, Options& options) {
  app.add_option("STUDY", options.studies, "Names or paths; none: all that have a baseline");
  options.bind(app);
  app.add_option("--junit", options.junit, "Also write a JUnit file for continuous integration");
  add_format(app, options.format, "Print every change with the command that runs its case");
  app.add_flag("--record", options.record, "Also keep the findings for the report");
  app.add_flag("--strict-env", options.strict,
               "Fail with 5 if the baseline was made with another toolchain");
}

}  // namespace

Answer check_all(int jobs, const std::string& results) {
  Options options;
  options.jobs = jobs, options.out = results, options.record = true;
  options.baselines = results_folder() / "baselines";
  auto [answer, code] = compare_all(options);
  if (code == kInterrupted) throw Interrupted();
  return answer;
}

}  // namespace taut::verb::check

TAUT_VERB(check) = {
    .name = "check",
    .group = VerbGroup::trust,
    .summary =
        "Compares studies with their committed baselines; runs what is "
        "missing",
    .example =
        "taut check\n  taut check regression --junit check.xml\n"
        "Exit: 0 nothing moved; 1 a value or status moved; 3 cases were not "
        "run;\n      4 nothing compared, or the baseline does not match the "
        "study;\n      5 another toolchain under --strict-env",
    .answer =
        "cases values; "
        "studies: study verdict cases values moved mismatched not_run; "
        "findings: study kind case change command solver scene value before now; "
        "not_run: study case; "
        "mismatches: study solver kind number first change; "
        "moved: study solver value cases less more largest relative judged case",
    .bind = taut::bind_verb<taut::verb::check::add_options, taut::verb::check::check>};
