#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace taut {

/// One error in the user's input. It is printed as a compiler would: `scenes/x.toml:10:1: unknown
/// key 'resolutoin' in [cloth]; did you mean 'resolution'?`
struct Diagnostic {
  std::string file;     ///< as the user named it; empty: the command line
  int line = 0;         ///< 1-based; 0: unknown
  int column = 0;       ///< 1-based; 0: unknown, or the whole line
  std::string message;  ///< names the key that is wrong

  std::string text() const;
};

/// Bad input, with all of its errors at once. Nothing was run and nothing was written.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<Diagnostic>);
  explicit InputError(const std::string& message)
      : InputError(std::vector{Diagnostic{{}, 0, 0, message}}) {}
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

/// " did you mean 'x'?" for the candidate nearest to `word`, or "" if none is near.
std::string suggestion(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace taut
