#pragma once

#include <string>
#include <vector>

#include "experiments/case/record.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

/// The largest size of a metric's value that is accepted.
struct Limit {
  std::string name;  ///< of the value
  double most = 0;   ///< in the value's unit, >= 0

  /// "1.2 mm", "0.3 %": a value as its unit is shown; "-" for what is not a number.
  std::string text(double value) const;
};

/// "METRIC:LIMIT" for this scene: in SI units, in the unit shown, or in "%" of the cloth's extent
/// and of the duration; of shares, points. Throws InputError.
Limit parse_limit(const std::string&, const Scene&);

/// The largest RMS stretch that is accepted; the largest depth of a vertex, over the cloth's
/// extent; the largest motion error.
inline constexpr double kMostStretch = 0.1, kMostDepth = 1e-3, kMostMotionError = 0.25;

/// The limits unless others are asked for, as far as the scene has the values:
///   - no passage of a vertex and no crossing;
///   - depths of vertices of at most kMostDepth of the cloth's extent;
///   - an RMS stretch of at most kMostStretch;
///   - a motion error of at most kMostMotionError, for cloth that stands still has little strain.
/// Passages of edges and faces are accepted: past an edge of a box they happen to every solver that
/// keeps vertices alone outside (`--keep edge.passages:0` asks for none).
std::vector<Limit> default_limits(const Scene&);

/// What a case does beyond these limits: "penetration.peak 3.1 mm, more than 1 mm"; "": nothing.
std::string beyond(const Record&, const std::vector<Limit>&);

// How `--keep` is read, for limits and for tolerances.

/// The NAME of "NAME" or "NAME:NUMBER". Throws InputError: it is none of these.
std::string name_of_kept(const std::string& asked, const std::vector<std::string>& names);
/// The number after the colon, in SI units. `hundred`: what 100 % is of; NaN: "%" is not a unit.
/// Throws InputError: no number of at least 0, or another unit.
double number_of_kept(const std::string& asked, const Unit&, double hundred);
/// What 100 % of a value with this unit is on a scene; NaN: it depends on the value.
double hundred_percent(const Unit&, const Scene&);
/// Whether the values are numbers of things.
bool is_count(const Unit&);

}  // namespace taut
