#pragma once

#include <string>
#include <vector>

#include "experiments/metrics/metric.hpp"
#include "experiments/metrics/reference.hpp"

namespace taut {

/// Compares a run's motion with a converged one at the latter's moments: with the run's step end
/// that is nearest to each moment, and with the reference at that time, so that neither the run's
/// steps nor its solver are interpolated. Sums are over the free vertices, weighted by their
/// masses. Everything is NaN if the run reaches no moment, or if the reference hardly moves
/// (kLeastWay), in which case the run is judged by where it rests.
class ReferencePath {
 public:
  ReferencePath(const Scene&, MotionReference);
  /// Least displacement of the reference beside a cloth that stands still, RMS over vertices and
  /// moments, as a share of the cloth's extent.
  static constexpr double kLeastWay = 0.05;
  /// Largest time shift that phase() looks at, as a share of the horizon.
  static constexpr double kLongestShift = 0.25;

  void observe(const Snapshot&);

  /// The last moment that the run reached [s].
  double horizon() const;
  /// sqrt(sum |x - r|^2 / sum |r - still|^2) over the moments. 0 for the reference itself, 1 for a
  /// cloth that stands still.
  double error() const;
  /// Share of the reference's motion: sum of (cloth's displacement . reference's) over sum of
  /// reference's squared, for displacements from each moment to the next. 1 for the reference
  /// itself, 0 for a cloth that stands still.
  double share() const;
  /// Time shift s [s] that brings x(t) nearest to r(t - s); positive if the cloth is late. Moments
  /// that a shift takes out of the reference do not count. NaN if the run does not reach the
  /// horizon, or if no shift matters because nothing moves.
  double phase() const;
  /// RMS strain of structural and shear links of the reference, over its moments in the last second
  /// of the run.
  double strain() const;
  /// The reference's floor.
  double floor() const { return moves() ? reference_.floor : Summary::kNone; }

  /// Displacements [m] from the start of a cloth that stands still while its pins carry it along
  /// or, without pins, while it falls as the reference does.
  std::vector<Vec3> still(double t, const std::vector<Vec3>& reference) const;

 private:
  struct Moment {
    double t = 0;         ///< s, end of the run's step
    std::vector<Vec3> x;  ///< m, there
  };
  struct Sums {
    double along = 0, way = 0, apart = 0, from_still = 0;  ///< kg m^2
  };
  bool moves() const;
  Sums sums() const;
  double square_of(double shift) const;

  const Scene& scene_;
  std::vector<std::size_t> free_;
  MotionReference reference_;
  std::vector<Moment> moments_;
  std::size_t next_ = 1;  ///< next moment to be reached
  mutable std::optional<Sums> sums_;
};

}  // namespace taut
