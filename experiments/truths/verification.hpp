#pragma once

#include <array>
#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/truths/assertions/judged.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

/// A truth and its findings.
struct CheckedTruth {
  std::string name, place;  ///< "hanging-chain-sweeps", "4.2"
  std::string section_title, statement, source;
  int section = 0;
  double seconds = 0;
  std::vector<Finding> findings;

  CheckedTruth() = default;
  CheckedTruth(const TruthEntry&, std::vector<Finding>, double seconds);
};

/// The result of `taut verify`. It is written to an answer and read back from one, which may come
/// from another process or from a results file.
struct Verification {
  std::vector<CheckedTruth> truths;
  std::vector<JudgedAssertion> assertions;
};
/// Number of findings of each verdict.
struct VerdictCounts {
  std::size_t truths = 0, findings = 0, broken_truths = 0;
  std::array<std::size_t, 4> of{};  ///< by TruthVerdict
  std::size_t operator[](TruthVerdict verdict) const {
    return of[static_cast<std::size_t>(verdict)];
  }
  /// "118 truths, 3420 numbers: 3301 passed, ..."
  std::string text() const;
};
VerdictCounts verdicts_of(const std::vector<CheckedTruth>&);

/// assertions_first: the text shows the assertions and not the truths.
Answer answer_of(const Verification&, bool assertions_first = false);
/// Throws InputError if it is no such answer.
Verification verification_in(const Answer&);

/// Place of a truth in the list: "4.2".
std::string place_of(const TruthEntry&);
/// Deviation of a finding as a share of its tolerance; 1: at the tolerance.
double share_of_tolerance(const Finding&);

}  // namespace taut
