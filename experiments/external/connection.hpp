#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"
#include "experiments/system/process.hpp"

namespace taut::external {

/// How a program is called.
struct Command {
  std::vector<std::string> words;
  std::filesystem::path folder;  ///< where it runs; empty: where this program does
  double seconds = 30;           ///< for each answer
  std::string text() const;      ///< for people
};

/// Splits a command as a shell would (quotes, ~, $NAME, file name patterns), but no shell runs it.
/// Throws InputError if it holds operators of a shell or names no program.
Command split_command(const std::string& text, const std::filesystem::path& folder);

/// Letters, digits, _ and -, at most 40, a letter first.
bool is_solver_name(std::string_view);

/// A name for a program or a file that the user gave none: what it is called, as far as a name may
/// hold it, and four digits of what it is told by, so that no two share theirs.
std::string name_for(std::string_view called, std::string_view told_by);

/// A line of a program's output. Throws InputError unless it is a JSON object.
Json parse_answer(const std::string& line);

/// A running program that speaks taut-solver/1 over its standard input and output
/// (experiments/external/README.md). Whatever it does wrong is a SolverFailure with the end of its
/// standard error; it and all that it started die then, and with this object.
class Connection {
 public:
  explicit Connection(Command);  ///< throws InputError if it cannot be started

  /// Sends a request, and bytes after its line, and returns the answer: an object without "error".
  Json ask(const Json& request, std::string_view bytes = {});
  /// Sends a line as it is and returns the answer, whatever it says: for bad requests.
  Json ask_line(const std::string& line);
  /// Exactly so many bytes, which follow an answer.
  std::string take(std::size_t bytes);
  [[noreturn]] void fail(const std::string& status, const std::string& reason);

  /// CPU seconds of all its threads; its largest resident set.
  double cpu_seconds() const;
  std::size_t peak_bytes() const;
  /// Whether it has started other processes since its first answer, whose time cpu_seconds() does
  /// not hold.
  bool has_helpers() const;

  /// Closes its input; how it ended within so many seconds, or nothing: it had to be killed.
  std::optional<ProcessEnd> close(double seconds);
  std::string log() const;  ///< the last 4000 bytes of its standard error
  const std::filesystem::path& folder() const { return scratch_.path(); }  ///< for scene files

 private:
  std::string take_line();
  Json answer();
  /// No answer came: it has ended, or its time is up.
  [[noreturn]] void silent(std::chrono::steady_clock::time_point deadline);
  long children_ticks() const;  ///< CPU time of its children that have ended
  void send(const std::string& line, std::string_view bytes);
  [[noreturn]] void ended();

  Command command_;
  Scratch scratch_;
  Process process_;
  std::string op_;            ///< what was asked last
  long ticks_at_start_ = -1;  ///< children_ticks() at its first answer; -1: before
};

}  // namespace taut::external
