#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace taut {

class Store;

/// A state of a program's sources that ran a study: a commit of taut, or the version that an
/// external program reports or that the user gives (`--build-id`).
struct Build {
  std::string id;    ///< "3f2a9c1d0e"
  std::string made;  ///< "2026-05-04T10:11:12Z" or the first part of it; builds are ordered by it
  std::int64_t place = 0;    ///< order among builds of the same time
  std::string subject = {};  ///< subject line of the commit
  /// Digest of the request of `taut history --git`; "" if there was none.
  std::string asked = {};
  std::string gap = {};  ///< why it ran nothing; "" if it ran
};

/// Parses "ID" or "ID@TIME"; the time defaults to now. Throws InputError unless the ID has 1 to 150
/// characters without blanks, quotes, commas or '@', and the time is a date with or without a time
/// of day (UTC).
Build build_named(const std::string& text);

/// The build in $TAUT_BUILD_ID (`taut run --build-id`), which applies to programs that run studies;
/// without an id if the variable is not set. Throws InputError.
Build given_build();

/// Stores a build of a study and replaces what was known about it.
void note_build(Store&, const std::string& study, const Build&);
/// Records that a build has a case of a study, under this id and key. Adds the build if it is new.
/// Throws InputError.
void note_ran(Store&, const std::string& study, const Build&, const std::string& id,
              const std::string& key);
/// The builds of a study, in order.
std::vector<Build> builds_of(const Store&, const std::string& study);

/// Whether a build ran cases of a study and all of them are stored.
bool has_all_results(const Store&, const std::string& study, const std::string& build);
/// Ids and keys of the cases of a study that a build ran.
std::vector<std::pair<std::string, std::string>> ran_by(const Store&, const std::string& study,
                                                        const std::string& build);

/// Cost of a step of one build relative to another build's, timed in turns.
struct BuildRatio {
  std::string id;                                         ///< id of the case
  std::string before, now;                                ///< builds
  std::string host, clock;                                ///< "cpu" or "wall"
  double low = 0, ratio = 0, high = 0;                    ///< now over before, with 95 % interval
  double control_low = 0, control = 0, control_high = 0;  ///< `before` over itself
};
/// Stores a ratio and replaces an earlier one of the same builds and case.
void note_ratio(Store&, const std::string& study, const BuildRatio&);
std::vector<BuildRatio> ratios_of(const Store&, const std::string& study);

}  // namespace taut
