#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

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

}  // namespace taut::external
