#pragma once

#include <string>
#include <vector>

#include "experiments/case/record.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

/// Largest accepted magnitude of a metric's value.
struct Limit {
  std::string name;  ///< name of the value
  double most = 0;   ///< in the value's unit, >= 0

  /// A value in the unit shown to people: "1.2 mm", "0.3 %"; "-" if it is not finite.
  std::string text(double value) const;
};

/// Parses "METRIC:LIMIT" for this scene. The limit is in SI units, in the unit shown, or in "%".
/// 100 % is the cloth's extent for lengths, the duration for times, and 1 for shares. Throws
/// InputError.
Limit parse_limit(const std::string&, const Scene&);

/// Largest accepted RMS stretch.
inline constexpr double kMostStretch = 0.1;
/// Largest accepted depth of a vertex, as a share of the cloth's extent.
inline constexpr double kMostDepth = 1e-3;

/// Limits that apply unless others are requested, for the values that the scene has:
///   - no passage of a vertex and no crossing;
///   - depths of vertices of at most kMostDepth of the cloth's extent;
///   - an RMS stretch of at most kMostStretch.
/// Passages of edges and faces are accepted: at the edge of a box they happen to every solver that
/// keeps only vertices outside (`--keep edge.passages:0` forbids them).
std::vector<Limit> default_limits(const Scene&);

/// How a case exceeds these limits: "penetration.peak 3.1 mm, more than 1 mm"; "" if it does not.
std::string beyond(const Record&, const std::vector<Limit>&);

// Parsing of `--keep`, for limits and for tolerances.

/// The NAME in "NAME" or "NAME:NUMBER". Throws InputError unless it is one of `names`.
std::string name_of_kept(const std::string& asked, const std::vector<std::string>& names);
/// The number after the colon in SI units. `hundred` is the value of 100 %; if it is NaN, "%" is
/// not allowed. Throws InputError unless the number is at least 0 and the unit is known.
double number_of_kept(const std::string& asked, const Unit&, double hundred);
/// Value of 100 % for this kind of unit on a scene; NaN if it depends on the value.
double hundred_percent(const Unit&, const Scene&);

}  // namespace taut
