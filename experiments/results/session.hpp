#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "experiments/case/case.hpp"

namespace taut {

/// Part i of n of a list of cases, by key, so that adding cases does not reshuffle the others.
struct Shard {
  int index = 1;  ///< 1 to count
  int count = 1;
  bool has(const std::string& key) const { return of(key, count) == index; }
  /// The part of `count` that a case is in, by the first eight digits of its key.
  static int of(const std::string& key, int count);
  /// "i/n"; empty: what a Slurm array says ($SLURM_ARRAY_TASK_ID, _MIN, _COUNT), else the whole.
  /// Throws InputError.
  static Shard parse(const std::string&);
};

/// What a study plans.
struct StudyCases {
  std::string study;  ///< its name; "": cases of no study
  std::vector<Case> cases;
};
/// What was skipped of the files of their scenes, each remark once.
std::vector<std::string> remarks_of(const std::vector<StudyCases>&);

/// A case that a session was to run.
struct PlannedKey {
  std::string study, key, id;
  int shard = 1, shards = 1;
};

/// Of a study that was merged although cases were missing, those that still are.
struct Missing {
  std::string study;
  std::vector<std::string> ids;  ///< of cases that the store still lacks
  std::size_t cases = 0;         ///< that lacked when it was merged
  std::string sentence() const;
};

}  // namespace taut
