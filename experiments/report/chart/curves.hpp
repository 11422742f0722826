#pragma once

#include <span>
#include <string>
#include <vector>

#include "experiments/report/chart/wording.hpp"

namespace taut::report {

/// One case on a curve, in SI units.
struct Point {
  double x = 0, y = 0;
  double along = 0;  ///< the setting that orders the curve
  const Record* record = nullptr;
  std::string name =
      {};  ///< under "setting": the accuracy parameters, "16 × 2" for substeps x sweeps

  /// It has a value that may be compared; everything else is drawn as a glyph.
  bool measured() const;
};

/// One solver with one choice of its settings, ordered along one more setting.
struct Curve {
  std::string label;   ///< "Jakobsen sqrt-free"
  std::string solver;  ///< the entry's name
  int variant = 0;     ///< counts the curves of one solver in a figure
  std::vector<Point> points;
};

/// Groups records into curves of y over x: those that differ in nothing but `along` (kSweeps, "dt",
/// ...) and `also` share a curve. Labels name only the settings that vary among the records.
/// `along` = "setting" frees every accuracy parameter at once: one curve per solver, ordered by x.
std::vector<Curve> make_curves(const Records&, const std::string& x, const std::string& y,
                               const std::string& along, const std::string& also = "");

/// The records at the value of `setting` which most of them share (ties: nearest to `preferred`),
/// with that value in SI units. All records and NaN if two or three values were tried, which are
/// that many sets of curves, or if none has the setting.
struct Slice {
  Records records;
  double value = 0;
};
Slice hold(const Records&, const std::string& setting, double preferred);

/// Fitted exponent p of y ~ x^p over the measured, positive points with x >= from; NaN with fewer
/// than three.
double fitted_slope(const Curve&, double from);

}  // namespace taut::report
