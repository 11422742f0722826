#include "experiments/history/checkout.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string_view>
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

/// Runs git without protocols, so that it fetches nothing, and without hooks. `folder` is the top
/// of a checkout, so that git does not search above it; with `anywhere` it may be any folder in
/// one.
GitAnswer git(const fs::path& folder, const std::vector<std::string>& words,
              bool anywhere = false) {
  std::vector<std::string> all{"env",
                               "GIT_ALLOW_PROTOCOL=none",
                               "GIT_NO_LAZY_FETCH=1",
                               "GIT_TERMINAL_PROMPT=0",
                               "git",
                               "-c",
                               "core.hooksPath=/dev/null",
                               "-c",
                               "core.fsmonitor=false",
                               "-c",
                               "log.showSignature=false",
                               "-C",
                               folder.string()};
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

/// Removes the variables that redirect git or configure it, as a hook has them. Left are those that
/// say where the person's own configuration is.
void forget_variables_of_git() {
  const auto is_kept = [](std::string_view name) {
    return name == "GIT_CONFIG_GLOBAL" || name == "GIT_CONFIG_SYSTEM" ||
           name == "GIT_CONFIG_NOSYSTEM" || name == "GIT_EXEC_PATH";
  };
  std::vector<std::string> names;
  for (char** one = environ; *one; ++one) {
    const std::string_view variable = *one;
    const std::string_view name = variable.substr(0, variable.find('='));
    if (name.starts_with("GIT_") && !is_kept(name)) names.emplace_back(name);
  }
  for (const std::string& name : names) unsetenv(name.c_str());
}

/// Makes a checkout of taut's own over the objects and the branches and tags of a repository. None
/// of that repository's configuration is read by git there, so none of it can name a program to
/// start; in the repository itself only rev-parse and for-each-ref are run.
void borrow(const fs::path& repository, const fs::path& checkout) {
  const auto said = [&](const std::vector<std::string>& words) {
    return stripped_end(git_or_throw(repository, words, true));
  };
  const auto path_of = [&](const char* name) {
    return fs::path(said({"rev-parse", "--path-format=absolute", "--git-path", name}));
  };
  make_folder(checkout);
  git_or_throw(checkout,
               {"init", "--quiet",
                "--template=", "--object-format=" + said({"rev-parse", "--show-object-format"}),
                checkout.string()},
               true);
  const fs::path own = checkout / ".git";
  make_folder(own / "objects" / "info");
  write_file(own / "objects" / "info" / "alternates", path_of("objects").string() + "\n");
  if (const fs::path shallow = path_of("shallow"); fs::is_regular_file(shallow))
    write_file(own / "shallow", read_text(shallow));
  const std::string refs =
      said({"for-each-ref", "--format=%(objectname) %(refname)", "refs/heads", "refs/tags"});
  std::string packed;
  std::istringstream lines(refs);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t name = line.find(" refs/heads/");
    if (name != line.npos) line.replace(name, 12, " refs/remotes/origin/");
    packed += line + "\n";
  }
  write_file(own / "packed-refs", packed);
}

constexpr const char* kFormat = "--format=%H%x09%ct%x09%s";

/// Seconds since 1970 as "2026-05-04T10:11:12Z".
std::string iso_time(const std::string& seconds) {
  const std::time_t time = whole<long long>(seconds).value_or(0);
  std::tm parts{};
  gmtime_r(&time, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

/// From a line of kFormat.
Build build_of(const std::string& line) {
  const std::vector<std::string> parts = parts_of(stripped_end(line), '\t');
  return {.id = parts.at(0),
          .made = iso_time(parts.at(1)),
          .place = 0,
          .subject = parts.size() > 2 ? printable(parts[2], 200) : ""};
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

Repository::Repository(const fs::path& folder)
    : folder_(fs::absolute(folder).lexically_normal()), own_(std::make_shared<Scratch>()) {
  if (!on_path("git")) throw InputError("git is not installed");
  std::error_code none;
  if (!fs::is_directory(folder_, none)) throw InputError(folder.string() + ": no such folder");
  forget_variables_of_git();
  const GitAnswer top = git(folder_, {"rev-parse", "--absolute-git-dir"}, true);
  if (!top.good) throw InputError(folder.string() + ": not a repository: " + top.complaint);
  borrow(folder_, own_->path());
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
  return git(own_->path(), {"merge-base", "--is-ancestor", a, b}).good;
}

std::vector<Build> Repository::broken_line(const std::string& a, const std::string& b) const {
  if (git(own_->path(), {"rev-list", "--count", "--first-parent", b}).good) return {};
  std::vector<Build> builds;
  for (std::string id = b; !id.empty();) {
    const GitAnswer one = git(own_->path(), {"log", "--no-walk", "--format=%P%x09%ct%x09%s", id});
    if (!one.good) {  // it is missing, and with it what lies before
      if (builds.empty()) return {};
      builds.push_back(
          {.id = id, .made = builds.back().made, .subject = "a commit that is missing"});
      break;
    }
    const std::string parents = one.text.substr(0, one.text.find('\t'));
    builds.push_back(build_of(id + one.text.substr(parents.size())));
    id = parents.substr(0, parents.find(' '));
    if (id.empty()) return {};
  }
  builds.push_back(build_of(git_or_throw(own_->path(), {"log", "--no-walk", kFormat, a})));
  std::ranges::reverse(builds);
  for (Build& build : builds) build.place = &build - builds.data();
  return builds;
}

std::vector<Build> Repository::line(const std::string& range) const {
  const std::size_t dots = range.find("..");
  if (dots == range.npos || dots == 0 || range.find('.', dots + 2) == dots + 2)
    throw InputError("--commits " + range + ": expected A..B, the first and the last commit");
  const std::string a = commit(range.substr(0, dots)), b = commit(range.substr(dots + 2));
  if (a == b) throw InputError("--commits " + range + ": both are the same commit");
  if (!is_ancestor(a, b)) {
    if (std::vector<Build> known = broken_line(a, b); !known.empty()) return known;
    throw InputError("--commits " + range + ": " +
                     (is_ancestor(b, a) ? "the wrong way round: the last is older than the first"
                                        : "the first does not lead to the last"));
  }
  const std::string log =
      git_or_throw(own_->path(), {"log", "--first-parent", "--reverse", kFormat, a + ".." + b});
  std::istringstream lines(git_or_throw(own_->path(), {"log", "-1", kFormat, a}) + log);
  std::vector<Build> builds;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) continue;
    builds.push_back(build_of(line));
    builds.back().place = std::ssize(builds) - 1;
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
    fs::remove_all(folder_, none);  // an incomplete one, by a process that was killed
    borrow(repository.folder(), folder_);
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
  // Where the commit's own tree is missing, checkout is content and status is not.
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"checkout", "--quiet", "--force", "--detach", commit},
        {"status", "--porcelain", "--untracked-files=no"}})
    if (const GitAnswer got = git(folder_, words); !got.good)
      return "git cannot check it out: " + got.complaint;
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
