#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "experiments/case/case.hpp"
#include "experiments/case/trajectory.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

/// Distance to a missing answer.
inline constexpr double kNoAnswer = std::numeric_limits<double>::infinity();

/// The name of the answer that is no metric: where the cloth is at the end, as the largest distance
/// [m] of a vertex from where it is in the full model.
inline constexpr const char* kShapeAnswer = "shape";

/// A quantity that a smaller model has to reproduce, with its tolerance.
struct KeptQuantity {
  std::string name;      ///< "shape" or a metric value
  double tolerance = 0;  ///< in the unit of the value, >= 0

  bool is_shape() const { return name == kShapeAnswer; }
};
Unit unit_of(const KeptQuantity&);
/// "1.2 mm", "0.3 %": as the unit is shown; "-" for what is not a number.
std::string text(const KeptQuantity&, double value);

/// A case that was run, with its motion.
struct Observation {
  Case one;
  Record record;
  std::vector<Frame> frames;  ///< as the store keeps them
};

/// "METRIC" or "METRIC:TOLERANCE". A tolerance is a number in SI units, or with the unit in which
/// the value is shown ("2mm"), or in "%": of the cloth's extent for lengths, of the duration for
/// times, of the full model's value for other quantities; of strains and shares, points. Without
/// one: the shape 1 % of the extent, other lengths 0.1 %, strains and shares 1 point, times 10 % of
/// the duration, counts none, all else 10 % of the value. Throws InputError: unknown name, or no
/// number of at least 0.
KeptQuantity parse_answer(const std::string&, const Observation& full);
/// The METRIC alone. Throws InputError: unknown name.
std::string name_of_answer(const std::string& asked);

/// What is kept unless something is asked for: shape, largest stretch, depth of vertices (and of
/// faces, if the solver keeps them out), crossings, settling time; as far as the case has them.
std::vector<std::string> default_answers(const Observation& full);

/// The value of an answer that is a metric; NaN if the case has none.
double value_of(const KeptQuantity&, const Observation&);

/// How far the answer is from that of the full model [unit of the answer]; infinite if the other
/// case did not run to its end or has no such value. Shapes of different grids are compared at the
/// vertices of the coarser one; the finer one is interpolated bilinearly. If the reduced scene no
/// longer produces the value, it is measured on the reduced motion, and the full model's value the
/// same way.
double distance(const KeptQuantity&, const Observation& full, const Observation& other);

/// The first time [s] at which two runs of one scene differ by more than `tolerance` [m]; nothing:
/// they never do.
std::optional<double> apart_after(const Observation&, const Observation&, double tolerance);

}  // namespace taut
