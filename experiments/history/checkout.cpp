#include "experiments/history/checkout.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <sstream>
#include <thread>

#include "core/io/text_file.hpp"
#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/process.hpp"
#include "experiments/system/signals.hpp"

namespace taut {

namespace fs = std::filesystem;

namespace {

struct GitAnswer {
  bool good = false;
  std::string text, complaint;
};

/// Runs git so that nothing named by a repository's files or configuration is started. `folder` is
/// the top of a checkout, so that git does not search above it; with `anywhere` it may be any
/// folder in one.
GitAnswer git(const fs::path& folder, const std::vector<std::string>& words,
              bool anywhere = false) {
  std::vector<std::string> all{
      "git", "-c", "core.hooksPath=/dev/null", "-c", "core.fsmonitor=false", "-C", folder.string()};
  if (!anywhere)
    all.insert(all.end(),
               {"--git-dir", (folder / ".git").string(), "--work-tree", folder.string()});
  all.insert(all.end(), words.begin(), words.end());
  const Scratch scratch;
  Process process(all, {.output = ProcessOptions::Stream::piped,
                        .errors_file = scratch.path() / "errors",
                        .folder = {},
                        .limits = {}});
  GitAnswer answer;
  answer.text = process.read_all();
  const auto end = process.wait();
  answer.good = end && end->good();
  answer.complaint = printable(last_line(std::ifstream(scratch.path() / "errors")), 300);
  return answer;
}

std::string git_or_throw(const fs::path& folder, const std::vector<std::string>& words,
                         bool anywhere = false) {
  const GitAnswer answer = git(folder, words, anywhere);
  if (!answer.good)
    throw InputError(folder.string() + ": git " + words[0] + ": " + answer.complaint);
  return answer.text;
}

std::string stripped_end(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

/// Seconds since 1970 as "2026-05-04T10:11:12Z".
std::string iso_time(const std::string& seconds) {
  const std::time_t time = std::atoll(seconds.c_str());
  std::tm parts{};
  gmtime_r(&time, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

double bytes_in(const fs::path& folder) {
  double bytes = 0;
  std::error_code none;
  for (fs::recursive_directory_iterator at(folder, none), end; at != end; at.increment(none))
    if (!none && at->is_regular_file(none)) bytes += static_cast<double>(at->file_size(none));
  return bytes;
}

/// Why the disk is too full to continue; "" if it is not.
std::string full(const fs::path& folder) {
  constexpr std::uintmax_t kLeast = std::uintmax_t{200} << 20;
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  if (error || space.available >= kLeast) return {};
  return folder.string() + ": " + std::to_string(space.available >> 20) +
         " MB are left on this disk; a build needs 200";
}

}  // namespace

Repository::Repository(const fs::path& folder) : folder_(fs::absolute(folder).lexically_normal()) {
  if (!on_path("git")) throw InputError("git is not installed");
  std::error_code none;
  if (!fs::is_directory(folder_, none)) throw InputError(folder.string() + ": no such folder");
  // A hook sets these, and they would redirect git.
  for (const char* name : {"GIT_DIR", "GIT_WORK_TREE", "GIT_INDEX_FILE", "GIT_PREFIX"})
    unsetenv(name);
  const GitAnswer top = git(folder_, {"rev-parse", "--absolute-git-dir"}, true);
  if (!top.good) throw InputError(folder.string() + ": not a repository: " + top.complaint);
}

std::string Repository::commit(const std::string& name) const {
  const GitAnswer found = git(folder_,
                              {"rev-parse", "--verify", "--quiet", "--end-of-options",
                               (name.empty() ? "HEAD" : name) + "^{commit}"},
                              true);
  if (!found.good)
    throw InputError("'" + printable(name) + "' is not a commit of " + folder_.string());
  return stripped_end(found.text);
}

bool Repository::is_ancestor(const std::string& a, const std::string& b) const {
  return git(folder_, {"merge-base", "--is-ancestor", a, b}, true).good;
}

std::vector<Build> Repository::line(const std::string& range) const {
  const std::size_t dots = range.find("..");
  if (dots == range.npos || dots == 0 || range.find('.', dots + 2) == dots + 2)
    throw InputError("--commits " + range + ": expected A..B, the first and the last commit");
  const std::string a = commit(range.substr(0, dots)), b = commit(range.substr(dots + 2));
  if (a == b) throw InputError("--commits " + range + ": both are the same commit");
  if (!is_ancestor(a, b))
    throw InputError("--commits " + range + ": " +
                     (is_ancestor(b, a) ? "the wrong way round: the last is older than the first"
                                        : "the first does not lead to the last"));
  const std::string log = git_or_throw(
      folder_, {"log", "--first-parent", "--reverse", "--format=%H%x09%ct%x09%s", a + ".." + b},
      true);
  std::istringstream lines(
      git_or_throw(folder_, {"log", "-1", "--format=%H%x09%ct%x09%s", a}, true) + log);
  std::vector<Build> builds;
  for (std::string line; std::getline(lines, line);) {
    const std::vector<std::string> parts = parts_of(line, '\t');
    if (parts.size() < 2) continue;
    builds.push_back({.id = parts[0],
                      .made = iso_time(parts[1]),
                      .place = static_cast<std::int64_t>(builds.size()),
                      .subject = parts.size() > 2 ? printable(parts[2], 200) : ""});
  }
  return builds;
}

Checkout::Checkout(const Repository& repository, const fs::path& folder)
    : folder_(fs::absolute(folder).lexically_normal()) {
  make_folder(folder_.parent_path());
  lock_ = open((folder_.string() + ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock_ < 0 || flock(lock_, LOCK_EX | LOCK_NB) != 0)
    throw InputError(folder_.string() + ": another taut history is at work there");
  std::error_code none;
  if (!git(folder_, {"rev-parse", "--git-dir"}).good) {
    fs::remove_all(folder_, none);  // an incomplete clone by a process that was killed
    git_or_throw(repository.folder(),
                 {"clone", "--quiet", "--shared", "--no-checkout", repository.folder().string(),
                  folder_.string()},
                 true);
  }
  fs::remove(folder_ / ".git" / "index.lock", none);
}

Checkout::~Checkout() {
  if (lock_ >= 0) close(lock_);
}

std::string Checkout::state() const {
  return stripped_end(git_or_throw(folder_, {"rev-parse", "HEAD"})) + "\n" +
         git_or_throw(folder_, {"status", "--porcelain", "--untracked-files=no"});
}

std::string Checkout::changed() const {
  const std::string now = state();
  if (now == state_) return {};
  if (!now.starts_with(commit_))
    return folder_.string() + ": somebody checked out another commit there";
  return folder_.string() + ": files of the commit changed after its build";
}

std::string Checkout::build(const std::string& commit, const std::string& command,
                            const BuildLimits& limits) {
  if (const std::string why = full(folder_); !why.empty()) throw InputError(why);
  commit_.clear();
  git_or_throw(folder_, {"checkout", "--quiet", "--force", "--detach", commit});
  if (!command.empty()) {
    const fs::path log = folder_.string() + ".log";
    const SteadyClock::time_point start = SteadyClock::now();
    Process process(
        {"/bin/sh", "-c", "exec >\"$0\" 2>&1\n" + command, log.string()},
        {.folder = folder_, .limits = {.file_bytes = static_cast<std::size_t>(limits.bytes)}});
    std::optional<ProcessEnd> end;
    while (!(end = process.poll())) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      if (GracefulStop::requested()) throw Interrupted();
      if (const std::string why = full(folder_); !why.empty()) throw InputError(why);
      if (seconds_since(start) > limits.seconds)
        return "its build takes more than " + shortest(limits.seconds) + " s";
    }
    if (!end->good())
      return "its build ends with " + end->text() + ": " +
             printable(last_line(std::ifstream(log)), 300);
    if (const double bytes = bytes_in(folder_); bytes > limits.bytes)
      return "its build takes " + shortest(std::round(bytes / 1e8) / 10) +
             " GB of disk, more than " + shortest(limits.bytes / 1e9);
  }
  commit_ = commit;
  state_ = state();
  return {};
}

}  // namespace taut
