#include "core/io/text_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/model/input_error.hpp"

namespace taut {

void fail_in(const std::filesystem::path& file, const std::string& why, int line, int column) {
  throw InputError({{file.string(), line, column, why}});
}

namespace {

/// Opens a regular file and returns its descriptor; fails at once on anything else.
int open_regular(const std::filesystem::path& path) {
  const int fd = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  const auto fail = [&](const std::string& why) {
    if (fd >= 0) close(fd);
    fail_in(path, why);
  };
  struct stat about {};
  if (fd < 0 || fstat(fd, &about) != 0)
    fail(std::string("cannot be read: ") + std::strerror(errno));
  if (S_ISDIR(about.st_mode)) fail("is a folder, not a file");
  if (!S_ISREG(about.st_mode)) fail("is not a regular file");
  return fd;
}

}  // namespace

std::ifstream open_file(const std::filesystem::path& path) {
  close(open_regular(path));
  return std::ifstream(path, std::ios::binary);
}

std::string read_text(const std::filesystem::path& path, std::size_t most) {
  const int fd = open_regular(path);
  const auto fail = [&](const std::string& why) {
    close(fd);
    fail_in(path, why);
  };
  const auto fail_reading = [&] { fail(std::string("cannot be read: ") + std::strerror(errno)); };
  std::string text;
  char piece[65536];
  for (;;) {
    const ssize_t got = read(fd, piece, sizeof piece);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail_reading();
    if (got == 0) break;
    text.append(piece, static_cast<std::size_t>(got));
    if (text.size() > most) fail("is larger than " + std::to_string(most >> 20) + " MiB");
  }
  close(fd);
  return text;
}

}  // namespace taut
