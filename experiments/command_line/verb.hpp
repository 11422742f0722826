#pragma once

#include <functional>
#include <span>
#include <string_view>

#include "experiments/command_line/arguments.hpp"
#include "experiments/system/signals.hpp"

namespace taut {

/// What a verb's process returns; the same for all verbs.
enum ExitCode : int {
  kPass = 0,
  kRegression = 1,   ///< a regression, a status change or a broken truth
  kUsage = 2,        ///< bad usage or input; nothing was run, nothing was written
  kIncomplete = 3,   ///< some cases are missing
  kNothing = 4,      ///< nothing was compared: a check never passes vacuously
  kEnvironment = 5,  ///< environment mismatch under --strict-env
  kConflict = 6,     ///< the same key with another result: a determinism alarm
  kInterrupted = kInterruptedExit
};

/// How `taut VERB` introduces itself: one per file in experiments/cli, found by its TAUT_VERB
/// line.
struct VerbEntry {
  std::string_view name;
  std::string_view summary;  ///< one line
  std::string_view example;  ///< one or more full command lines, shown below --help
  /// Adds options to the verb's parser and gives what to do once they are parsed. It may throw
  /// InputError (printed, exit 2). Data go to stdout, progress and logs to stderr.
  std::function<int()> (*bind)(Arguments&);
};

/// All verbs, sorted by name (generated; see cmake/registry.cmake).
std::span<const VerbEntry* const> verbs();

}  // namespace taut

#define TAUT_VERB(id)               \
  namespace taut {                  \
  extern const VerbEntry verb_##id; \
  }                                 \
  const taut::VerbEntry taut::verb_##id
