#include "experiments/truths/verify.hpp"

#include <algorithm>
#include <fstream>
#include <mutex>
#include <optional>
#include <utility>

#include "core/model/input_error.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/own_words.hpp"
#include "experiments/system/process.hpp"
#include "experiments/system/run_all.hpp"
#include "experiments/truths/assertions/assertions.hpp"

namespace taut {

namespace {

/// Limits of one truth, which normally takes a second or two.
constexpr ProcessLimits kLimits{.cpu_seconds = 600, .memory = std::size_t{4} << 30};

/// Checks a truth in its own process, so that whatever its solver does only affects this truth.
/// Throws InputError if a shipped scene is missing.
std::vector<Finding> findings_of(const TruthEntry& truth, const VerifyRequest& request) {
  const Scratch scratch;
  std::vector<std::string> words{sibling_program(""), own_words::kVerify, std::string(truth.name),
                                 own_words::kHere, own_words::kJson};
  for (const std::string& solver : request.solvers)
    words.insert(words.end(), {own_words::kSolver, solver});
  Process process(words, {.output = ProcessOptions::Stream::piped,
                          .errors_file = scratch.path() / "errors",
                          .limits = kLimits});
  const std::string out = process.read_all(kWallPerCpu * kLimits.cpu_seconds);
  const std::optional<ProcessEnd> end = process.wait(1);
  const std::string said = last_line(std::ifstream(scratch.path() / "errors"));
  if (end && end->exit_code == own_words::kBadInputExit) throw InputError(said);
  if (end && out.ends_with("}\n")) {
    const Answer answer = answer_from_json(out, std::string(truth.name));
    const Verification found = verification_in(answer);
    if (found.truths.size() == 1) return found.truths.front().findings;
  }
  Finding f;
  f.subject = request.solvers.empty() ? "taut" : request.solvers.front();
  f.quantity = "the check ends";
  f.unit = "1";
  f.expected = 1;
  f.verdict = TruthVerdict::broken;
  f.why = (end ? end->text() : "it took too long") + (said.empty() ? "" : ": " + said);
  return {f};
}

}  // namespace

std::vector<const TruthEntry*> truths_in_order() {
  std::vector<const TruthEntry*> all(truths().begin(), truths().end());
  std::ranges::sort(all, {}, [](const TruthEntry* t) { return std::pair(t->section, t->row); });
  return all;
}

bool is_asserted(const TruthEntry& truth) {
  return std::ranges::count(assertions(), truth.name, &Assertion::truth) > 0;
}

Verification verify(const VerifyRequest& request) {
  Verification found{std::vector<CheckedTruth>(request.truths.size()), {}};
  std::mutex mutex;
  std::size_t done = 0;
  run_all(request.truths.size(), request.jobs, [&](std::size_t i) {
    const TruthEntry& truth = *request.truths[i];
    const auto start = SteadyClock::now();
    if (request.here) {
      Findings findings(request.solvers);
      truth.check(findings);
      found.truths[i] = {truth, findings.all(), seconds_since(start)};
    } else {
      found.truths[i] = {truth, findings_of(truth, request), seconds_since(start)};
    }
    const std::lock_guard lock(mutex);
    request.progress(++done, request.truths.size());
  });
  found.assertions = judge_assertions([&](std::string_view name) -> const std::vector<Finding>* {
    const auto at = std::ranges::find(found.truths, name, &CheckedTruth::name);
    return at == found.truths.end() ? nullptr : &at->findings;
  });
  return found;
}

}  // namespace taut
