#pragma once

#include <string>
#include <vector>

#include "experiments/truths/verification.hpp"

namespace taut {

/// Version of the conformance suite: the next one with every change of a scene, a closed form or a
/// tolerance.
inline constexpr int kSuiteVersion = 2;

/// The truths that are tests of the suite, in its order.
std::vector<const TruthEntry*> conformance_suite();

/// What the suite found about one engine. It is written to an answer and read back from one.
struct Conformance {
  struct Number {
    std::string phenomenon, needs, test;
    Finding finding;
  };
  std::string engine, version;  ///< "bullet", "taut 0.2.0"
  std::string solver;           ///< text of the solver
  std::string machine;
  int suite = kSuiteVersion;
  std::vector<Number> numbers;

  /// Verdict on a phenomenon: the worst of its numbers that were measured; not applicable if none
  /// was.
  TruthVerdict verdict(std::string_view phenomenon) const;
  /// The first phenomenon whose test fails; "": none.
  std::string first_failed() const;
  std::vector<std::string> phenomena() const;  ///< in the order of the suite
};

/// `found` are findings of the suite's truths about this solver alone. An engine that is part of
/// this program has the version `ours`.
Conformance conformance_of(const std::string& solver, const std::vector<CheckedTruth>& found,
                           const std::string& ours, const std::string& machine);

Answer answer_of(const std::vector<Conformance>&);
/// Throws InputError if it is no such answer.
std::vector<Conformance> conformances_in(const Answer&);

}  // namespace taut
