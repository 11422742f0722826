#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "experiments/case/case.hpp"

namespace taut {

/// Part i of n of a list of cases, chosen by key, so that added cases do not reshuffle the others.
struct Shard {
  int index = 1;  ///< 1 to count
  int count = 1;
  bool has(const std::string& key) const { return of(key, count) == index; }
  /// Index of the shard that contains a case, from the first eight digits of its key.
  static int of(const std::string& key, int count);
  /// Parses "i/n". An empty text stands for the shard of a Slurm array ($SLURM_ARRAY_TASK_ID, _MIN,
  /// _COUNT), or outside one for the whole. Throws InputError.
  static Shard parse(const std::string&);
};

/// The cases that a study plans.
struct StudyCases {
  std::string study;  ///< its name; "" for cases outside a study
  std::vector<Case> cases;
};
/// Remarks on what was skipped in the files of their scenes, each once.
std::vector<std::string> remarks_of(const std::vector<StudyCases>&);

/// A case that a session planned to run.
struct PlannedKey {
  std::string study, key, id;
  int shard = 1, shards = 1;
};

/// Cases missing from a study that was merged without them.
struct Missing {
  std::string study;
  std::vector<std::string> ids;  ///< ids of the cases that the store still lacks
  std::size_t cases = 0;         ///< number of cases that were missing when it was merged
  std::string sentence() const;
};

}  // namespace taut
