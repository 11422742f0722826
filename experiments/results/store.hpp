#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/case/case.hpp"
#include "experiments/case/record.hpp"
#include "experiments/case/trajectory.hpp"
#include "experiments/results/session.hpp"

namespace taut {

class Database;

/// What a case leaves beside its record: texts of the files of its folder, "" where there is none.
struct CaseFiles {
  std::string series;  ///< kSeriesFile: values over time, as to_json(Series) has them
  std::string motion;  ///< kFramesFile
  std::string errors;  ///< stderr.txt, of which the end is kept
};
inline constexpr const char* kSeriesFile = "series.json";
/// Frames (experiments/case/trajectory.hpp) of about kFrames + 1 moments, first and last included.
inline constexpr const char* kFramesFile = "frames";
inline constexpr int kFrames = 32;

/// All that a results folder holds, in one SQLite file, <root>/results.db: its tables and views are
/// in experiments/results/schema.cpp. Several processes may write; each waits until the other is
/// done. What was committed survives the loss of power, and a process that is killed leaves nothing
/// half done.
class Store {
 public:
  /// Says what it had to do ("damaged, set aside as ..."); default: stderr.
  using Notice = std::function<void(const std::string&)>;
  /// Nothing is created before something is written.
  explicit Store(std::filesystem::path root, Notice notice = {});

  static bool is_at(const std::filesystem::path& root) {
    return std::filesystem::exists(root / "results.db");
  }
  const std::filesystem::path& root() const { return root_; }
  std::filesystem::path file() const { return root_ / "results.db"; }

  /// The stored record; nothing if there is none. A record whose digest does not match is reported
  /// and treated as missing. Throws InputError if the file is damaged or cannot be read.
  std::optional<Record> find(const std::string& key) const;
  /// The same, under the names by which this case is called.
  std::optional<Record> find(const Case&) const;
  /// Values over time of a stored case; empty if it has none.
  Series series(const std::string& key) const;
  /// Whether the motion of a stored case is kept, and that motion.
  bool has_frames(const std::string& key) const;
  Trajectory motion(const std::string& key) const;

  /// Makes sure that results can be written. Sets a damaged file aside, with a notice, and begins a
  /// new one. Leaves results of an earlier taut alone, with a notice. Throws InputError with the
  /// reason, also if another host writes here through a network file system.
  void prepare();
  /// An empty folder below $TMPDIR for a case to write into. Throws InputError.
  std::filesystem::path stage(const std::string& key);

  enum class Commit {
    stored,    ///< new, or in place of a failure or of the same result without frames
    same,      ///< the same result was there
    conflict,  ///< another result was there: a determinism alarm; ours is among the conflicts
  };
  /// Keeps a record with all its files, or nothing. A result is never replaced; a failure is.
  /// Throws InputError if the disk refuses.
  Commit commit(const Record&, const CaseFiles& = {});
  /// The same of a staged folder, which goes.
  Commit commit(const std::filesystem::path& staged, const Record&);
  /// Many commits as one: all of them or, if `work` throws, none.
  void together(const std::function<void()>& work);

  /// What is known of a stored case without reading it all.
  struct Entry {
    std::string key, id;
    std::string result;  ///< result_digest, computed
    bool is_result = false;
  };
  /// Sorted by key. Records whose digest does not match are reported and left out.
  std::vector<Entry> entries() const;
  std::vector<std::string> keys() const;  ///< as they were stored
  /// SHA-256 over the keys and results of all cases that are results: two stores that know the same
  /// have the same.
  std::string digest() const;
  /// Keys that were committed with conflicting results, once for each conflict.
  std::vector<std::string> conflicts() const;

  /// Notes who runs what: command, host and time, and every case that is planned, of all shards, in
  /// place of what was planned of the study before.
  /// Throws InputError; then nothing is noted.
  void begin_session(const std::string& command, const std::vector<StudyCases>& = {},
                     const Shard& = {});
  /// What the sessions were to run, each key once, sorted by key.
  std::vector<PlannedKey> planned() const;
  /// Marks cases that a merge went without: reports say so until they come. Throws InputError.
  void mark_missing(const std::vector<PlannedKey>&);
  std::vector<Missing> still_missing() const;  ///< by study

  /// Keeps what a verb found in place of what was found of this kind and subject before. Throws
  /// InputError.
  void keep(const Answer&);
  /// What `program` (program_digest) found of this kind, by subject. Throws InputError: damaged.
  std::vector<Answer> answers(const std::string& kind, std::string_view program) const;

  /// Takes over the cases and sessions of another store: results before failures, nothing twice,
  /// and only what matches its digest, which replaces what does not. Throws InputError; then
  /// nothing was taken.
  void take(const Store& other);

  Database* reading() const;  ///< nullptr: there is no file yet
  Database& writing();
  /// Says that something in the file does not match its digest, or why it is damaged.
  void say_damaged(const std::string& what,
                   const std::string& why = "it does not match its digest") const;

 private:
  struct State;
  void say_earlier_results() const;
  std::vector<std::string> unsound_keys() const;  ///< of cases that count as none
  std::optional<Record> sound_record(Database&, const std::string& key, std::string& why) const;
  void insert(Database&, const Record&, const CaseFiles&);
  std::filesystem::path root_;
  Notice notice_;
  std::shared_ptr<State> state_;
};

/// Where results go unless the user says otherwise: runs in the results folder.
std::filesystem::path default_results();

}  // namespace taut
