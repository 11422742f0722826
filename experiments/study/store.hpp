#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "experiments/case/case.hpp"
#include "experiments/case/record.hpp"
#include "experiments/case/trajectory.hpp"

namespace taut {

/// What an entry of a store is made of, by file name ("case.json", "series.csv", "stderr.txt").
using EntryParts = std::map<std::string, std::string>;

/// Many entries of a store in one file, for cases that are many and small. One process appends to a
/// file and nobody else, so no lock is needed; of an entry that was cut off nothing is seen.
class PackWriter {
 public:
  /// Nothing is created before the first entry. What was appended is on the disk after every
  /// `batch` bytes (0: after every entry) and after flush().
  PackWriter(std::filesystem::path file, std::size_t batch)
      : file_(std::move(file)), batch_(batch) {}
  const std::filesystem::path& file() const { return file_; }
  /// Gives where the entry begins. Throws InputError with the system's reason.
  std::uint64_t append(const std::string& entry);
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

/// An entry that is there: a line of JSON (its seal, with the size in bytes of every part), then
/// the parts.
class StoredEntry {
 public:
  /// Throws InputError if it is not there whole.
  explicit StoredEntry(std::filesystem::path file, std::uint64_t offset = 0);
  /// None if there is no such file. It stays open: another process may replace it at any moment.
  static std::optional<StoredEntry> in(const std::filesystem::path& file);
  const std::string& seal() const { return seal_; }
  bool has(const std::string& name) const { return parts_.contains(name); }
  std::string part(const std::string& name) const;  ///< "" if it has none of that name

 private:
  StoredEntry(std::filesystem::path file, std::ifstream in, std::uint64_t offset);

  std::filesystem::path place_;
  mutable std::ifstream in_;
  std::string seal_;
  std::map<std::string, std::pair<std::uint64_t, std::size_t>> parts_;  ///< offset and size
};

/// A trajectory (experiments/case/trajectory.hpp) of about kFrames + 1 moments, first and last
/// included.
inline constexpr const char* kFramesFile = "frames.traj";
inline constexpr int kFrames = 32;

/// Results by content address. No locks and no shared appends: any number of processes may write,
/// and one that is killed leaves at most a folder or a file in tmp/, which is removed later.
///
///     <root>/store/7f/7f3a...   an entry: its seal, and after it, as far as there are any,
///                               case.json    the record
///                               series.csv   values over time
///                               frames.traj  the motion at some moments, if it was asked for
///                               stderr.txt   what the case said
///     <root>/packs/*.pack       many small entries in one file
///     <root>/tmp/<key>.<host>.<pid>.<rand>/   what a case is writing
///     <root>/corrupt/<key>.<rand>             entries that did not match their digests
///     <root>/conflicts/<key>.<rand>           another result under a key that has one
///     <root>/sessions/<utc>-<host>.<pid>.<rand>/   who ran what: session.hpp
class Store {
 public:
  /// Says what it had to do ("corrupt entry ... set aside"); default: stderr.
  using Notice = std::function<void(const std::string&)>;
  /// Nothing is created before something is written.
  explicit Store(std::filesystem::path root, Notice notice = {});

  /// From now on entries go into <root>/packs/<name>.pack, which nobody else writes; cases are
  /// staged below $TMPDIR. Entries are on the disk after every `batch` bytes (0: each at once) and
  /// flush().
  void pack_into(const std::string& name, std::size_t batch = 0);
  /// Throws InputError if the disk refuses.
  void flush() const;

  static bool is_at(const std::filesystem::path& root) {
    return std::filesystem::is_directory(root / "store") ||
           std::filesystem::is_directory(root / "packs");
  }
  const std::filesystem::path& root() const { return root_; }
  std::filesystem::path file(const std::string& key) const;

  /// The stored record; nothing if there is none. An entry that is damaged is set aside, said so,
  /// and counts as none.
  std::optional<Record> find(const std::string& key) const;
  /// The same, under the names by which this case is called.
  std::optional<Record> find(const Case&) const;
  /// Values over time of a stored case; empty if it has none.
  Series series(const std::string& key) const;
  /// Everything that is kept of a case; empty if there is none.
  EntryParts parts(const std::string& key) const;
  /// Whether the motion of a stored case is kept, and that motion.
  bool has_frames(const std::string& key) const;
  Trajectory motion(const std::string& key) const;

  /// Makes sure that results can be written, and removes what killed processes of this host left.
  /// Entries of an earlier taut, folders, are set aside in `store.earlier`; who reads is refused.
  /// Throws InputError with the reason.
  void prepare() const;
  /// An empty folder in tmp/ for a case to write into.
  std::filesystem::path stage(const std::string& key) const;

  enum class Commit {
    stored,    ///< new, or in place of a failure or of the same result without frames
    same,      ///< the same result was there
    conflict,  ///< another result was there: a determinism alarm; ours is in conflicts/
  };
  /// Makes parts, or a staged folder, which goes, the entry of its record, whole or not at all; it
  /// survives the loss of power. A result is never replaced; a failure is. (On a file system
  /// without links and without renames that refuse to replace, the last of two results that come at
  /// once stays.) Throws InputError if the disk refuses.
  Commit commit(EntryParts, const Record&) const;
  Commit commit(const std::filesystem::path& staged, const Record&) const;

  /// Keys of all entries, sorted.
  std::vector<std::string> keys() const;
  /// SHA-256 over the keys and results of all undamaged entries that are results: two stores that
  /// know the same have the same.
  std::string digest() const;
  /// Keys of which this store was given another result, too: in conflicts/ and in pack files.
  std::vector<std::string> conflicts() const;

 private:
  struct Packs;
  Packs& packs() const;  ///< read when they are first asked for
  /// Where the entry is in a pack file; nullptr: it is a file of its own, or there is none.
  const PackIndex::Place* packed(const std::string& key) const;
  std::optional<StoredEntry> entry(const std::string& key) const;
  /// Takes the damaged entry away; one that another process put there meanwhile comes back. False
  /// if nothing can be done.
  bool set_aside(const std::string& key, const std::string& why) const;
  /// So that a result is created and replaces nothing; one that another process put there since
  /// goes back.
  void take_failure_away(const std::string& key) const;
  std::filesystem::path root_;
  Notice notice_;
  mutable std::shared_ptr<Packs> packs_;
};

/// Where results go unless the user says otherwise: runs in the results folder.
std::filesystem::path default_results();

}  // namespace taut
