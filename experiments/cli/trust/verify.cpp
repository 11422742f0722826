#include <atomic>
#include <cmath>
#include <exception>
#include <fstream>
#include <mutex>
#include <thread>

#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/cli/calls.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/process.hpp"
#include "experiments/truths/assertions/assertions.hpp"
#include "experiments/truths/truth.hpp"
#include "experiments/truths/verification.hpp"

namespace taut::verb::verify {

namespace {

struct Options {
  std::vector<std::string> names, solvers;
  int section = 0, jobs = 2;
  bool assertions = false, update = false, list = false, record = false;
  bool here = false;  ///< in this process
  Format format;
  std::string baselines, out;

  /// Whether every truth that an assertion rests on is checked, for every solver.
  bool of_all_assertions() const { return names.empty() && solvers.empty() && section == 0; }
};

std::vector<const TruthEntry*> choose(const Options& options) {
  for (const std::string& solver : options.solvers)
    if (solver != "reference") parse_solver(solver);
  std::vector<const TruthEntry*> chosen;
  for (const TruthEntry* truth : truths()) {
    if (options.assertions && std::ranges::count(assertions(), truth->name, &Assertion::truth) == 0)
      continue;
    const bool named = options.names.empty() || std::ranges::count(options.names, truth->name) > 0;
    if (named && (options.section == 0 || truth->section == options.section))
      chosen.push_back(truth);
  }
  std::ranges::sort(chosen, {}, [](const TruthEntry* t) { return std::pair(t->section, t->row); });
  return chosen;
}

/// What one truth may use: it costs a second or two.
constexpr ProcessLimits kLimits{.cpu_seconds = 600, .memory = std::size_t{4} << 30};

/// A truth in a process of its own: whatever its solver does costs this truth alone. Throws
/// InputError of a shipped scene that is missing.
std::vector<Finding> findings_of(const TruthEntry& truth, const Options& options) {
  const Scratch scratch;
  std::vector<std::string> words{sibling_program(""), "verify", std::string(truth.name), "--here",
                                 "--json"};
  for (const std::string& solver : options.solvers) words.insert(words.end(), {"--solver", solver});
  Process process(words, {.output = ProcessOptions::Stream::piped,
                          .errors_file = scratch.path() / "errors",
                          .limits = kLimits});
  const std::string out = process.read_all(5 * kLimits.cpu_seconds);
  const std::optional<ProcessEnd> end = process.wait(1);
  const std::string said = last_line(std::ifstream(scratch.path() / "errors"));
  if (end && end->exit_code == kUsage) throw InputError(said);
  if (end && out.ends_with("}\n")) {
    const Answer answer = answer_from_json(out, std::string(truth.name));
    const Verification found = verification_in(answer);
    if (found.truths.size() == 1) return found.truths.front().findings;
  }
  Finding f;
  f.subject = options.solvers.empty() ? "taut" : options.solvers.front();
  f.quantity = "the check ends", f.unit = "1", f.expected = 1, f.verdict = TruthVerdict::broken;
  f.why = (end ? end->text() : "it took too long") + (said.empty() ? "" : ": " + said);
  return {f};
}

/// Checks the truths, `jobs` at a time; they stay in their order. Throws what a truth threw first.
std::vector<CheckedTruth> check(const std::vector<const TruthEntry*>& chosen,
                                const Options& options) {
  std::vector<CheckedTruth> checked(chosen.size());
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::size_t done = 0;
  std::exception_ptr failed;
  const Countdown countdown("truth");
  const auto work = [&] {
    try {
      for (std::size_t i = next++; i < chosen.size(); i = next++) {
        const auto start = SteadyClock::now();
        if (options.here) {
          Findings findings(options.solvers);
          chosen[i]->check(findings);
          checked[i] = {*chosen[i], findings.all(), seconds_since(start)};
        } else {
          checked[i] = {*chosen[i], findings_of(*chosen[i], options), seconds_since(start)};
        }
        const std::lock_guard lock(mutex);
        countdown(++done, chosen.size());
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!failed) failed = std::current_exception();
      next = chosen.size();
    }
  };
  {
    std::vector<std::jthread> threads;
    for (int j = 1; j < options.jobs; ++j) threads.emplace_back(work);
    work();
  }
  if (failed) std::rethrow_exception(failed);
  return checked;
}

Verification verify(const Options& options) {
  Verification found{check(choose(options), options), {}};
  found.assertions = judge_assertions([&](std::string_view truth) -> const std::vector<Finding>* {
    const auto at = std::ranges::find(found.truths, truth, &CheckedTruth::name);
    return at == found.truths.end() ? nullptr : &at->findings;
  });
  return found;
}

int summary(const std::vector<CheckedTruth>& truths) {
  std::size_t counts[4] = {}, broken_truths = 0, findings = 0;
  for (const CheckedTruth& truth : truths) {
    bool broken = false;
    for (const Finding& f : truth.findings) {
      ++counts[static_cast<std::size_t>(f.verdict)];
      ++findings;
      broken = broken || f.verdict == TruthVerdict::broken;
    }
    broken_truths += broken;
  }
  std::ostream& news = progress();
  news << truths.size() << " truths, " << findings << " numbers: " << counts[0] << " passed, "
       << counts[1] << " deviate as explained, " << counts[2] << " not applicable, " << counts[3]
       << " broken";
  if (broken_truths > 0) news << " in " << broken_truths << " truths";
  news << '\n';
  if (counts[3] > 0) return kRegression;
  return counts[0] + counts[1] > 0 ? kPass : kNothing;
}

/// Holds the verdicts of assertions to those that were kept, or keeps them.
int compare_with_baseline(const Answer& answer, const Options& options) {
  const std::filesystem::path file = std::filesystem::path(options.baselines) / "assertions.json";
  const Table& now = answer.table("assertions");
  if (options.update) {
    Answer kept{"verify", "assertions"};
    kept.add(now);
    make_folder(file.parent_path());
    write_durably(file, to_json(kept));
    progress() << file.string() << '\n';
    return kPass;
  }
  if (!std::filesystem::exists(file)) {
    std::cerr << "assertions: no baseline " << printable(file.string()) << '\n';
    return options.assertions ? kNothing : kPass;
  }
  // Figures may differ: the truth's tolerance judges them.
  const auto changes =
      differences(answer_from_json(read_text(file), file.string()).table("assertions"), now,
                  {"source", "assertion"}, {"verdict"});
  for (const Difference& change : changes)
    std::cerr << "assertion " << printable(change.text) << '\n';
  progress() << now.rows.size() << " assertions of publications: "
             << (changes.empty() ? "every verdict is as it was"
                                 : std::to_string(changes.size()) + " changed")
             << '\n';
  return changes.empty() ? kPass : kRegression;
}

int run(const Options& options) {
  if (options.list) {
    Answer answer{"verify"};
    Table& table = answer.add(Table{"truths", "", {{"place"}, {"name", "truth"}, {"statement"}}});
    for (const TruthEntry* truth : choose(options))
      table.rows.push_back({place_of(*truth), truth->name, truth->statement});
    print(answer, options.format);
    return kPass;
  }
  if (options.update && !(options.assertions && options.of_all_assertions()))
    throw InputError(
        "--update keeps the verdicts of all assertions: taut verify --assertions --update");
  const Verification found = verify(options);
  const Answer answer = answer_of(found, options.assertions);
  if (options.record) {
    Store store(options.out);
    store.prepare();
    store.keep(answer);
  }
  print(answer, options.format);
  const int code = summary(found.truths);
  if (!options.of_all_assertions()) return code;
  const int assertions = compare_with_baseline(answer, options);
  return code == kPass ? assertions : code;
}

void add_options(CLI::App& app, Options& options) {
  std::vector<std::string> names;
  for (const TruthEntry* truth : truths()) names.emplace_back(truth->name);
  app.add_option("TRUTH", options.names, "Truths to check by name; all if none is given")
      ->check(known("truth", std::move(names)));
  app.add_option("--solver", options.solvers,
                 "Only what binds these solvers (\"reference\": the references)");
  app.add_option("--section", options.section, "Only one section of the truths")
      ->check(CLI::Range(1, 10));
  app.add_option("-j,--jobs", options.jobs,
                 "Truths at a time, each in a process of its own (default: " +
                     std::to_string(options.jobs) + ")")
      ->check(CLI::Range(1, 64));
  app.add_flag("--record", options.record, "Also keep the findings for the report");
  add_results(app, options.out);
  app.add_flag("--assertions", options.assertions,
               "Only what holds the assertions of publications, and their verdicts");
  add_baselines(app, options.baselines);
  app.add_flag("--update", options.update,
               "With --assertions: keep their verdicts as the baseline");
  add_format(app, options.format, "Every number, with sources and times");
  app.add_flag("--list", options.list, "Only name the truths");
  app.add_flag("--here", options.here, "Check in this process (internal)")->group("");
}

}  // namespace

Answer verify_all(int jobs) {
  Options options;
  options.jobs = jobs;
  return answer_of(verify(options));
}

}  // namespace taut::verb::verify

TAUT_VERB(verify) = {
    .name = "verify",
    .group = VerbGroup::trust,
    .summary = "Holds solvers and metrics to closed forms and published numbers",
    .example =
        "taut verify --section 4 --solver jakobsen\n"
        "  taut verify hanging-chain-sweeps --all\n"
        "  taut verify --assertions\n"
        "Exit: 0 no truth is broken, no verdict of an assertion changed; 1 one is or "
        "did; 4 nothing was held to anything",
    .answer =
        "truths: verdict place name numbers nearest section section_title statement source "
        "seconds; "
        "findings: verdict truth subject quantity unit measured expected tolerance uncertainty "
        "why; "
        "assertions: source section verdict assertion figure; "
        "broken: truth number",
    .bind = taut::bind_verb<taut::verb::verify::add_options, taut::verb::verify::run>};
