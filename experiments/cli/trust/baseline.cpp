#include <set>

#include "core/model/text.hpp"
#include "experiments/baseline/baseline_study.hpp"
#include "experiments/baseline/check_answer.hpp"
#include "experiments/case/fingerprint.hpp"
#include "experiments/command_line/study_options.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/system/files.hpp"

namespace taut::verb::baseline {

namespace {

struct Options : BaselineOptions {
  std::string study, why;
  Format format;
};

/// Whether all cases have results, which a baseline requires. Reports those that were not run.
bool complete(const BaselineStudy& study) {
  for (const std::string& id : study.not_run)
    std::cerr << study.name << ": " << id << ": was not run\n";
  return study.not_run.empty();
}

int early_exit(const BaselineStudy& study) {
  if (study.interrupted) return kInterrupted;
  if (study.conflict) return kConflict;
  return complete(study) ? kPass : kIncomplete;
}

void tell(const BaselineStudy& study, const Comparison& comparison, const Format& format) {
  Answer answer{"baseline", study.name};
  answer.add({"cases", "cases compared"}, comparison.cases);
  Table& table = answer.add(findings_table());
  add_findings(table, study.name, study.now, comparison);
  print(answer, format);
}

int diff(const Options& options) {
  const BaselineStudy study = baseline_study(options.study, options, false);
  if (const int code = early_exit(study); code != kPass) return code;
  const Comparison comparison = study.compare();
  tell(study, comparison, options.format);
  return comparison.findings.empty() ? kPass : kRegression;
}

/// Appends the reason. The file explains, in order of time, why the baseline is what it is.
void note_reason(const BaselineStudy& study, const std::string& why, const Comparison& changes) {
  const std::filesystem::path file = study.folder / "why.md";
  std::string text = std::filesystem::exists(file) ? read_text(file)
                                                   : "# Why the baseline of " + study.name +
                                                         " is what it is, oldest first\n\n";
  std::set<std::string> rows;
  for (const Change& finding : changes.findings) rows.insert(finding.id);
  text += "- " + printable(why) + " (" +
          std::to_string(study.before.empty() ? study.now.size() : rows.size()) + " cases)\n";
  write_durably(study.folder / kToolchainFile, std::string(toolchain()) + "\n");
  write_durably(file, text);
}

int update(Options options) {
  if (options.why.find_first_not_of(" \t\n") == std::string::npos)
    throw InputError("--why must say in a sentence why the baseline moves");
  options.repeat = true;
  const BaselineStudy study = baseline_study(options.study, options, false);
  if (const int code = early_exit(study); code != kPass) return code;
  const Comparison changes = study.compare();
  // A file that cannot be written is reported before anything is printed.
  if (!changes.findings.empty()) {
    write_baseline(study.folder, updated(study.before, study.now, study.tolerances));
    note_reason(study, options.why, changes);
  }
  const bool data = options.format.is_data();
  if (data || !study.before.empty()) tell(study, changes, options.format);
  std::ostream& news = data ? progress() : std::cout;
  if (changes.findings.empty())
    news << study.name << ": " << changes.cases << " cases agree with the baseline; nothing "
         << "was written\n";
  else
    news << study.name << ": " << study.now.size() << " cases in " << study.folder.string() << '\n';
  return kPass;
}

void add_options(Arguments& args, Options& options) {
  add_study(args, options.study).required();
  add_baseline_options(args, options);
  add_format(args, options.format);
}

void add_update_options(Arguments& args, Options& options) {
  args.add_option("--why", options.why, "The reason, kept beside the baseline").required();
  add_options(args, options);
}

}  // namespace
}  // namespace taut::verb::baseline

TAUT_VERB(baseline) = {.name = "baseline",
                       .group = VerbGroup::trust,
                       .summary = "Updates a committed baseline, or shows how it differs",
                       .example =
                           "taut baseline update regression --why \"contacts are continuous\"\n"
                           "  taut baseline diff regression"};

TAUT_VERB(baseline_update) = {
    .name = "baseline update",
    .summary = "Takes differing results as the new baseline",
    .example = "taut baseline update regression --why \"contacts are continuous\"",
    .answer = {{"facts", "cases"},
               {"findings", "study kind case change command solver scene value before now"}},
    .bind =
        taut::bind_verb<taut::verb::baseline::add_update_options, taut::verb::baseline::update>};

TAUT_VERB(baseline_diff) = {
    .name = "baseline diff",
    .summary = "Shows what an update would change (exit 1: something)",
    .example = "taut baseline diff regression",
    .answer = {{"facts", "cases"},
               {"findings", "study kind case change command solver scene value before now"}},
    .bind = taut::bind_verb<taut::verb::baseline::add_options, taut::verb::baseline::diff>};
