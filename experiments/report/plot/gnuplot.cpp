#include "experiments/report/plot/gnuplot.hpp"

#include "core/model/input_error.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/process.hpp"

namespace taut::report {

namespace fs = std::filesystem;

namespace {

fs::path temporary(const fs::path& path) {
  return path.parent_path() / ("." + path.filename().string() + "." + unique_suffix());
}

/// Runs `program -e commands script` in the script's folder; gives its exit code and what it said.
std::pair<int, std::string> run_program(const std::string& program, const fs::path& script,
                                        const std::string& commands) try {
  Process process({program, "-e", commands, "./" + script.filename().string()},
                  {.errors = ProcessOptions::Stream::piped, .folder = script.parent_path()});
  const std::string said = process.read_all();
  return {process.wait()->exit_code, said};
} catch (const InputError& error) {
  throw PlotError(std::string(error.what()) +
                  ": install the Debian package gnuplot-nox to get figures");
}

}  // namespace

void run_gnuplot(const fs::path& script, const std::string& terminal, const fs::path& out,
                 const std::string& program) {
  const fs::path absolute = fs::absolute(script);
  const fs::path temp = temporary(fs::absolute(out));
  const EndsWithProgram tie(temp);
  const auto [code, said] =
      run_program(program, absolute,
                  "set terminal " + terminal + "; set output " + gnuplot_string(temp.string()));
  std::error_code missing;
  const auto size = fs::file_size(temp, missing);
  if (code == 0 && !missing && size > 0) {
    fs::rename(temp, out);
    return;
  }
  fs::remove(temp, missing);
  throw PlotError("gnuplot could not draw " + script.string() + ": " +
                  (said.empty() ? "exit code " + std::to_string(code) : said));
}

}  // namespace taut::report
