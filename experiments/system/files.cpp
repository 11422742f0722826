#include "experiments/system/files.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <mutex>
#include <random>

#include "core/model/input_error.hpp"
#include "experiments/system/text.hpp"

namespace taut {

namespace fs = std::filesystem;

namespace {

constexpr std::time_t kAbandonedAge = 60;  ///< s; the lock of a younger folder may not be there yet

[[noreturn]] void fail(const fs::path& path, const char* what) {
  throw InputError(path.string() + ": cannot " + what + ": " + std::strerror(errno));
}

/// A file descriptor that closes itself.
class File {
 public:
  /// Error messages name `shown`.
  File(const fs::path& path, int flags, const fs::path& shown)
      : shown_(shown), fd_(open(path.c_str(), flags, 0666)) {
    if (fd_ < 0) fail(shown_, flags & O_DIRECTORY ? "open" : "write");
  }
  File(const fs::path& path, int flags) : File(path, flags, path) {}
  ~File() { close(fd_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  void write_all(std::string_view text) {
    while (!text.empty()) {
      const ssize_t written = ::write(fd_, text.data(), text.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail(shown_, "write");
      text.remove_prefix(static_cast<std::size_t>(written));
    }
  }
  void sync() {
    if (fsync(fd_) != 0 && errno != EINVAL && errno != EROFS) fail(shown_, "write");
  }

 private:
  fs::path shown_;
  int fd_;
};

std::string random_digits() {
  return formatted("%08x", static_cast<unsigned>(std::random_device{}()));
}

void replace_file(const fs::path& path, std::string_view bytes, bool durable) {
  std::error_code error;
  const fs::path target = fs::is_symlink(path, error) ? fs::weakly_canonical(path, error) : path;
  // A device or a pipe is opened by `path`: the target of a link to a pipe has no path.
  if (fs::exists(path, error) && !fs::is_regular_file(path, error)) {
    File(path, O_WRONLY | O_CLOEXEC).write_all(bytes);
    return;
  }
  const fs::path beside =
      target.parent_path() / ("." + target.filename().string() + "." + random_digits());
  const EndsWithProgram tie(beside);
  try {
    File file(beside, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, path);
    file.write_all(bytes);
    if (durable) file.sync();
    if (std::rename(beside.c_str(), target.c_str()) != 0) fail(path, "write");
  } catch (const InputError&) {
    unlink(beside.c_str());
    throw;
  }
  const fs::path folder = target.has_parent_path() ? target.parent_path() : ".";
  if (durable) File(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC).sync();
}

/// Removes folders of processes that were killed. The lock on a folder ends with its process.
void remove_abandoned(const fs::path& temporary) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(temporary, ignored)) {
    const std::string name = entry.path().filename();
    if (!name.starts_with("taut.") || name.size() != 11 || !entry.is_directory(ignored)) continue;
    const int fd = open(entry.path().c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (fd < 0) continue;
    struct stat about {};
    const bool old = fstat(fd, &about) == 0 && about.st_uid == geteuid() &&
                     std::time(nullptr) - about.st_mtime > kAbandonedAge;
    if (old && flock(fd, LOCK_EX | LOCK_NB) == 0) fs::remove_all(entry.path(), ignored);
    close(fd);
  }
}

fs::path temporary_folder() {
  std::error_code error;
  fs::path folder = fs::temp_directory_path(error);
  if (error) folder = "/tmp";
  static std::once_flag once;
  std::call_once(once, [&] { remove_abandoned(folder); });
  return folder;
}

fs::path new_scratch_folder() {
  const fs::path folder = temporary_folder();
  std::string name = fs::absolute(folder) / "taut.XXXXXX";
  if (!mkdtemp(name.data())) fail(folder, "make a folder there");
  return name;
}

}  // namespace

Scratch::Scratch()
    : with_program_(new_scratch_folder),
      lock_(open(path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  flock(lock_, LOCK_SH);
}

Scratch::~Scratch() {
  std::error_code ignored;
  close(lock_);
  fs::remove_all(path(), ignored);
}

void write_file(const fs::path& path, std::string_view bytes) { replace_file(path, bytes, false); }

void write_durably(const fs::path& path, std::string_view bytes) {
  replace_file(path, bytes, true);
}

void test_writable(const fs::path& path) {
  if (fs::is_directory(path)) throw InputError(path.string() + " is a folder; name a file in it");
  std::error_code none;
  if (fs::exists(path, none) && !fs::is_regular_file(path, none)) {  // a device or a pipe
    if (access(path.c_str(), W_OK) != 0) fail(path, "write");
    return;
  }
  if (path.has_parent_path()) make_folder(path.parent_path());
  const fs::path probe = path.string() + "." + unique_suffix();
  write_durably(probe, "");
  fs::remove(probe);
}

void append(const fs::path& path, std::string_view bytes) {
  File(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC).write_all(std::string(bytes));
}

void make_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw InputError(path.string() + ": cannot create: " + error.message());
}

std::string host_name() {
  char host[256] = "host";
  gethostname(host, sizeof host - 1);
  return host;
}

std::string unique_suffix() {
  return host_name() + "." + std::to_string(getpid()) + "." + random_digits();
}

std::string utc_stamp() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y%m%dT%H%M%SZ", &utc);
  return text;
}

}  // namespace taut
