#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/status.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json_type.hpp"
#include "experiments/system/process.hpp"

namespace taut::external {

/// Time limit of each answer [s], unless the user gives one.
inline constexpr double kAnswerSeconds = 30;

/// A command that starts a program.
struct Command {
  std::vector<std::string> words;
  std::filesystem::path folder;     ///< working folder; empty: that of this program
  double seconds = kAnswerSeconds;  ///< time limit of each answer
  std::string text() const;         ///< readable form for messages
};

/// Splits a command into words as a shell would (quotes, ~, $NAME), without running a shell and
/// without file name patterns. Throws InputError if the text contains shell operators or names no
/// program that exists.
Command split_command(const std::string& text, const std::filesystem::path& folder);

/// Whether a name is valid: a letter, then letters, digits, _ and -, at most 40 in all.
bool is_solver_name(std::string_view);

/// Name for a program or file that the user did not name: `called`, reduced to valid characters,
/// and four digits of the digest of `told_by`, which distinguishes it from others.
std::string name_for(std::string_view called, std::string_view told_by);

/// Parses a line of a program's output. Throws InputError unless it is a JSON object.
Json parse_answer(const std::string& line);

/// A running program that speaks the protocol taut-solver over its standard input and output
/// (experiments/external/README.md). Every mistake of the program becomes a SolverFailure with the
/// end of its standard error; the program and all that it started are then killed, as they are when
/// this object is destroyed.
class Connection {
 public:
  explicit Connection(Command);  ///< throws InputError if it cannot be started

  /// Sends a request, followed by `bytes`, and returns the answer: an object without "error".
  Json ask(const Json& request, std::string_view bytes = {});
  /// Sends a line as it is and returns any answer; for bad requests.
  Json ask_line(const std::string& line);
  /// Reads exactly this number of bytes after an answer.
  std::string take(std::size_t bytes);
  [[noreturn]] void fail(Status::Kind, const std::string& reason);

  /// CPU seconds of all threads of the program.
  double cpu_seconds() const;
  std::size_t peak_bytes() const;
  /// Whether the program has started other processes since its first answer. cpu_seconds() does not
  /// include their time.
  bool has_helpers() const;

  /// Closes the program's input. Returns how it ended within `seconds`, or nothing if it had to be
  /// killed.
  std::optional<ProcessEnd> close(double seconds);
  std::string log() const;  ///< the last 4000 bytes of its standard error
  const std::filesystem::path& folder() const { return scratch_.path(); }  ///< for scene files

 private:
  std::string take_line();
  Json answer();
  /// Handles a missing answer: the program has ended, or its time is up.
  [[noreturn]] void silent(std::chrono::steady_clock::time_point deadline);
  long children_ticks() const;  ///< CPU time of the program's children that have ended
  void send(const std::string& line, std::string_view bytes);
  [[noreturn]] void ended();

  Command command_;
  Scratch scratch_;
  Process process_;
  std::string op_;            ///< the last request
  long ticks_at_start_ = -1;  ///< children_ticks() at the first answer; -1 before it
};

}  // namespace taut::external
