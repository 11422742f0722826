#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiments/case/case.hpp"
#include "experiments/case/record.hpp"
#include "experiments/study/pack.hpp"

namespace taut {

/// A trajectory (experiments/case/trajectory.hpp) of about kFrames + 1 moments, first and last
/// included.
inline constexpr const char* kFramesFile = "frames.traj";
inline constexpr int kFrames = 32;

/// Results by content address. No locks and no shared appends: any number of processes may write,
/// and one that is killed leaves at most a folder in tmp/, which is removed later.
///
///     <root>/store/7f/7f3a.../  case.json    the record
///                               series.csv   values over time, if there are any
///                               frames.traj  the motion at some moments, if it was asked for
///                               stderr.txt   what the case said, if it said anything
///                               status.json  digests of the others; written last
///     <root>/packs/*.pack                     many small entries in one file: pack.hpp
///     <root>/tmp/<key>.<host>.<pid>.<rand>/   an entry that is being written
///     <root>/corrupt/<key>.<rand>/            entries that did not match their digests
///     <root>/conflicts/<key>.<rand>/          another result under a key that has one
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

  const std::filesystem::path& root() const { return root_; }
  std::filesystem::path folder(const std::string& key) const;

  /// The stored record; nothing if there is none. An entry that is damaged is set aside, said so,
  /// and counts as none.
  std::optional<Record> find(const std::string& key) const;
  /// The same, under the names by which this case is called.
  std::optional<Record> find(const Case&) const;
  /// Values over time of a stored case; empty if it has none.
  Series series(const std::string& key) const;
  /// Everything that is kept of a case; empty if there is none.
  EntryParts parts(const std::string& key) const;
  /// Whether the motion of a stored case is kept, as folder(key) / kFramesFile.
  bool has_frames(const std::string& key) const;

  /// Makes sure that results can be written, and removes what killed processes of this host.
  /// Throws InputError with the reason.
  void prepare() const;
  /// An empty folder in tmp/ for a case to write into.
  std::filesystem::path stage(const std::string& key) const;

  enum class Commit {
    stored,    ///< new, or in place of a failure or of the same result without frames
    same,      ///< the same result was there
    conflict,  ///< another result was there: a determinism alarm; ours is in conflicts/
  };
  /// Turns a staged folder into the entry of its record, whole or not at all; it survives the loss
  /// of power. A result is never replaced; a failure is. Throws InputError if the disk refuses.
  Commit commit(const std::filesystem::path& staged, const Record&) const;
  /// The same for an entry that is held in memory; this store packs.
  Commit commit(EntryParts, const Record&) const;

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
  /// Where the entry is in a pack file; nullptr: it is in its folder, or there is none.
  const PackIndex::Place* packed(const std::string& key) const;
  std::optional<StoredEntry> entry(const std::string& key) const;
  /// Takes the damaged entry away; false if it cannot be.
  bool set_aside(const std::string& key, const std::string& why) const;
  std::filesystem::path root_;
  Notice notice_;
  mutable std::shared_ptr<Packs> packs_;
};

/// Where results go unless the user says otherwise: runs in the results folder.
std::filesystem::path default_results();

}  // namespace taut
