#pragma once

#include <filesystem>

namespace taut {

/// Says, on a file system that other hosts may write too (NFS, SMB, Lustre, ...), that this host
/// writes a file: locks are not reliable there. The mark is <file>.writer, "<host> <process>", and
/// goes with this object. Elsewhere it does nothing.
class WriterMark {
 public:
  /// Throws InputError if another host writes the file.
  explicit WriterMark(const std::filesystem::path& file);
  ~WriterMark();
  WriterMark(const WriterMark&) = delete;
  WriterMark& operator=(const WriterMark&) = delete;

 private:
  std::filesystem::path mark_;  ///< empty: another process of this host, or nobody, keeps it
};

}  // namespace taut
