// Assertions of publications, with verdicts.

#include "experiments/truths/assertions/assertions.hpp"

#include "experiments/report/chart/wording.hpp"
#include "experiments/report/model/parts.hpp"

namespace taut::report {

Table assertions_table(const std::optional<Truths>& truths) {
  Table table{"assertions", "What publications assert", {}};
  for (const char* name : {"source", "assertion", "verdict", "because", "measured"})
    table.columns.emplace_back(name);
  for (const Assertion& assertion : assertions()) {
    std::vector<Cell> row{std::string(assertion.source) + ", " + std::string(assertion.place),
                          typeset(assertion.assertion),
                          to_string(assertion.verdict),
                          typeset(assertion.because),
                          {}};
    if (truths)
      if (const auto now = truths->assertions.find(std::string(assertion.assertion));
          now != truths->assertions.end()) {
        row[2] = now->second.first;
        row[4] = typeset(now->second.second);
      }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace taut::report
