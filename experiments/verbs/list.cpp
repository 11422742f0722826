#include <iostream>
#include <string>

#include "core/model/solver.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/verbs/verb.hpp"

namespace taut {

namespace {

std::function<int()> bind(CLI::App& app) {
  const auto what = std::make_shared<std::string>();
  app.add_option("WHAT", *what, "solvers | metrics")->check(CLI::IsMember({"solvers", "metrics"}));
  return [what] {
    if (what->empty() || *what == "solvers")
      for (const SolverEntry* entry : solvers())
        std::cout << entry->name << '\t' << entry->summary << '\n';
    if (what->empty() || *what == "metrics")
      for (const MetricEntry* entry : metrics())
        std::cout << entry->name << '\t' << entry->summary << '\n';
    return kPass;
  };
}

}  // namespace
}  // namespace taut

TAUT_VERB(list) = {.name = "list",
                   .summary = "Names scenes, solvers, metrics and studies",
                   .example = "taut list solvers",
                   .bind = taut::bind};
