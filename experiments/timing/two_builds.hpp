#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/results/builds.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/timing/timing.hpp"

namespace taut {

/// A case under two builds.
struct CaseOfTwo {
  std::string id;
  CaseToTime before, now;
};

/// What one build costs over another: timed in turns in one session, beside the build of before
/// against itself.
struct TwoBuilds {
  std::string id;
  std::string failure;  ///< why there are no times; "": there are
  Interval cpu, cpu_control, wall, wall_control;

  /// It costs another CPU time, or if not that another wall time (of a program that waits), beyond
  /// interval and control.
  bool differs() const;
  bool by_wall() const;
  bool slower() const;  ///< it differs, and is dearer than it was
};

/// Case by case. What looks like a difference is timed again, and is one only if it is seen twice:
/// of many cases some look different by chance.
std::vector<TwoBuilds> time_two_builds(const std::vector<CaseOfTwo>&, const TimingOptions&);

/// Keeps this program, or `taut`, with that of Bullet in single precision beside it, in
/// <results>/builds/<id>, and gives that folder. Throws InputError: no such name for a build, or
/// the disk refuses.
std::filesystem::path keep_build(const std::filesystem::path& results, const std::string& id,
                                 const std::filesystem::path& taut = {});

/// Where the programs of another build lie: a folder, or the id of a kept one. Throws InputError
/// that names what there is.
std::filesystem::path folder_of_build(const std::filesystem::path& results,
                                      const std::string& folder_or_id);

/// Those of the cases that ran under both: the programs in the folder beside this one's.
std::vector<CaseOfTwo> cases_of_two(const std::vector<Record>&,
                                    const std::filesystem::path& folder_of_before);

/// The costs of each case, to be kept with the builds.
std::vector<BuildRatio> ratios_of(const std::vector<TwoBuilds>&, const std::string& before,
                                  const std::string& now);

/// What cases of a study cost over another build (folder_of_build()); the store keeps the ratios of
/// each case. Throws InputError.
std::vector<TwoBuilds> compare_with_build(const std::string& study, const std::vector<Record>&,
                                          const std::string& before, Store&, const TimingOptions&);

/// A table `name` for people and data: ratio, control, verdict of each case.
Table table_of(const std::vector<TwoBuilds>&, const std::string& name, const std::string& before);
bool any_slower(const std::vector<TwoBuilds>&);

}  // namespace taut
