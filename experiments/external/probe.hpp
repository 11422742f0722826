#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/external/protocol.hpp"

namespace taut::external {

/// One thing that a program has to do, and whether it does.
struct Check {
  enum class Verdict { passed, failed, skipped };
  std::string name;
  Verdict verdict = Verdict::passed;
  std::string said;              ///< what was seen, or what is wrong: a sentence
  std::string status = "error";  ///< of a case that fails so
};
std::string_view to_string(Check::Verdict);

/// What every program has to pass before any of its results counts, at these values of its
/// parameters: free fall, time step, pins, the same bits twice and after a reload, restart from a
/// state. On sheets of 16 vertices, some 300 steps in all.
std::vector<Check> quick_probe(const Command&, const Json& params);

/// The same at the default parameters, and: bad requests, the end of its input, its own word about
/// its time. `report` is called after each.
std::vector<Check> full_probe(const Command&, const std::function<void(const Check&)>& report);

}  // namespace taut::external
