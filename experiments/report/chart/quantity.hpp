#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiments/case/record.hpp"

namespace taut::report {

/// What a record holds under `name`: "dt" [s], "steps", "vertices", "links", "projections" (per
/// step), any numeric parameter of its solver ("iterations"), any metric value ("stretch.rms"),
/// any scene key that its case sets to a number ("wind.strength"). NaN if it has none.
double value_of(const Record&, std::string_view name);

/// Of a case that plays positions from a file: the RMS strain that their rounding makes.
inline constexpr std::string_view kStrainFloor = "strain.floor";

/// How a quantity is shown: `shown = scale * SI value`, in `unit`.
struct Quantity {
  std::string name;
  std::string title;  ///< "RMS stretch"
  std::string unit;   ///< "%", "mm", "ms", "" ...
  double scale = 1;
  bool logarithmic = true;  ///< the axis that suits it
  std::string help = {};    ///< its definition; "" of settings
  bool less_is_better = false;
  std::string window = {};  ///< "last second", "whole run", "end of the run"; "" of settings

  std::string label() const { return unit.empty() ? title : title + " [" + unit + "]"; }
  /// "1.2 %", "0.31 mm": for prose and tables.
  std::string text(double si, int digits = 2) const;
};
/// As the metric's own file declares it; unknown names are shown as they are.
Quantity quantity(std::string_view name);

/// What quantity() has a title for, beside the axes of a study.
std::vector<std::string> quantity_names();

}  // namespace taut::report
