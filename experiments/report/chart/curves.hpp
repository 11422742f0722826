#pragma once

#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "experiments/case/record.hpp"

namespace taut::report {

/// Records that live elsewhere, in the order of the study.
struct Chosen : std::vector<const Record*> {
  Chosen() = default;
  Chosen(std::span<const Record> all) {
    for (const Record& r : all) push_back(&r);
  }
  Chosen(const std::vector<Record>& all) : Chosen(std::span(all)) {}
};

/// One case on a curve, in SI units.
struct Point {
  double x = 0, y = 0;
  double along = 0;  ///< the swept setting that orders the curve
  const Record* record = nullptr;
  std::string name = {};  ///< under "setting": the accuracy knobs, "16 × 2" for substeps x sweeps

  /// It has a value that may be compared; everything else is drawn as a glyph.
  bool measured() const;
};

/// One solver with one choice of its settings, ordered along the swept setting.
struct Curve {
  std::string label;   ///< "Jakobsen sqrt-free"
  std::string solver;  ///< the entry's name
  int variant = 0;     ///< counts the curves of one solver in a figure
  std::vector<Point> points;
};

/// Labels of records by those accuracy parameters that take several values among their solver's.
class SettingLabels {
 public:
  explicit SettingLabels(const Chosen&);
  /// "2 × 8, coloured"; "" if nothing varies.
  std::string of(const Record&) const;

 private:
  std::map<std::pair<std::string, std::string>, std::set<std::string>> seen_;  ///< solver, name
};

/// Groups records into curves of y over x: those that differ in nothing but `along` ("iterations",
/// "dt", ...) share a curve. Labels name only the settings that vary among the records. `along` =
/// "setting" frees every accuracy knob at once (sweeps, substeps, stiffness, Newton steps,
/// over-relaxation, levels, precision): one curve per solver, ordered by x. `also`: a second
/// setting in which cases of one curve may differ.
std::vector<Curve> make_curves(const Chosen&, const std::string& x, const std::string& y,
                               const std::string& along, const std::string& also = "");

/// The records at the value of `setting` which most of them share (ties: nearest to `preferred`),
/// with that value in SI units. All records and NaN if two or three values were tried, which are
/// that many sets of curves, or if none has the setting.
struct Slice {
  Chosen records;
  double value = 0;
};
Slice hold(const Chosen&, const std::string& setting, double preferred);

/// Fitted exponent p of y ~ x^p over the measured, positive points with x >= from; NaN with fewer
/// than three.
double fitted_slope(const Curve&, double from);

}  // namespace taut::report
