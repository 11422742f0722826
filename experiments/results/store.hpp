#pragma once

#include <filesystem>
#include <functional>
#include <map>
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

/// CPU time that a case took.
struct Spent {
  double cpu = 0;      ///< s, of its process: start, solver, metrics, result
  double metrics = 0;  ///< s, of that
};

/// Files that a case leaves beside its record, as texts; "" if there is no such file.
struct CaseFiles {
  std::string series;  ///< kSeriesFile: values over time, in the form of to_json(Series)
  std::string motion;  ///< kFramesFile
  std::string errors;  ///< the end of kErrorsFile
  std::optional<Spent> spent = {};  ///< by the process that ran the case
};
inline constexpr const char* kRecordFile = "case.json";
inline constexpr const char* kErrorsFile = "stderr.txt";
inline constexpr const char* kSeriesFile = "series.json";
/// Frames (experiments/case/trajectory.hpp) of about kFrames + 1 moments, including the first and
/// the last.
inline constexpr const char* kFramesFile = "frames";
inline constexpr int kFrames = 32;

/// The contents of a results folder, in one SQLite file <root>/results.db, whose tables and views
/// are in experiments/results/schema.cpp. Several processes may write; each waits for the others.
/// What was committed survives a loss of power, and a killed process leaves nothing half done.
class Store {
 public:
  /// Receives reports such as "damaged, set aside as ..."; by default they go to stderr.
  using Notice = std::function<void(const std::string&)>;
  /// Creates nothing until something is written.
  explicit Store(std::filesystem::path root, Notice notice = {});

  static bool is_at(const std::filesystem::path& root) {
    return std::filesystem::exists(root / "results.db");
  }
  const std::filesystem::path& root() const { return root_; }
  std::filesystem::path file() const { return root_ / "results.db"; }

  /// The stored record, or nothing if there is no record. A record that does not match its digest
  /// is reported and treated as missing. Throws InputError if the file is damaged or unreadable.
  std::optional<Record> find(const std::string& key) const;
  /// The stored record under the names that this case has now.
  std::optional<Record> find(const Case&) const;
  /// Values over time of a stored case; empty if there are no values.
  Series series(const std::string& key) const;
  /// Whether the motion of a stored case is kept.
  bool has_frames(const std::string& key) const;
  /// The motion of a stored case. Throws InputError if it is not kept or does not match its digest.
  Trajectory motion(const std::string& key) const;

  /// Makes sure that results can be written. Sets a damaged file aside and begins a new one, with a
  /// notice. Leaves results of an earlier taut alone, with a notice. Throws InputError with the
  /// reason, for example if another host writes here through a network file system.
  void prepare();
  /// Creates an empty folder below $TMPDIR for the files of a case. Throws InputError.
  std::filesystem::path stage(const std::string& key);

  enum class Commit {
    stored,    ///< new, or replaced a failure or the same result without frames
    same,      ///< the same result was already there
    conflict,  ///< another result was there: a determinism alarm; this one is among the conflicts
  };
  /// Stores a record with all its files, or nothing. Never replaces a result, but replaces a
  /// failure. Throws InputError if the disk refuses.
  Commit commit(const Record&, const CaseFiles& = {});
  /// Stores a record with the files in a staged folder, and removes the folder.
  Commit commit(const std::filesystem::path& staged, const Record&, const Spent&);
  /// Makes many commits as one: all of them, or none if `work` throws.
  void together(const std::function<void()>& work);

  /// Summary of a stored case.
  struct Entry {
    std::string key, id;
    std::string result;  ///< result_digest of the record
    bool is_result = false;
  };
  /// All stored cases, sorted by key. Records that do not match their digest are reported and left
  /// out.
  std::vector<Entry> entries() const;
  std::vector<std::string> keys() const;  ///< in the order in which they were stored
  /// SHA-256 over the keys and results of all cases that have a result. Two stores with the same
  /// results have the same digest.
  std::string digest() const;
  /// Keys that were committed with conflicting results, once for each conflict.
  std::vector<std::string> conflicts() const;

  /// Records a session: its command, host and time, and every case that is planned, of all shards.
  /// This replaces earlier plans of the same studies. Throws InputError, and then records nothing.
  void begin_session(const std::string& command, const std::vector<StudyCases>& = {},
                     const Shard& = {});
  /// The cases that sessions planned to run, each key once, sorted by key. Throws InputError if a
  /// stored number of a shard is out of range.
  std::vector<PlannedKey> planned() const;
  /// Marks cases that a merge did without. Reports mention them until they are stored. Throws
  /// InputError.
  void mark_missing(const std::vector<PlannedKey>&);
  std::vector<Missing> still_missing() const;  ///< sorted by study

  std::map<std::string, Spent> spent() const;  ///< what the last run of each case took, by key

  /// Stores a verb's answer in place of an earlier one of the same kind and subject. Throws
  /// InputError.
  void keep(const Answer&);
  /// Answers of this kind that `program` (program_digest) found, sorted by subject. Throws
  /// InputError if damaged.
  std::vector<Answer> answers(const std::string& kind, std::string_view program) const;

  /// Copies the cases and sessions of another store. Results replace failures, nothing is stored
  /// twice, and only cases that match their digest are copied; they replace stored ones that do
  /// not. Throws InputError, and then copies nothing.
  void take(const Store& other);

  Database* reading() const;  ///< nullptr if there is no file yet
  Database& writing();
  /// Reports that something in the file is damaged and why.
  void say_damaged(const std::string& what,
                   const std::string& why = "it does not match its digest") const;

 private:
  struct State;
  void say_earlier_results() const;
  std::vector<std::string> unsound_keys() const;  ///< keys of cases that count as missing
  std::optional<Record> sound_record(Database&, const std::string& key, std::string& why) const;
  void insert(Database&, const Record&, const CaseFiles&);
  std::filesystem::path root_;
  Notice notice_;
  std::shared_ptr<State> state_;
};

/// Default folder of results: runs in the results folder.
std::filesystem::path default_results();

}  // namespace taut
