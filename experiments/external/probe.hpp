#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/model/status.hpp"
#include "experiments/answer/answer.hpp"
#include "experiments/external/protocol.hpp"

namespace taut::external {

/// One requirement on a program, and whether the program meets it.
struct Check {
  enum class Verdict { passed, failed, skipped };
  std::string name;
  Verdict verdict = Verdict::passed;
  std::string said;                           ///< what was observed or what is wrong, as a sentence
  Status::Kind status = Status::Kind::error;  ///< of a case whose program fails this check
};
Cell cell_of(Check::Verdict);

/// Checks that a program has to pass, at these values of its parameters, before any of its results
/// counts: free fall, time step, pins, the same bits twice and after a reload, restart from a
/// state. They use sheets of 16 vertices and some 300 steps in all.
std::vector<Check> quick_probe(const Command&, const Json& params);

/// The checks of quick_probe() at the default parameters, and further ones: bad requests, the end
/// of the program's input, and the time that the program reports. Calls `report` after each check.
std::vector<Check> full_probe(const Command&, const std::function<void(const Check&)>& report);

}  // namespace taut::external
