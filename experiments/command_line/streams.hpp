#pragma once

#include <streambuf>

namespace taut {

/// Discards everything written to stdout during its lifetime.
class DiscardedOutput {
 public:
  DiscardedOutput();
  ~DiscardedOutput();
  DiscardedOutput(const DiscardedOutput&) = delete;
  DiscardedOutput& operator=(const DiscardedOutput&) = delete;

 private:
  int stdout_;
};

/// During its lifetime, stderr shows no control characters from names, files or other programs,
/// which a terminal might obey. Only those that taut itself writes remain: "\r" and "\033[K".
class PrintableErrors : public std::streambuf {
 public:
  PrintableErrors();
  ~PrintableErrors() override;
  PrintableErrors(const PrintableErrors&) = delete;
  PrintableErrors& operator=(const PrintableErrors&) = delete;

 protected:
  std::streamsize xsputn(const char* text, std::streamsize size) override;
  int_type overflow(int_type c) override;
  int sync() override;

 private:
  std::streambuf* stderr_;
};

/// Opens descriptors 0 to 2 if they are closed, since otherwise a file that this program opens
/// would take their place. A missing standard output is opened read-only, so that writing to it
/// fails and is reported.
void open_standard_descriptors();

/// Throws InputError if standard output cannot be written.
void flush_output();

}  // namespace taut
