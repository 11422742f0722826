#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "experiments/study/session.hpp"
#include "experiments/study/store.hpp"

namespace taut::cluster {

/// What a merge of some folders would find.
struct MergePlan {
  std::vector<ManifestEntry> cases;    ///< planned
  std::string name;                    ///< of the study, or of the list of cases
  std::vector<ManifestEntry> missing;  ///< planned, in no folder
  std::vector<std::string> foreign;    ///< sentences: planned or stored by one folder alone
  std::vector<std::string> conflicts;  ///< sentences: results that differ, and where they are

  bool mergeable() const { return foreign.empty() && conflicts.empty(); }
};

/// Folders of `taut cluster submit`, or results folders of `taut run --shard`, that belong
/// together.
class Merge {
 public:
  /// Throws InputError: a folder without results, a manifest that is damaged.
  explicit Merge(const std::vector<std::filesystem::path>& folders);
  /// Compares them with each other and with what is in `into`. Changes nothing.
  MergePlan look(const Store& into) const;
  /// Copies the planned records, and who computed them, into a pack file for each store that they
  /// come from; `progress` counts cases. Throws InputError if the disk refuses: the same merge
  /// again goes on.
  void copy(const MergePlan&, Store& into,
            const std::function<void(std::size_t done, std::size_t all)>& progress) const;

 private:
  struct Source {
    std::filesystem::path folder;
    std::vector<ManifestEntry> cases;
    std::vector<Store> stores;
  };
  /// What a planned and b did not.
  static void note_planned_alone(const Source& a, const Source& b,
                                 std::vector<std::string>& foreign);
  std::vector<Source> sources_;
  std::string name_;
};

}  // namespace taut::cluster
