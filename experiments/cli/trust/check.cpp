#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/fingerprint.hpp"
#include "experiments/command_line/baseline_study.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/study/frontier/parameter_frontier.hpp"
#include "experiments/system/files.hpp"

namespace taut::verb::check {

namespace {

struct Options : BaselineOptions {
  std::vector<std::string> studies;
  std::string junit;
  bool strict = false, record = false, json = false;
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

void summarise(const BaselineStudy& study, const Comparison& comparison) {
  const auto moved = std::ranges::count_if(comparison.findings, &Change::is_regression);
  const auto mismatched = std::ranges::count_if(comparison.findings, &Change::is_mismatch);
  std::cout << study.name << ": " << comparison.cases << " cases and " << comparison.values
            << " values compared, "
            << coloured(std::to_string(moved) + " moved", moved ? Colour::red : Colour::green);
  if (mismatched) std::cout << ", " << mismatched << " do not match the study";
  if (!study.not_run.empty()) std::cout << ", " << study.not_run.size() << " not run";
  std::cout << '\n';
  if (moved || mismatched)
    std::cout << "  if this was meant to change: taut baseline update " << study.name
              << " --why \"...\"\n";
}

Unit unit_of(const std::string& value) {
  const ValueSpec* spec = find_value(value).second;
  return spec ? spec->unit : kNumber;
}

/// "better in 3, worse in 1": of an error; "" of what has neither.
std::string judged(const MovedValue& moved) {
  if (!unit_of(moved.value).less_is_better || moved.less + moved.more == 0) return "";
  std::string text;
  if (moved.less > 0) text += "; better in " + std::to_string(moved.less);
  if (moved.more > 0)
    text += (text.empty() ? "; " : ", ") + ("worse in " + std::to_string(moved.more));
  return text;
}

/// By scene and value: in how many cases it moved, and how far in the one that moved most.
void print_roll_up(const Comparison& comparison) {
  std::vector<Row> rows;
  for (const MovedValue& moved : roll_up(comparison))
    rows.push_back({moved.scene, moved.value,
                    std::to_string(moved.cases) + (moved.cases == 1 ? " case," : " cases,"),
                    "largest change " + text(moved, unit_of(moved.value).si) + judged(moved)});
  if (!rows.empty()) print_columns(rows, 2);
}

/// What the report reads: how much was compared, and what differs.
struct Notes {
  std::size_t cases = 0, values = 0;
  Json findings = Json::array(), studies = Json::array();

  void add(const BaselineStudy& study, const Comparison& comparison) {
    cases += comparison.cases, values += comparison.values;
    for (const Change& f : comparison.findings)
      if (f.is_regression() || f.is_mismatch())
        findings.push_back(
            {{"study", study.name}, {"case", f.id.empty() ? f.solver : f.id}, {"change", f.text}});
    const auto moved = [](const MovedValue& m) -> Json {
      return {{"scene", m.scene},
              {"value", m.value},
              {"unit", unit_of(m.value).si},
              {"cases", m.cases},
              {"less", m.less},
              {"more", m.more},
              {"less_is_better", unit_of(m.value).less_is_better},
              {"largest_change", {{"case", m.largest->id}, {"text", m.largest->text}}}};
    };
    studies.push_back({{"study", study.name},
                       {"cases", comparison.cases},
                       {"values", comparison.values},
                       {"moved", json_array(roll_up(comparison), moved)},
                       {"not_run", study.not_run}});
  }
  void write(const std::string& results) const {
    write_file(std::filesystem::path(results) / "check.json",
               to_text(Json{{"schema", "taut-check-1"},
                            {"program", program_digest()},
                            {"cases", cases},
                            {"values", values},
                            {"findings", findings}},
                       1) +
                   "\n");
  }
};

int check_study(const std::string& name, const Options& options, std::string& xml, Notes& notes) {
  const BaselineStudy study = baseline_study(name, options, true);
  if (study.before.empty()) {
    const std::string folder = study.folder.parent_path().string();
    std::ostream& out = options.json ? std::cerr : std::cout;
    out << study.name << ": nothing to compare with: ";
    if (std::filesystem::is_directory(folder))
      out << "no baseline in " << printable(study.folder.string()) << "; taut baseline update "
          << study.name << " --why \"...\" makes one\n";
    else
      out << "no folder '" << printable(folder) << "' here; --baselines names another\n";
    return kNothing;
  }
  const bool same = same_toolchain(study, options.strict);
  if (!same && options.strict) return kEnvironment;
  const Comparison comparison = study.compare();
  notes.add(study, comparison);
  if (!options.json) {
    summarise(study, comparison);
    print_roll_up(comparison);
    print_findings(study, comparison);
    for (const std::string& id : study.not_run)
      std::cout << study.name << ": " << id << ": was not run\n";
  }
  xml += junit(study.name, study.now, comparison);
  return exit_code(study, comparison);
}

int check(Options options) {
  if (options.studies.empty()) options.studies = studies_with_baseline(options.baselines);
  if (options.studies.empty()) {
    (options.json ? std::cerr : std::cout)
        << "nothing to compare with: no baseline in " << options.baselines << '\n';
    return kNothing;
  }
  int code = kPass;
  std::string suites;
  Notes notes;
  for (const std::string& study : options.studies)
    code = worse(code, check_study(study, options, suites, notes));
  if (!options.junit.empty())
    write_file(options.junit, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n" +
                                  suites + "</testsuites>\n");
  if (options.record && notes.cases > 0) notes.write(options.out);
  if (options.json) print_json(Json{{"studies", notes.studies}, {"findings", notes.findings}});
  return code;
}

void add_options(CLI::App& app, Options& options) {
  app.add_option("STUDY", options.studies, "Names or paths; none: all that have a baseline");
  options.bind(app);
  app.add_option("--junit", options.junit, "Also write a JUnit file for continuous integration");
  add_json(app, options.json, "What moved, by scene and value, and every finding,");
  app.add_flag("--record", options.record, "Also keep the findings for the report");
  app.add_flag("--strict-env", options.strict,
               "Fail with 5 if the baseline was made with another toolchain");
}

}  // namespace
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
    .bind = taut::bind_verb<taut::verb::check::add_options, taut::verb::check::check>};
