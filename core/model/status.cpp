#include "core/model/status.hpp"

#include <algorithm>
#include <array>
#include <iterator>

#include "core/model/input_error.hpp"
#include "core/model/names.hpp"

namespace taut {

namespace {
constexpr Names<Status::Kind::interrupted> kNames{
    "ok",  "exploded", "unsettled", "extreme", "unsupported", "timeout",
    "oom", "crash",    "protocol",  "error",   "interrupted"};

constexpr std::string_view kNumbers[] = {"no",   "one", "two",   "three", "four",
                                         "five", "six", "seven", "eight", "nine"};
static_assert(kSettlingTimes < static_cast<int>(std::size(kNumbers)));

using ReasonTexts = std::array<std::string, static_cast<std::size_t>(Reason::unsettled) + 1>;

/// The texts of all reasons, in their order.
const ReasonTexts& reason_texts() {
  static const std::string moves =
      "moves after " + std::string(kNumbers[kSettlingTimes]) + " settling times";
  static const ReasonTexts texts{"nonfinite",         "energy", "box", "stretch",
                                 "stretch, " + moves, moves};
  return texts;
}
}  // namespace

std::string_view to_string(Status::Kind kind) { return kNames[kind]; }

const std::string& stored_statuses() {
  static const std::string kAll = [] {
    std::string all(kNames[Status::Kind::ok]);
    for (int kind = 1; kind < static_cast<int>(Status::Kind::interrupted); ++kind)
      all.append(", ").append(kNames[static_cast<Status::Kind>(kind)]);
    return all;
  }();
  return kAll;
}

bool is_status(std::string_view name) { return kNames.find(name).has_value(); }

Status::Kind status_kind(std::string_view name) {
  if (const auto kind = kNames.find(name)) return *kind;
  throw InputError("unknown status '" + std::string(name) + "'");
}

std::string_view to_string(Reason reason) {
  return reason_texts()[static_cast<std::size_t>(reason)];
}

StatusReason StatusReason::stored(const std::string& text) {
  const ReasonTexts& texts = reason_texts();
  const auto at = std::ranges::find(texts, text);
  if (at == texts.end()) return text;
  return static_cast<Reason>(at - texts.begin());
}

}  // namespace taut
