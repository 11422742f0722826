#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/results/builds.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/timing/timing.hpp"

namespace taut {

/// A case to be timed under two builds.
struct CaseOfTwo {
  std::string id;
  CaseToTime before, now;
};

/// Cost of one build relative to another. The builds were timed in turns in one session, with the
/// earlier build also timed against itself.
struct TwoBuilds {
  std::string id;
  std::string failure;  ///< why there are no times; "" if there are
  Interval cpu, cpu_control, wall, wall_control;

  /// Whether CPU time, or otherwise wall time (for programs that wait), differs beyond interval and
  /// control.
  bool differs() const;
  bool by_wall() const;
  bool slower() const;  ///< it differs and is more expensive than before
};

/// Times the builds case by case. A difference is measured again and counts only if it shows twice,
/// since with many cases some differ by chance.
std::vector<TwoBuilds> time_two_builds(const std::vector<CaseOfTwo>&, const TimingOptions&);

/// Copies this program, or `taut`, and the one with Bullet in single precision beside it to
/// <results>/builds/<id>, and returns that folder. Throws InputError if the id is not a valid name
/// for a build or the disk refuses.
std::filesystem::path keep_build(const std::filesystem::path& results, const std::string& id,
                                 const std::filesystem::path& taut = {});

/// Folder with the programs of another build, given as a folder or as the id of a kept build.
/// Throws InputError that lists the kept builds.
std::filesystem::path folder_of_build(const std::filesystem::path& results,
                                      const std::string& folder_or_id);

/// The cases that ran under both builds: the programs in the folder, and this one's.
std::vector<CaseOfTwo> cases_of_two(const std::vector<Record>&,
                                    const std::filesystem::path& folder_of_before);

/// Cost ratios of each case, in the form in which they are stored with the builds.
std::vector<BuildRatio> ratios_of(const std::vector<TwoBuilds>&, const std::string& before,
                                  const std::string& now);

/// Times the cases of a study against another build (folder_of_build()) and stores the ratio of
/// each case. Throws InputError.
std::vector<TwoBuilds> compare_with_build(const std::string& study, const std::vector<Record>&,
                                          const std::string& before, Store&, const TimingOptions&);

/// A table `name` with ratio, control and verdict of each case.
Table table_of(const std::vector<TwoBuilds>&, const std::string& name, const std::string& before);
bool any_slower(const std::vector<TwoBuilds>&);

}  // namespace taut
