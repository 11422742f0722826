#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// Included by the file of every verb.
#include "core/model/input_error.hpp"
#include "experiments/command_line/arguments.hpp"
#include "experiments/command_line/options.hpp"
#include "experiments/command_line/output.hpp"
#include "experiments/system/own_words.hpp"
#include "experiments/system/signals.hpp"

namespace taut {

/// Exit codes, the same for all verbs.
enum ExitCode : int {
  kPass = 0,
  kRegression = 1,  ///< a regression, a status change, a broken truth, or a failed external program
  kUsage = own_words::kBadInputExit,  ///< bad usage or input; nothing was run or written
  kIncomplete = 3,                    ///< some cases are missing
  kNothing = 4,      ///< nothing was compared: a check never passes without a comparison
  kEnvironment = 5,  ///< environment mismatch under --strict-env
  kConflict = 6,     ///< the same key with another result: a determinism alarm
  kInterrupted = kInterruptedExit
};

/// Groups of verbs: the headings of `taut --help`, in this order.
enum class VerbGroup { studies, one_case, cost, trust, extremes };

/// Names in an answer: those of its facts (`of` is "facts"), or those of a table's columns.
struct AnswerPart {
  std::string_view of;
  std::string_view names;  ///< "cases ran"; "*": names that depend on the request
};

/// Description of `taut VERB`. Each file in experiments/cli has one, which is found by its
/// TAUT_VERB line.
struct VerbEntry {
  std::string_view name;  ///< "run"; "bench effects" is a subverb of bench
  VerbGroup group = VerbGroup::studies;
  std::string_view summary;  ///< one line
  std::string_view example;  ///< one or more complete command lines, shown below --help
  /// Contents of the answer with --json; empty: no answer (answer.hpp).
  std::vector<AnswerPart> answer;
  /// Describes the verb's options and returns the function to call once they are parsed. That
  /// function may throw InputError (printed, exit code 2). Data go to stdout, progress and logs to
  /// stderr. nullptr for a verb that only has subverbs.
  std::function<int()> (*bind)(Arguments&) = nullptr;
};

/// Makes a verb's `bind` from void add_options(Arguments&, Options&) and int run(Options).
template <auto add_options, auto run, class Options>
std::function<int()> bind_options(Arguments& args, void (*)(Arguments&, Options&)) {
  const auto options = std::make_shared<Options>();
  add_options(args, *options);
  return [options] { return run(*options); };
}
template <auto add_options, auto run>
std::function<int()> bind_verb(Arguments& args) {
  return bind_options<add_options, run>(args, add_options);
}

/// All verbs, sorted by identifier (generated; see cmake/registry.cmake).
std::span<const VerbEntry* const> verbs();

/// Body of main(): finds the verb, parses its options, runs it, and returns the exit code.
int command_line(int argc, char** argv);

}  // namespace taut

#define TAUT_VERB(id)               \
  namespace taut {                  \
  extern const VerbEntry verb_##id; \
  }                                 \
  const taut::VerbEntry taut::verb_##id
