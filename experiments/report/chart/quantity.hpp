#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiments/case/record.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut::report {

/// The names of sweeps per substep and of substeps per step, whatever a solver's own parameters for
/// them are called.
inline constexpr const char *kSweeps = "iterations", *kSubsteps = "substeps";

/// What a record holds under `name`: "dt" [s], "steps", "vertices", "links", "projections" (per
/// step), kSweeps, kSubsteps, any numeric parameter of its solver ("omega"), any metric value
/// ("stretch.rms"), kStrainFloor, any scene key that its case sets to a number ("wind.strength").
/// NaN if it has none.
double value_of(const Record&, std::string_view name);

/// "1.2 %", "0.31 mm": for prose and tables.
std::string shown(const Unit&, double si, int digits = 2);

/// What people are told of a quantity.
struct Quantity {
  std::string name;
  std::string title;  ///< "RMS stretch"
  Unit unit = kNumber;
  std::string help = {};         ///< its definition; "" of settings
  Window window = Window::none;  ///< Window::none of settings

  /// "RMS stretch [%]"
  std::string label() const;
  std::string text(double si, int digits = 2) const { return shown(unit, si, digits); }
};
/// As the metric's own file declares it; unknown names are shown as they are.
Quantity quantity(std::string_view name);

/// What quantity() has a title for, beside the axes of a study.
std::vector<std::string> quantity_names();

}  // namespace taut::report
