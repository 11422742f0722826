#pragma once

#include <vector>

#include "experiments/metrics/metric.hpp"
#include "experiments/metrics/reference.hpp"

namespace taut {

/// Compares a run's motion with states of a converged one. Positions are interpolated linearly
/// between step boundaries; products and squares are summed over the free vertices. Everything is
/// NaN if the run reaches no moment, or if the reference hardly leaves the start (kLeastWay), in
/// which case the run is judged by where it rests.
class ReferencePath {
 public:
  /// `moments` ascending in time.
  ReferencePath(const Scene&, std::vector<Reference> moments);
  /// Least distance of the reference from the start, RMS over vertices and moments, as a share of
  /// the cloth's extent.
  static constexpr double kLeastWay = 0.05;

  void observe(const Snapshot&);

  /// The last moment that the run reached [s].
  double horizon() const;
  /// Share of the reference's motion: sum of (cloth's displacement . reference's) over sum of
  /// reference's squared, for displacements from each moment to the next. 1 for the reference
  /// itself, 0 for a cloth that stands still.
  double share() const;
  /// sqrt(sum |x - r|^2 / sum |r - start|^2) over the moments. 0 for the reference itself, 1 for a
  /// cloth that stands still.
  double error() const;
  /// Time shift s [s] that minimises the sum of |x(t + s) - r(t)|^2; positive if the cloth is late.
  /// |s| is at most the time of the first moment, and a moment only counts if the run outlasts it
  /// by as much. NaN if no moment counts, or if no shift matters because nothing moves.
  double phase() const;

 private:
  struct Moment {
    Reference reference;
    bool timed = false;  ///< counts for the phase
    std::vector<double> square,
        beside;  ///< m^2, of boundary n: |x_n - r|^2, (x_(n-1) - r).(x_n - r)
  };
  bool moves() const;
  void reach(const Moment&, const std::vector<Vec3>& x);
  void measure(Moment&, const std::vector<Vec3>& x) const;
  double square_of(double shift) const;

  std::vector<std::size_t> free_;
  double dt_, extent_, longest_shift_ = 0;
  std::vector<Moment> moments_;
  std::size_t next_ = 0;                                     ///< next moment to be reached
  std::vector<Vec3> start_, last_;                           ///< x at the start, and one step ago
  std::vector<Vec3> left_, reference_left_;                  ///< at the last moment
  double along_ = 0, way_ = 0, apart_ = 0, from_start_ = 0;  ///< m^2
};

}  // namespace taut
