// Runs gnuplot: a picture appears whole or not at all.
#include "core/model/input_error.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/plot/plot.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/process.hpp"

namespace taut::report {

namespace fs = std::filesystem;

void run_gnuplot(const fs::path& script, const std::string& terminal, const fs::path& out,
                 const std::string& program) try {
  const fs::path temp =
      fs::absolute(out).parent_path() / ("." + out.filename().string() + "." + unique_suffix());
  const EndsWithProgram tie(temp);
  Process process(
      {program, "-e", "set terminal " + terminal + "; set output " + gnuplot_string(temp.string()),
       "./" + script.filename().string()},
      {.errors = ProcessOptions::Stream::piped, .folder = fs::absolute(script).parent_path()});
  const std::string said = process.read_all();
  const int code = process.wait()->exit_code;
  std::error_code missing;
  const auto size = fs::file_size(temp, missing);
  if (code == 0 && !missing && size > 0) {
    fs::rename(temp, out);
    return;
  }
  fs::remove(temp, missing);
  throw PlotError("gnuplot could not draw " + script.string() + ": " +
                  (said.empty() ? "exit code " + std::to_string(code) : said));
} catch (const InputError& error) {
  throw PlotError(std::string(error.what()) +
                  ": install the Debian package gnuplot-nox to get figures");
}

}  // namespace taut::report
