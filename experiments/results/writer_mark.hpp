#pragma once

#include <filesystem>

namespace taut {

/// Marks a file as written by this host if other hosts may write to the same file system (NFS, SMB,
/// Lustre, ...), where locks are not reliable. The mark is <file>.writer with the text "<host>
/// <process>"; it is removed with this object. On local file systems it does nothing.
class WriterMark {
 public:
  /// Throws InputError if another host is writing the file.
  explicit WriterMark(const std::filesystem::path& file);
  ~WriterMark();
  WriterMark(const WriterMark&) = delete;
  WriterMark& operator=(const WriterMark&) = delete;

 private:
  /// Empty if there is no mark, or if another process of this host owns it.
  std::filesystem::path mark_;
};

}  // namespace taut
