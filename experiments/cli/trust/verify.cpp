#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <ranges>
#include <thread>

#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/baseline/assertions_baseline.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/distinct.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/text.hpp"
#include "experiments/truths/truth.hpp"
#include "experiments/truths/vasilovici/assertions.hpp"

namespace taut::verb::verify {

namespace {

struct Options {
  std::vector<std::string> names, solvers;
  int section = 0, jobs = 2;
  bool json = false, verbose = false, assertions = false, update = false, list = false;
  std::string output, baselines;

  /// Whether every truth that an assertion rests on is checked, for every solver.
  bool of_all_assertions() const { return names.empty() && solvers.empty() && section == 0; }
};

struct Outcome {
  const TruthEntry* truth = nullptr;
  std::vector<Finding> findings;
  double seconds = 0;
};

std::vector<const TruthEntry*> choose(const Options& options) {
  for (const std::string& solver : options.solvers)
    if (solver != "reference") parse_solver(solver);
  std::vector<const TruthEntry*> chosen;
  for (const TruthEntry* truth : truths()) {
    if (options.assertions &&
        std::ranges::none_of(vasilovici_assertions(), [&](const VasiloviciAssertion& assertion) {
          return assertion.truth == truth->name;
        }))
      continue;
    const bool named = options.names.empty() || std::ranges::count(options.names, truth->name) > 0;
    if (named && (options.section == 0 || truth->section == options.section))
      chosen.push_back(truth);
  }
  std::ranges::sort(chosen, {}, [](const TruthEntry* t) { return std::pair(t->section, t->row); });
  return chosen;
}

/// Checks the truths on `jobs` threads; outcomes stay in the order of the truths. Throws what a
/// truth threw first, as InputError of a shipped scene that is missing.
std::vector<Outcome> check(const std::vector<const TruthEntry*>& chosen, const Options& options) {
  std::vector<Outcome> outcomes(chosen.size());
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::size_t done = 0;
  std::exception_ptr failed;
  const Countdown countdown("truth");
  const auto work = [&] {
    try {
      for (std::size_t i = next++; i < chosen.size(); i = next++) {
        const auto start = SteadyClock::now();
        Findings findings(options.solvers);
        chosen[i]->check(findings);
        outcomes[i] = {chosen[i], findings.all(), seconds_since(start)};
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
  return outcomes;
}

std::vector<JudgedAssertion> judged(const std::vector<Outcome>& outcomes) {
  return judge_assertions([&](std::string_view truth) -> const std::vector<Finding>* {
    for (const Outcome& outcome : outcomes)
      if (outcome.truth->name == truth) return &outcome.findings;
    return nullptr;
  });
}

Json to_json(const std::vector<Outcome>& outcomes) {
  const auto finding = [](const Finding& f) -> Json {
    return {{"subject", f.subject},
            {"quantity", f.quantity},
            {"unit", f.unit},
            {"measured", f.measured},
            {"expected", f.expected},
            {"tolerance", f.tolerance},
            {"uncertainty", f.uncertainty},
            {"verdict", to_string(f.verdict)},
            {"why", f.why}};
  };
  const auto truth = [&](const Outcome& outcome) -> Json {
    return {{"name", outcome.truth->name},
            {"section", outcome.truth->section},
            {"section_title", section_title(outcome.truth->section)},
            {"row", outcome.truth->row},
            {"statement", outcome.truth->statement},
            {"source", outcome.truth->source},
            {"findings", json_array(outcome.findings, finding)}};
  };
  const auto assertion = [](const JudgedAssertion& a) -> Json {
    return {{"section", a.section},
            {"assertion", a.assertion},
            {"verdict", a.verdict},
            {"figure", a.figure}};
  };
  return {{"schema", "taut-truths-2"},
          {"program", program_digest()},
          {"truths", json_array(outcomes, truth)},
          {"assertions", json_array(judged(outcomes), assertion)}};
}

std::string value(double v) {
  return formatted("%.*g", std::abs(v) > 0.01 && std::abs(v) < 1e4 ? 7 : 3, v);
}

std::string line(const Finding& f) {
  static constexpr Colour kColours[] = {Colour::green, Colour::yellow, Colour::yellow, Colour::red};
  std::string text =
      coloured(to_string(f.verdict), kColours[static_cast<int>(f.verdict)]) + "  " + f.subject;
  if (f.verdict == TruthVerdict::not_applicable) return text + ": " + f.why;
  text += ": " + f.quantity + " " + value(f.measured);
  if (f.uncertainty > 0) text += " +- " + value(f.uncertainty);
  if (f.unit != "1") text += " " + f.unit;
  if (f.expected == 0)
    text += " (at most " + value(f.tolerance) + ")";
  else
    text += " (" + value(f.expected) + " +- " + value(f.tolerance) + ")";
  return f.why.empty() ? text : text + ": " + f.why;
}

/// For each subject its worst finding only, unless `all`.
std::vector<Finding> worst_by_subject(const std::vector<Finding>& findings) {
  const auto badness = [](const Finding& f) {
    const double off = std::abs(f.measured - f.expected);
    const double share = f.tolerance > 0 ? off / f.tolerance : off;
    return std::pair(f.verdict, std::isnan(share) ? 1e300 : share);
  };
  std::vector<Finding> worst;
  for (const std::string& subject : distinct(findings, &Finding::subject)) {
    const auto of = [&](const Finding& f) { return f.subject == subject; };
    auto own = findings | std::views::filter(of);
    worst.push_back(*std::ranges::max_element(own, {}, badness));
  }
  return worst;
}

void print_table(const std::vector<Outcome>& outcomes, bool verbose) {
  int section = 0;
  for (const auto& [truth, findings, seconds] : outcomes) {
    if (truth->section != section) {
      section = truth->section;
      std::cout << '\n' << section << "  " << section_title(section) << '\n';
    }
    std::cout << "  " << truth->section << '.' << truth->row << ' ' << truth->name << ": "
              << truth->statement;
    if (verbose) std::cout << " [" << truth->source << "; " << value(seconds) << " s]";
    std::cout << '\n';
    for (const Finding& f : verbose ? findings : worst_by_subject(findings))
      std::cout << "      " << line(f) << '\n';
  }
}

int summary(const std::vector<Outcome>& outcomes) {
  std::size_t counts[4] = {}, broken_truths = 0, findings = 0;
  for (const Outcome& outcome : outcomes) {
    bool broken = false;
    for (const Finding& f : outcome.findings) {
      ++counts[static_cast<std::size_t>(f.verdict)], ++findings;
      broken = broken || f.verdict == TruthVerdict::broken;
    }
    broken_truths += broken;
  }
  std::ostream& news = progress();
  news << outcomes.size() << " truths, " << findings << " numbers: " << counts[0] << " passed, "
       << counts[1] << " deviate as explained, " << counts[2] << " not applicable, " << counts[3]
       << " broken";
  if (broken_truths > 0) news << " in " << broken_truths << " truths";
  news << '\n';
  if (counts[3] > 0) return kRegression;
  return counts[0] + counts[1] > 0 ? kPass : kNothing;
}

void print_assertions(const std::vector<JudgedAssertion>& assertions) {
  for (const auto& [section, assertion, verdict, figure] : assertions)
    std::cout << section << "  " << assertion << "\n      "
              << coloured(verdict, verdict == "overturned" ? Colour::red : Colour::green)
              << (figure.empty() ? "" : ": " + figure) << '\n';
}

/// Holds the verdicts of assertions to those that were kept, or keeps them.
int compare_with_baseline(const std::vector<JudgedAssertion>& assertions, const Options& options) {
  const std::filesystem::path file = std::filesystem::path(options.baselines) / "assertions.jsonl";
  if (options.update) {
    make_folder(file.parent_path());
    write_durably(file, to_json_lines(assertions));
    progress() << file.string() << '\n';
    return kPass;
  }
  if (!std::filesystem::exists(file)) {
    std::cerr << "assertions: no baseline " << printable(file.string()) << '\n';
    return options.assertions ? kNothing : kPass;
  }
  const std::vector<std::string> changes = compare_assertions(read_assertions(file), assertions);
  for (const std::string& change : changes) std::cerr << change << '\n';
  progress() << assertions.size() << " assertions of Vasilovici's report: "
             << (changes.empty() ? "every verdict is as it was"
                                 : std::to_string(changes.size()) + " changed")
             << '\n';
  return changes.empty() ? kPass : kRegression;
}

int run(const Options& options) {
  if (options.list) {
    const std::vector<const TruthEntry*> chosen = choose(options);
    if (options.json) {
      print_json(json_array(chosen, [](const TruthEntry* truth) -> Json {
        return {{"name", truth->name},
                {"section", truth->section},
                {"row", truth->row},
                {"statement", truth->statement},
                {"source", truth->source}};
      }));
      return kPass;
    }
    for (const TruthEntry* truth : chosen)
      std::cout << truth->section << '.' << truth->row << '\t' << truth->name << '\t'
                << truth->statement << '\n';
    return kPass;
  }
  if (options.update && !(options.assertions && options.of_all_assertions()))
    throw InputError(
        "--update keeps the verdicts of all assertions: taut verify --assertions --update");
  const std::vector<Outcome> outcomes = check(choose(options), options);
  const std::string json = to_text(to_json(outcomes), 1);
  if (!options.output.empty()) write_file(options.output, json + "\n");
  if (options.json)
    std::cout << json << '\n';
  else if (options.assertions)
    print_assertions(judged(outcomes));
  else
    print_table(outcomes, options.verbose);
  const int code = summary(outcomes);
  if (!options.of_all_assertions()) return code;
  const int assertions = compare_with_baseline(judged(outcomes), options);
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
                 "Threads (default: " + std::to_string(options.jobs) + ")")
      ->check(CLI::Range(1, 64));
  add_output(app, options.output, "Also write the findings as JSON to this file");
  app.add_flag("--json", options.json, "Findings as JSON instead of a table");
  app.add_flag("--assertions", options.assertions,
               "Only what holds the assertions of Vasilovici's report, and their verdicts");
  add_baselines(app, options.baselines);
  app.add_flag("--update", options.update,
               "With --assertions: keep their verdicts as the baseline");
  app.add_flag("--verbose", options.verbose, "Every number, with sources and times");
  app.add_flag("--list", options.list, "Only name the truths");
}

}  // namespace
}  // namespace taut::verb::verify

TAUT_VERB(verify) = {
    .name = "verify",
    .group = VerbGroup::trust,
    .summary = "Holds solvers and metrics to closed forms and published numbers",
    .example =
        "taut verify --section 4 --solver jakobsen\n"
        "  taut verify hanging-chain-sweeps --verbose\n"
        "  taut verify --assertions\n"
        "Exit: 0 no truth is broken, no verdict of an assertion changed; 1 one is or "
        "did; 4 nothing was held to anything",
    .bind = taut::bind_verb<taut::verb::verify::add_options, taut::verb::verify::run>};
