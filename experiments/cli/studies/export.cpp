#include "experiments/command_line/study_options.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/system/files.hpp"
#include "experiments/timing/study_csv.hpp"

namespace taut::verb::exporting {

namespace {

struct Options {
  std::string study, preset, results, output;
  bool tidy = false, series = false;
};

int run(const Options& options) {
  const Study study = load_study(options.study, options.preset);
  const Store store(options.results);
  std::optional<StudyCsv> csv;
  if (store.reading())
    csv.emplace(study, store);
  else
    each_case(study, [](Case&&) {});  // reports errors of the study first
  if (!csv || csv->stored() == 0)
    throw InputError("no case of study '" + study.name + "' is in " + options.results +
                     " as this build would run it; taut run " + study_words(study) + " makes them" +
                     where_else(study, store));
  const std::string text = options.series ? csv->series()
                           : options.tidy ? csv->tidy()
                                          : csv->wide();
  if (options.output.empty()) {
    std::cout << text;
  } else {
    write_durably(options.output, text);
    std::cout << options.output << '\n';
  }
  const std::int64_t not_run = csv->not_run(), damaged = csv->damaged();
  if (not_run > 0)
    progress() << not_run << " cases were not run" << where_else(study, store) << '\n';
  if (damaged > 0) progress() << damaged << " cases are damaged and left empty\n";
  return not_run + damaged > 0 ? kIncomplete : kPass;
}

void add_options(Arguments& args, Options& options) {
  add_study(args, options.study).required();
  add_stored(args, options.preset, options.results);
  args.add_flag("--tidy", options.tidy, "A row for each value of each case");
  args.add_flag("--series", options.series, "A row for each value over time of each case")
      .excludes("--tidy");
  add_output(args, options.output, "File (default: standard output)");
}

}  // namespace
}  // namespace taut::verb::exporting

TAUT_VERB(export) = {
    .name = "export",
    .group = VerbGroup::studies,
    .summary = "Writes a study as CSV in SI units: a row for each case, each value or each moment",
    .example = R"(taut export iterations --preset quick -o x.csv
  taut export iterations --series -o motion.csv
Python:
  import pandas
  cases = pandas.read_csv("x.csv").query("status == 'ok'")
  print(cases.pivot_table("stretch.rms", ["scene", "iterations"], "solver"))
Exit: 0 every case is there; 3 some were not run or are damaged (their status says so))",
    .bind = taut::bind_verb<taut::verb::exporting::add_options, taut::verb::exporting::run>};
