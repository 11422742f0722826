#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

namespace taut {

/// What an entry of a store is made of, by file name ("case.json", "series.csv", "stderr.txt").
using EntryParts = std::map<std::string, std::string>;

/// Entries of a store in one file, for cases that are many and small: for each a line of JSON (its
/// seal, with the size in bytes of every part), then the parts. One process appends to a file and
/// nobody else, so no lock is needed; of an entry that was cut off nothing is seen.
class PackWriter {
 public:
  /// Nothing is created before the first entry. What was appended is on the disk after every
  /// `batch` bytes (0: after every entry) and after flush().
  PackWriter(std::filesystem::path file, std::size_t batch)
      : file_(std::move(file)), batch_(batch) {}
  const std::filesystem::path& file() const { return file_; }
  /// Gives where the entry begins. Throws InputError with the system's reason.
  std::uint64_t append(const std::string& seal, const EntryParts&);
  void flush();

 private:
  std::filesystem::path file_;
  std::size_t batch_;
  std::string waiting_;
  std::uint64_t size_ = 0;
};

/// Where the entries of all pack files of a folder are; the files stay closed and unread.
struct PackIndex {
  struct Place {
    std::uint32_t pack = 0;
    bool result = false;  ///< of its status, not a failure
    std::uint64_t offset = 0;
  };
  std::vector<std::filesystem::path> packs;
  std::unordered_map<std::string, Place> places;  ///< by key
  std::vector<std::string> conflicts;             ///< keys of which two packs hold other results
  std::vector<std::string> damaged;               ///< sentences: which file, from which byte on

  /// Reads the seals of <root>/packs/*.pack. A result goes before a failure, then the first file's.
  static PackIndex of(const std::filesystem::path& root);
};

/// An entry that is there: in a folder, its seal and its parts a file each, or in a pack file.
class StoredEntry {
 public:
  explicit StoredEntry(std::filesystem::path folder) : place_(std::move(folder)) {}
  /// Throws InputError if it is not there whole.
  StoredEntry(std::filesystem::path pack, std::uint64_t offset);
  std::string seal() const;                         ///< throws InputError: it cannot be read
  std::string part(const std::string& name) const;  ///< "" if it has none of that name

 private:
  std::filesystem::path place_;
  std::string seal_;                                                    ///< in a pack file
  std::map<std::string, std::pair<std::uint64_t, std::size_t>> parts_;  ///< there: offset and size
};

}  // namespace taut
