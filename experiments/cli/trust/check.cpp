#include "experiments/baseline/check.hpp"

#include "experiments/command_line/study_options.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/system/files.hpp"
#include "experiments/timing/two_builds.hpp"

namespace taut::verb::check {

namespace {

struct Options : BaselineOptions {
  std::vector<std::string> studies;
  std::string junit, against = "before";
  bool strict = false, record = false, speed = false;
  Format format;
};

/// Adds the cost of each case relative to the kept build. Returns whether any case is slower.
bool add_speed(Answer& answer, const std::vector<std::string>& studies, const Options& options) {
  const std::filesystem::path folder = folder_of_build(options.out, options.against);
  Store store(options.out);
  std::vector<TwoBuilds> all;
  for (const std::string& name : studies) {
    const Study study = load_study(name);
    const auto found = time_two_builds(cases_of_two(collect(study, store).records, folder),
                                       {.seconds = 0.02, .progress = Countdown("case")});
    all.insert(all.end(), found.begin(), found.end());
  }
  answer.add(table_of(all, "speed", options.against));
  return any_slower(all);
}

int check(const Options& options) {
  // Reports errors before anything runs.
  if (options.speed) folder_of_build(options.out, options.against);
  Check found = check_studies(options.studies, options, options.strict);
  if (options.speed && found.end != CheckEnd::interrupted) {
    const auto studies =
        options.studies.empty() ? studies_with_baseline(options.baselines) : options.studies;
    if (add_speed(found.answer, studies, options)) found.end = std::max(found.end, CheckEnd::moved);
  }
  if (!options.junit.empty()) write_file(options.junit, found.junit);
  if (options.record && found.cases > 0) Store(options.out).keep(found.answer);
  print(found.answer, options.format);
  return exit_code(found.end);
}

void add_options(Arguments& args, Options& options) {
  args.add_option("STUDY", options.studies,
                  "Names or paths of studies; none: all that have a baseline");
  add_baseline_options(args, options);
  args.add_option("--junit", options.junit, "Also write a JUnit file for continuous integration");
  args.add_flag(
      "--speed", options.speed,
      "Also time every case in turns with the build of --against; exit 1 if this one is slower");
  args.add_option("--against", options.against,
                  "A folder with another build of taut, or the name of a kept one (taut bench "
                  "--keep-build)")
      .shows_default("before")
      .needs("--speed");
  add_format(args, options.format, "Print every change with the command that runs its case");
  add_record(args, options.record);
  args.add_flag("--strict-env", options.strict,
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
        "  taut bench --keep-build before && taut check regression --speed\n"
        "Exit: 0 nothing moved; 1 a value or status moved, or it got slower; 3 cases were not "
        "run;\n      4 nothing compared, or the baseline does not match the "
        "study;\n      5 another toolchain under --strict-env",
    .answer = {{"facts", "cases values"},
               {"studies", "study verdict cases values moved mismatched not_run"},
               {"findings", "study kind case change command solver scene value before now"},
               {"not_run", "study case"},
               {"mismatches", "study solver kind number first change"},
               {"moved", "study solver value cases less more largest relative judged case"},
               {"speed", "case ratio control verdict wall wall_control"}},
    .bind = taut::bind_verb<taut::verb::check::add_options, taut::verb::check::check>};
