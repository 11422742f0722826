#include "experiments/command_line/streams.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <string>
#include <string_view>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"

namespace taut {

DiscardedOutput::DiscardedOutput() : stdout_(dup(1)) {
  std::cout << std::flush;
  std::fflush(stdout);
  const int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
  dup2(nothing, 1);
  close(nothing);
}
DiscardedOutput::~DiscardedOutput() {
  std::cout << std::flush;
  std::fflush(stdout);
  dup2(stdout_, 1);
  close(stdout_);
}

PrintableErrors::PrintableErrors() : stderr_(std::cerr.rdbuf(this)) {}
PrintableErrors::~PrintableErrors() { std::cerr.rdbuf(stderr_); }

std::streamsize PrintableErrors::xsputn(const char* text, std::streamsize size) {
  constexpr std::string_view kErased = "\r\033[K";
  const std::string_view all(text, static_cast<std::size_t>(size));
  if (all == kErased) return stderr_->sputn(text, size);
  std::string shown;
  for (std::size_t end, begin = 0; begin < all.size(); begin = end) {
    end = std::min(all.find('\n', begin), all.size() - 1) + 1;
    shown += printable(all.substr(begin, end - begin));  // this cuts very long lines
  }
  stderr_->sputn(shown.data(), static_cast<std::streamsize>(shown.size()));
  return size;
}
PrintableErrors::int_type PrintableErrors::overflow(int_type c) {
  const char one = traits_type::to_char_type(c);
  if (!traits_type::eq_int_type(c, traits_type::eof())) xsputn(&one, 1);
  return traits_type::not_eof(c);
}
int PrintableErrors::sync() { return stderr_->pubsync(); }

void open_standard_descriptors() {
  for (const int mode : {O_RDONLY, O_RDONLY, O_WRONLY}) {
    const int fd = open("/dev/null", mode);
    if (fd <= STDERR_FILENO) continue;
    close(fd);
    break;
  }
}

void flush_output() {
  if (!(std::cout << std::flush) || std::fflush(stdout) != 0)
    throw InputError("standard output cannot be written");
}

}  // namespace taut
