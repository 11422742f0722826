#pragma once

#include <limits>
#include <string>

#include "experiments/answer/answer.hpp"
#include "experiments/require/require.hpp"

namespace taut {

/// The effects that can go and those that have to stay, in words. Written to an answer and read
/// back from one.
struct RequirementSummary {
  std::string scene, solver;
  std::string chaotic;  ///< "no", or from when on
  std::string kept, can_go = "nothing", required = "-";
  double time_left = std::numeric_limits<double>::quiet_NaN();  ///< share of the CPU time
};
RequirementSummary summary_of(const Requirement&);

/// The answer of `taut require`. `picture` is its file, or "" without a picture; `seconds` of the
/// patience were used. The memory of a step of the full model is read from the store.
Answer answer_of(const Requirement&, const Store&, const std::string& picture, double seconds,
                 double patience);
RequirementSummary requirement_in(const Answer&);

/// A table `scenes` with the requirements of several scenes.
class RequirementTable {
 public:
  RequirementTable();
  void add(const Requirement&);
  void add_refused(const std::string& scene, const std::string& reason);
  const Table& table() const { return table_; }

 private:
  Table table_;
};

}  // namespace taut
