#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "experiments/case/case.hpp"
#include "experiments/case/trajectory.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

/// Distance of an answer that is missing.
inline constexpr double kNoAnswer = std::numeric_limits<double>::infinity();

/// Name of the only answer that is not a metric: the shape at the end, measured as the largest
/// distance [m] of a vertex from its place in the full model.
inline constexpr const char* kShapeAnswer = "shape";

/// A quantity that a smaller model has to reproduce within a tolerance.
struct KeptQuantity {
  std::string name;      ///< "shape" or a metric value
  double tolerance = 0;  ///< in the unit of the value, >= 0

  bool is_shape() const { return name == kShapeAnswer; }
};
Unit unit_of(const KeptQuantity&);
/// A value in the unit shown to people: "1.2 mm", "0.3 %"; "-" if it is not finite.
std::string text(const KeptQuantity&, double value);

/// A case that was run, and its motion.
struct Observation {
  Case one;
  Record record;
  std::vector<Frame> frames;  ///< as the store has them
};

/// Parses "METRIC" or "METRIC:TOLERANCE". A tolerance is a number in SI units, in the unit shown
/// ("2mm"), or in "%": of the cloth's extent for lengths, of the duration for times, of the full
/// model's value for other quantities; percentage points for strains and shares. Default
/// tolerances: 1 % of the extent for the shape, 0.1 % for other lengths, 1 point for strains and
/// shares, 10 % of the duration for times, none for counts, and 10 % of the value for everything
/// else. Throws InputError if the name is unknown or the number is less than 0.
KeptQuantity parse_answer(const std::string&, const Observation& full);
/// The METRIC alone. Throws InputError if the name is unknown.
std::string name_of_answer(const std::string& asked);

/// Answers to keep unless some are requested: shape, largest stretch, depth of vertices (and of
/// faces, if the solver keeps them out), crossings and settling time, as far as the case has them.
std::vector<std::string> default_answers(const Observation& full);

/// Value of an answer that is a metric; NaN if the case has none.
double value_of(const KeptQuantity&, const Observation&);

/// Distance of an answer from that of the full model [unit of the answer]; infinite if the other
/// case did not run to its end or has no such value. Shapes on different grids are compared at the
/// vertices of the coarser grid; the finer one is interpolated bilinearly. If the reduced scene no
/// longer produces the value, it is measured on the motions of both.
double distance(const KeptQuantity&, const Observation& full, const Observation& other);

/// First time [s] at which two runs of one scene differ by more than `tolerance` [m]; nothing if
/// they never do.
std::optional<double> apart_after(const Observation&, const Observation&, double tolerance);

}  // namespace taut
