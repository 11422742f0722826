#include "experiments/case/record.hpp"

#include <cmath>

#include "core/model/input_error.hpp"
#include "core/model/names.hpp"

namespace taut {

namespace {
constexpr Names<Status::Kind::interrupted> kNames{
    "ok",  "exploded", "unsettled", "extreme", "unsupported", "timeout",
    "oom", "crash",    "protocol",  "error",   "interrupted"};
constexpr Names<Reason::unsettled> kReasons{"nonfinite",
                                            "energy",
                                            "box",
                                            "stretch",
                                            "stretch, moves after five settling times",
                                            "moves after five settling times"};
}  // namespace

std::string_view to_string(Status::Kind kind) { return kNames[kind]; }

bool is_status(std::string_view name) { return kNames.find(name).has_value(); }

Status::Kind status_kind(std::string_view name) {
  if (const auto kind = kNames.find(name)) return *kind;
  throw InputError("unknown status '" + std::string(name) + "'");
}

std::string_view to_string(Reason reason) { return kReasons[reason]; }

std::optional<Reason> reason_of(const Status& status) { return kReasons.find(status.reason); }

double Record::value(const std::string& name) const {
  const auto at = values.find(name);
  return at == values.end() ? std::nan("") : at->second;
}

}  // namespace taut
