#include "experiments/system/files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iterator>
#include <random>

#include "core/model/input_error.hpp"

namespace taut {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& path, const char* what) {
  throw InputError(path.string() + ": cannot " + what + ": " + std::strerror(errno));
}

/// A file descriptor that closes itself.
class File {
 public:
  File(const fs::path& path, int flags) : path_(path), fd_(open(path.c_str(), flags, 0666)) {
    if (fd_ < 0) fail(path_, "open");
  }
  ~File() { close(fd_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  void write_all(std::string_view text) {
    while (!text.empty()) {
      const ssize_t written = ::write(fd_, text.data(), text.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail(path_, "write");
      text.remove_prefix(static_cast<std::size_t>(written));
    }
  }
  void sync() {
    if (fsync(fd_) != 0 && errno != EINVAL && errno != EROFS) fail(path_, "write");
  }

 private:
  fs::path path_;
  int fd_;
};

}  // namespace

std::string read_text(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path.string() + ": cannot read");
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_durably(const fs::path& path, std::string_view text) {
  File file(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC);
  file.write_all(text);
  file.sync();
}

void write_whole(const fs::path& path, std::string_view text) {
  const fs::path beside = path.string() + "." + unique_suffix();
  std::error_code error;
  try {
    write_durably(beside, text);
  } catch (const InputError&) {
    fs::remove(beside, error);
    throw;
  }
  fs::rename(beside, path, error);
  if (!error) return;
  std::error_code ignored;
  fs::remove(beside, ignored);
  throw InputError(path.string() + ": cannot write: " + error.message());
}

void test_writable(const fs::path& path) {
  if (fs::is_directory(path)) throw InputError(path.string() + " is a folder; name a file in it");
  if (path.has_parent_path()) make_folder(path.parent_path());
  const fs::path probe = path.string() + "." + unique_suffix();
  write_durably(probe, "");
  fs::remove(probe);
}

void append_line(const fs::path& path, std::string_view line) {
  File(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC).write_all(std::string(line) + '\n');
}

void sync_folder(const fs::path& path) { File(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC).sync(); }

void make_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw InputError(path.string() + ": cannot create: " + error.message());
}

std::string unique_suffix() {
  char host[256] = "host";
  gethostname(host, sizeof host - 1);
  char digits[16];
  std::snprintf(digits, sizeof digits, "%08x", static_cast<unsigned>(std::random_device{}()));
  return std::string(host) + "." + std::to_string(getpid()) + "." + digits;
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
