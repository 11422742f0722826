#include "experiments/case/record.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/model/input_error.hpp"

namespace taut {

namespace {
constexpr std::array<std::string_view, 11> kNames{
    "ok",  "exploded", "unsettled", "extreme", "unsupported", "timeout",
    "oom", "crash",    "protocol",  "error",   "interrupted"};
}

std::string_view to_string(Status::Kind kind) { return kNames[static_cast<std::size_t>(kind)]; }

bool is_status(std::string_view name) {
  return std::find(kNames.begin(), kNames.end(), name) != kNames.end();
}

Status::Kind status_kind(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (kNames[i] == name) return static_cast<Status::Kind>(i);
  throw InputError("unknown status '" + std::string(name) + "'");
}

double Record::value(const std::string& name) const {
  const auto at = values.find(name);
  return at == values.end() ? std::nan("") : at->second;
}

}  // namespace taut
