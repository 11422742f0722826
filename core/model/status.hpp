#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace taut {

/// Why taut itself ends a run, or marks one that it ran to the end (DivergenceDetector).
enum class Reason { nonfinite, energy, box, stretch, stretch_and_unsettled, unsettled };
/// The text that is stored: "energy", "moves after five settling times".
std::string_view to_string(Reason);

/// Least number of settling times that a run must last to be `unsettled`.
inline constexpr int kSettlingTimes = 5;

/// Why a status is not ok: a Reason, or words of a solver or of the system, which decide nothing.
class StatusReason {
 public:
  StatusReason() = default;
  StatusReason(Reason own) : own_(own), text_(to_string(own)) {}
  StatusReason(std::string words) : text_(std::move(words)) {}
  StatusReason(const char* words) : text_(words) {}
  /// The reason that a stored record has as this text: a Reason if one has that text. Only code
  /// that reads stored records needs this function.
  static StatusReason stored(const std::string& text);

  const std::string& text() const { return text_; }
  bool empty() const { return text_.empty(); }
  /// Whether this is that Reason; false for words that merely read the same.
  bool operator==(Reason own) const { return own_ == own; }

 private:
  std::optional<Reason> own_;
  std::string text_;
};

/// How a case ended. A numerical failure is a result, never an exception and never a gap.
struct Status {
  enum class Kind {
    // results, kept
    ok,           ///< ran to the end
    exploded,     ///< non-finite, or kinetic energy above ten times the available potential drop
    unsettled,    ///< ran to the end, still moving after kSettlingTimes theoretical settling times
    extreme,      ///< ran to the end, but stretched too far to count in a mean
    unsupported,  ///< the solver says that it would misread the scene
    // failures, kept and re-runnable
    timeout,
    oom,
    crash,
    protocol,  ///< an external program did not keep to the protocol
    error,
    // never stored
    interrupted
  };
  Kind kind = Kind::ok;
  StatusReason reason;  ///< Reason::energy, "SIGSEGV", what is not supported, ...
  int step = -1;        ///< where it happened; -1: not known or not applicable
  int vertex = -1;      ///< the first vertex concerned; -1: not known or not applicable

  bool is_result() const { return kind <= Kind::unsupported; }
};

std::string_view to_string(Status::Kind);
bool is_status(std::string_view);
/// The names of all that are stored, in their order: "ok, exploded, ..., error".
const std::string& stored_statuses();
Status::Kind status_kind(std::string_view);  ///< throws InputError

}  // namespace taut
