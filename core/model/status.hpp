#pragma once

#include <string>
#include <string_view>

namespace taut {

/// How a case ended. A numerical failure is a result, never an exception and never a gap.
struct Status {
  enum class Kind {
    // results, kept
    ok,           ///< ran to the end
    exploded,     ///< non-finite, or kinetic energy above ten times the available potential drop
    unsettled,    ///< ran to the end, still moving after five theoretical settling times
    extreme,      ///< ran to the end, but stretched as no mean should include
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
  std::string reason;  ///< "nonfinite", "energy", "box", "SIGSEGV", what is not supported, ...
  int step = -1;       ///< where it happened; -1: not known or not applicable
  int vertex = -1;     ///< the first vertex concerned; -1: not known or not applicable

  bool is_result() const { return kind <= Kind::unsupported; }
};

std::string_view to_string(Status::Kind);
bool is_status(std::string_view);
Status::Kind status_kind(std::string_view);  ///< throws InputError

}  // namespace taut
