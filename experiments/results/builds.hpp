#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace taut {

class Store;

/// A state of a program's sources that ran a study: a commit of taut, or what an external program
/// says or is given (`--build-id`).
struct Build {
  std::string id;    ///< "3f2a9c1d0e"
  std::string made;  ///< "2026-05-04T10:11:12Z" or a beginning of it: builds are in this order
  std::int64_t place = 0;    ///< among builds of the same time
  std::string subject = {};  ///< one line of its author
  /// What `taut history --git` asked of it, by digest; "": it did not ask.
  std::string asked = {};
  std::string gap = {};  ///< why it ran nothing; "": it did
};

/// The build that a text names, "ID" or "ID@TIME"; without a time: now. Throws InputError unless
/// the ID has 1 to 150 characters of which none is a blank, a quote, a comma or '@', and the time
/// is a date with or without a time of day (UTC).
Build build_named(const std::string& text);

/// The build that $TAUT_BUILD_ID (`taut run --build-id`) names for the programs that run studies;
/// without an id if it names none. Throws InputError.
Build given_build();

/// Notes a build of a study; replaces what was known of it.
void note_build(Store&, const std::string& study, const Build&);
/// Notes that a build has a case of a study, under this id and key, and the build if it is new.
/// Throws InputError.
void note_ran(Store&, const std::string& study, const Build&, const std::string& id,
              const std::string& key);
/// Those of a study, in their order.
std::vector<Build> builds_of(const Store&, const std::string& study);

/// Whether a build ran cases of a study, and each of them is stored.
bool has_all_results(const Store&, const std::string& study, const std::string& build);
/// Names and addresses of the cases of a study that a build ran.
std::vector<std::pair<std::string, std::string>> ran_by(const Store&, const std::string& study,
                                                        const std::string& build);

/// How a step of one build compares with that of another in cost; timed in turns.
struct BuildRatio {
  std::string id;                                         ///< of the case
  std::string before, now;                                ///< builds
  std::string host, clock;                                ///< "cpu" or "wall"
  double low = 0, ratio = 0, high = 0;                    ///< now over before, 95 %
  double control_low = 0, control = 0, control_high = 0;  ///< `before` over itself
};
/// Replaces what was known of these two builds and this case.
void note_ratio(Store&, const std::string& study, const BuildRatio&);
std::vector<BuildRatio> ratios_of(const Store&, const std::string& study);

}  // namespace taut
