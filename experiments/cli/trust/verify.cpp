#include "experiments/truths/verify.hpp"

#include "core/io/text_file.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/baseline/assertion_baseline.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/external/external.hpp"
#include "experiments/external/protocol.hpp"
#include "experiments/results/store.hpp"
#include "experiments/system/files.hpp"
#include "experiments/timing/timing.hpp"
#include "experiments/truths/suite.hpp"

namespace taut::verb::verify {

namespace {

struct Options {
  std::vector<std::string> names, solvers, beside;
  int section = 0, jobs = 2;
  bool assertions = false, update = false, list = false, record = false;
  bool suite = false;
  bool here = false;  ///< whether to check in this process
  Format format;
  std::string baselines, out, scenes;

  bool of_suite() const { return suite || !beside.empty() || !scenes.empty(); }
  /// Whether every truth that an assertion rests on is checked for every solver.
  bool of_all_assertions() const {
    return names.empty() && solvers.empty() && section == 0 && !of_suite();
  }
};

std::vector<const TruthEntry*> choose(const Options& options) {
  for (const std::string& solver : options.solvers)
    if (solver != "reference") parse_solver(solver);
  std::vector<const TruthEntry*> chosen = truths_in_order();
  std::erase_if(chosen, [&](const TruthEntry* truth) {
    const bool named = options.names.empty() || std::ranges::count(options.names, truth->name) > 0;
    const bool within = options.section == 0 || truth->section == options.section;
    return (options.assertions && !is_asserted(*truth)) || !named || !within ||
           (options.of_suite() && truth->phenomenon.empty());
  });
  return chosen;
}

/// Compares the verdicts on assertions with the kept ones, or keeps them.
int compare_with_baseline(const Answer& answer, const Options& options) {
  const std::filesystem::path file = assertion_baseline(options.baselines);
  if (options.update) {
    keep_assertions(answer, file);
    progress() << file.string() << '\n';
    return kPass;
  }
  const auto changes = changes_of_assertions(answer, file);
  if (!changes) {
    std::cerr << "assertions: no baseline " << printable(file.string()) << '\n';
    return options.assertions ? kNothing : kPass;
  }
  for (const Difference& change : *changes)
    std::cerr << "assertion " << printable(change.text) << '\n';
  progress() << answer.table("assertions").rows.size() << " assertions of publications: "
             << (changes->empty() ? "every verdict is as it was"
                                  : std::to_string(changes->size()) + " changed")
             << '\n';
  return changes->empty() ? kPass : kRegression;
}

Answer list_of(const std::vector<const TruthEntry*>& chosen) {
  Answer answer{"verify"};
  Table& table = answer.add(Table{"truths", "", {{"place"}, {"name", "truth"}, {"statement"}}});
  for (const TruthEntry* truth : chosen)
    table.rows.push_back({place_of(*truth), truth->name, truth->statement});
  return answer;
}

/// Writes the scenes of the suite, as programs get them: those that the solver runs.
int write_scenes(const Options& options) {
  const std::string solver = options.solvers.empty() ? "xpbd" : options.solvers.front();
  parse_solver(solver);
  std::filesystem::create_directories(options.scenes);
  Answer answer{"verify", "scenes of conformance suite " + std::to_string(kSuiteVersion)};
  Table table{"scenes", "", {{"phenomenon"}, {"test"}, {"file"}}};
  for (const TruthEntry* truth : choose(options)) {
    int count = 0;
    Findings findings({solver});
    findings.watch([&](const Scene& scene) {
      const std::string name = std::string(truth->name) + "-" + std::to_string(++count) + ".json";
      write_file(std::filesystem::path(options.scenes) / name, external::scene_file(scene));
      table.rows.push_back({truth->phenomenon, truth->name, name});
    });
    truth->check(findings);
  }
  answer.add(std::move(table));
  print(answer, options.format);
  return kPass;
}

/// Whether the text names a file with an earlier result of the suite, and no solver.
bool is_result(const std::string& text) { return text.ends_with(".json"); }

/// Runs the suite for each engine, or reads what it found before.
int run_suite(const Options& options) {
  std::vector<std::string> engines = options.solvers;
  engines.insert(engines.end(), options.beside.begin(), options.beside.end());
  if (engines.empty())
    for (const SolverEntry* entry : solvers()) engines.emplace_back(entry->name);
  for (const std::string& engine : engines)
    if (!is_result(engine)) parse_solver(engine);
  const std::string ours = "taut " TAUT_VERSION " " + program_digest().substr(0, 10);
  std::vector<Conformance> all;
  for (const std::string& engine : engines) {
    if (is_result(engine)) {
      for (Conformance& one : conformances_in(answer_from_json(read_text(engine), engine)))
        all.push_back(std::move(one));
      continue;
    }
    const Verification found = taut::verify({.truths = choose(options),
                                             .solvers = {engine},
                                             .jobs = options.jobs,
                                             .progress = Countdown("test")});
    all.push_back(conformance_of(engine, found.truths, ours, machine_name()));
  }
  const Answer answer = answer_of(all);
  if (options.record) {
    Store store(options.out);
    store.prepare();
    store.keep(answer);
  }
  print(answer, options.format);
  bool failed = false, any = false;
  for (const Conformance& one : all)
    for (const Conformance::Number& n : one.numbers) {
      failed = failed || n.finding.verdict == TruthVerdict::broken;
      any = any || n.finding.verdict != TruthVerdict::not_applicable;
    }
  return failed ? kRegression : any ? kPass : kNothing;
}

int run(const Options& options) {
  if (options.list) {
    print(list_of(choose(options)), options.format);
    return kPass;
  }
  if (options.update && !(options.assertions && options.of_all_assertions()))
    throw InputError(
        "--update keeps the verdicts of all assertions: taut verify --assertions --update");
  const std::vector<const TruthEntry*> truths = choose(options);
  // The suite finds what the quick probe finds, and names it.
  if (std::ranges::none_of(truths, &std::string_view::empty, &TruthEntry::phenomenon))
    external::run_unprobed();
  if (!options.scenes.empty()) return write_scenes(options);
  if (options.of_suite()) return run_suite(options);
  const Verification found = taut::verify({.truths = truths,
                                           .solvers = options.solvers,
                                           .jobs = options.jobs,
                                           .here = options.here,
                                           .progress = Countdown("truth")});
  const Answer answer = answer_of(found, options.assertions);
  if (options.record) {
    Store store(options.out);
    store.prepare();
    store.keep(answer);
  }
  print(answer, options.format);
  const VerdictCounts verdicts = verdicts_of(found.truths);
  progress() << verdicts.text() << '\n';
  const bool any = verdicts[TruthVerdict::passed] + verdicts[TruthVerdict::deviates] > 0;
  const int code = verdicts.broken_truths > 0 ? kRegression : any ? kPass : kNothing;
  if (!options.of_all_assertions()) return code;
  const int assertions = compare_with_baseline(answer, options);
  return code == kPass ? assertions : code;
}

void add_options(Arguments& args, Options& options) {
  std::vector<std::string> names;
  for (const TruthEntry* truth : truths()) names.emplace_back(truth->name);
  args.add_option("TRUTH", options.names, "Names of truths (default: all)")
      .check(known("truth", std::move(names)));
  args.add_option(own_words::kSolver, options.solvers,
                  "Only findings of these solvers (\"reference\": of the references)");
  args.add_option("--section", options.section, "Only one section of the truths")
      .check(in_range(1, 11));
  args.add_option("-j,--jobs", options.jobs,
                  "Truths at a time, each in a process of its own (default: " +
                      std::to_string(options.jobs) + ")")
      .check(in_range(1, 64));
  args.add_flag("--suite", options.suite,
                "Only the conformance suite: one test of each phenomenon, engine by engine")
      .excludes("--assertions");
  args.add_option("--beside", options.beside,
                  "The suite for these solvers side by side; a file.json is what --suite --json "
                  "found before")
      .excludes("--assertions");
  args.add_option("--scenes", options.scenes,
                  "Write the scenes of the suite into this folder, for programs that read files")
      .excludes("--assertions");
  add_record(args, options.record);
  add_results(args, options.out);
  args.add_flag("--assertions", options.assertions,
                "Only the truths behind assertions of publications, and the verdicts");
  add_baselines(args, options.baselines);
  args.add_flag("--update", options.update,
                "With --assertions: keep their verdicts as the baseline");
  add_format(args, options.format, "Every number, with sources and times");
  args.add_flag("--list", options.list, "Only name the truths");
  args.add_flag(own_words::kHere, options.here, "Check in this process (internal)").hidden();
}

}  // namespace

}  // namespace taut::verb::verify

