// Runs gnuplot so that a picture appears completely or not at all.
#include <algorithm>
#include <fstream>

#include "core/model/input_error.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/plot/plot.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/process.hpp"

namespace taut::report {

namespace fs = std::filesystem;

namespace {

/// Whether the picture is complete. gnuplot does not notice a full disk.
bool is_whole(const fs::path& picture) {
  constexpr std::size_t kEnd = 32;
  std::ifstream in(picture, std::ios::binary | std::ios::ate);
  const auto size = in ? static_cast<std::size_t>(in.tellg()) : 0;
  std::string end(std::min(size, kEnd), '\0');
  in.seekg(static_cast<std::streamoff>(size - end.size()));
  in.read(end.data(), static_cast<std::streamsize>(end.size()));
  return end.find("</svg>") != std::string::npos || end.find("%%EOF") != std::string::npos;
}

}  // namespace

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
  if (code == 0 && is_whole(temp)) {
    fs::rename(temp, out);
    return;
  }
  std::error_code missing;
  fs::remove(temp, missing);
  if (code == 0 && said.empty())
    throw FigureNotWritten(out.string() +
                           ": gnuplot did not write it to its end: is the disk full?");
  throw PlotError("gnuplot could not draw " + script.string() + ": " +
                  (said.empty() ? "exit code " + std::to_string(code) : said));
} catch (const FigureNotWritten&) {
  throw;
} catch (const InputError& error) {
  throw PlotError(std::string(error.what()) +
                  ": install the Debian package gnuplot-nox to get figures");
}

}  // namespace taut::report
