#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/case/record.hpp"

namespace taut::report {

/// What a record holds under `name`: "dt" [s], "steps", "vertices", "links", "projections" (per
/// step), any numeric parameter of its solver ("iterations"), any metric value ("stretch.rms"),
/// any scene key that its case sets to a number ("wind.strength"). NaN if it has none.
double value_of(const Record&, std::string_view name);

/// How a quantity is shown: `shown = scale * SI value`, in `unit`.
struct Quantity {
  std::string name;
  std::string title;  ///< "RMS stretch"
  std::string unit;   ///< "%", "mm", "ms", "" ...
  double scale = 1;

  std::string label() const { return unit.empty() ? title : title + " [" + unit + "]"; }
  /// "1.2 %", "0.31 mm": for prose and tables.
  std::string text(double si, int digits = 2) const;
};
/// Titles and units come from the metrics' own declarations; unknown names are shown as they are.
Quantity quantity(std::string_view name);

/// What quantity() has a title for, beside the sweeps of a study.
std::vector<std::string> quantity_names();

/// One axis of a figure in shown units.
struct Axis {
  Quantity quantity;
  double low = 0, high = 1;
  bool log = false;
  std::vector<std::pair<double, std::string>> ticks;  ///< position, label ("" draws a minor tick)
  /// Where `shown` lies between low (0) and high (1).
  double position(double shown) const;
};

/// An axis that holds all `shown` values that are finite (and positive if `log`); it never fails.
/// With `log`, zeros belong on the floor, which lies a third of a decade below the smallest value.
Axis fit_axis(const Quantity&, const std::vector<double>& shown, bool log);

/// An axis whose ticks are the values themselves, for sweeps such as 1, 2, 4, ..., 256.
Axis sweep_axis(const Quantity&, std::vector<double> shown, std::size_t most_labels = 7);

}  // namespace taut::report
