#include "core/model/status.hpp"

#include "core/model/input_error.hpp"
#include "core/model/names.hpp"

namespace taut {

namespace {
constexpr Names<Status::Kind::interrupted> kNames{
    "ok",  "exploded", "unsettled", "extreme", "unsupported", "timeout",
    "oom", "crash",    "protocol",  "error",   "interrupted"};
}

std::string_view to_string(Status::Kind kind) { return kNames[kind]; }

bool is_status(std::string_view name) { return kNames.find(name).has_value(); }

Status::Kind status_kind(std::string_view name) {
  if (const auto kind = kNames.find(name)) return *kind;
  throw InputError("unknown status '" + std::string(name) + "'");
}

}  // namespace taut
