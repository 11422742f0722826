#include "experiments/case/record.hpp"

#include <cmath>

#include "core/model/names.hpp"

namespace taut {

namespace {
constexpr Names<Reason::unsettled> kReasons{"nonfinite",
                                            "energy",
                                            "box",
                                            "stretch",
                                            "stretch, moves after five settling times",
                                            "moves after five settling times"};
}  // namespace

std::string_view to_string(Reason reason) { return kReasons[reason]; }

std::optional<Reason> reason_of(const Status& status) { return kReasons.find(status.reason); }

double Record::value(const std::string& name) const {
  const auto at = values.find(name);
  return at == values.end() ? std::nan("") : at->second;
}

}  // namespace taut