TAUT_VERB(verify) = {
    .name = own_words::kVerify,
    .group = VerbGroup::trust,
    .summary = "Compares solvers and metrics with closed forms and published numbers",
    .example =
        "taut verify --section 4 --solver jakobsen\n"
        "  taut verify hanging-chain-sweeps --all\n"
        "  taut verify --assertions\n"
        "  taut verify --suite --solver \"external:cmd='python3 mine.py'\" --json\n"
        "  taut verify --beside mine.json jakobsen bullet\n"
        "Exit: 0 no truth is broken, no verdict of an assertion changed; 1 one is or "
        "did; 4 nothing was compared",
    .answer =
        {{"truths",
          "verdict place name numbers nearest section section_title statement source seconds"},
         {"findings",
          "verdict truth subject quantity unit measured expected tolerance uncertainty why"},
         {"assertions", "source section verdict assertion figure"},
         {"broken", "*"},
         {"engines",
          "engine version passed deviates failed not_claimed first_failed solver suite machine"},
         {"phenomena", "*"},
         {"scenes", "phenomenon test file"},
         {"numbers",
          "engine version solver phenomenon test needs verdict quantity unit value closed_form "
          "ratio tolerance why"}},
    .bind = taut::bind_verb<taut::verb::verify::add_options, taut::verb::verify::run>};
