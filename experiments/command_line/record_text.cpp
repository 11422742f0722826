#include "experiments/command_line/record_text.hpp"

#include <cmath>
#include <iomanip>
#include <iostream>

#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

std::string_view unit_of(const std::string& value) {
  for (const MetricEntry* metric : metrics())
    for (const ValueSpec& spec : metric->values)
      if (spec.name == value) return spec.unit.si == "1" ? "" : spec.unit.si;
  return "";
}

}  // namespace

void print_record(const Record& record) {
  std::cout << record.id << "\n  status       " << to_string(record.status.kind);
  if (!record.status.reason.empty()) std::cout << " (" << record.status.reason << ")";
  if (record.status.step >= 0) std::cout << ", step " << record.status.step;
  if (record.status.vertex >= 0) std::cout << ", vertex " << record.status.vertex;
  std::cout << "\n  steps        " << record.steps << " of " << record.dt << " s\n  cloth        "
            << record.vertices << " vertices, " << record.links << " links\n  work         "
            << record.projections << " projections per step\n  state        " << record.digest
            << '\n';
  for (const auto& [name, value] : record.values)
    if (!std::isnan(value))
      std::cout << "  " << std::left << std::setw(26) << name << std::setprecision(6) << value
                << ' ' << unit_of(name) << '\n';
}

}  // namespace taut
