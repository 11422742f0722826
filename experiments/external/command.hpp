#pragma once

#include <filesystem>
#include <string>
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

}  // namespace taut::external
