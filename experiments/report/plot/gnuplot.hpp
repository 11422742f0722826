#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace taut::report {

/// gnuplot is missing or refused a script. Says what to do; the caller goes on without the figure.
class PlotError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Runs `script` with its folder as working directory; the picture goes to `out` by way of a
/// temporary name, and only if gnuplot succeeded and wrote something. `terminal` is the argument of
/// "set terminal"; `program` is looked up in PATH. Throws PlotError.
void run_gnuplot(const std::filesystem::path& script, const std::string& terminal,
                 const std::filesystem::path& out, const std::string& program = "gnuplot");

}  // namespace taut::report
