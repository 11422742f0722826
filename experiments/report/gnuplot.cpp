#include "experiments/report/gnuplot.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "experiments/report/format.hpp"
#include "experiments/system/files.hpp"

namespace taut::report {

namespace fs = std::filesystem;

namespace {

fs::path temporary(const fs::path& path) {
  return path.parent_path() / ("." + path.filename().string() + "." + std::to_string(getpid()));
}

/// Starts `program -e commands script` in the script's folder; gives its exit code and what it
/// said.
std::pair<int, std::string> spawn_gnuplot(const std::string& program, const fs::path& script,
                                          std::string commands) {
  const fs::path log = temporary(script);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, log.c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const std::string folder = script.has_parent_path() ? script.parent_path().string() : ".";
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  std::string name = program, option = "-e", file = script.filename().string();
  std::array<char*, 5> argv{name.data(), option.data(), commands.data(), file.data(), nullptr};
  pid_t child = 0;
  const int failed = posix_spawnp(&child, program.c_str(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  int state = 0;
  while (failed == 0 && waitpid(child, &state, 0) < 0 && errno == EINTR) {
  }
  std::string said;
  std::error_code ignored;
  if (fs::exists(log, ignored)) said = read_text(log);
  fs::remove(log, ignored);
  if (failed != 0 || (WIFEXITED(state) && WEXITSTATUS(state) == 127))
    throw PlotError(program + " cannot be started (" +
                    std::strerror(failed != 0 ? failed : ENOENT) +
                    "): install the Debian package gnuplot-nox to get figures");
  return {WIFEXITED(state) ? WEXITSTATUS(state) : -1, said};
}

}  // namespace

void run_gnuplot(const fs::path& script, const std::string& terminal, const fs::path& out,
                 const std::string& program) {
  const fs::path absolute = fs::absolute(script);
  const fs::path temp = temporary(fs::absolute(out));
  const auto [code, said] =
      spawn_gnuplot(program, absolute,
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
