#include "experiments/report/questions/links.hpp"

#include "core/model/text.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/system/distinct.hpp"

namespace taut::report {

std::string Arithmetic::brief() const {
  return lanes == 0 ? precision : precision + " × " + std::to_string(lanes);
}

std::string Arithmetic::text() const {
  if (instructions.empty()) return precision;
  return lanes == 0 ? precision + ", " + instructions : brief() + " (" + instructions + ")";
}

std::string Arithmetic::meaning() const {
  const std::string text = precision == "float" ? "single precision" : "double precision";
  return lanes == 0 ? text : text + ", " + std::to_string(lanes) + " numbers in one instruction";
}

Arithmetic arithmetic_of(const Record& r, const std::string& vectors) {
  const auto param = [&](ParamSpec::Role role) {
    const auto at = r.params.find(parameter_of(r.solver, role));
    return at == r.params.end() ? std::string() : at->second;
  };
  Arithmetic all{.precision = param(ParamSpec::Role::precision)};
  if (all.precision.empty()) return {};  // its links have no vector kernels
  const std::string asked = param(ParamSpec::Role::instructions);
  const bool automatic = asked == "auto";
  all.instructions = automatic ? vectors : asked;
  if (all.instructions.empty()) {
    if (automatic) all.instructions = "vectors";
    return all;
  }
  for (const auto& [name, bytes] :
       {std::pair<const char*, int>{"sse2", 16}, {"avx2", 32}, {"avx512", 64}})
    if (all.instructions == name) all.lanes = bytes / (all.precision == "float" ? 4 : 8);
  return all;
}

std::string link_order(const Record& r) {
  const ResolvedSetting* order = find_setting(r.resolved_settings, kLinkOrder);
  return order ? order->compared() : "";
}

std::string link_orders(const std::vector<SceneBench>& scenes) {
  std::vector<std::string> all;
  for (const SceneBench& scene : scenes)
    for (const BenchedCase& c : scene.cases)
      if (const std::string order = link_order(c.record); !order.empty())
        push_unique(all, solver_title(c.record.solver) + " " + order);
  return join(all, ", ");
}

}  // namespace taut::report
