#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/model/scene.hpp"
#include "core/model/solver.hpp"
#include "core/reference/strain_at_rest.hpp"

namespace taut {

/// What a setting is looked for. At most one; nothing: the setting as it is.
struct PredictionWanted {
  std::optional<double> error;      ///< RMS strain at most
  std::optional<double> stiffness;  ///< N/m: the RMS strain of links of this stiffness
  std::optional<double> budget;     ///< CPU s a step at most
  bool as_stiffness = false;        ///< also find the stiffness that each setting is
};

/// A setting and what is predicted of it, or why nothing is.
struct PredictedStrain {
  SolverChoice choice;
  std::string found;  ///< the parameter that was looked for; "": none
  reference::StrainAtRest::Strain strain;
  double correction = std::numeric_limits<double>::quiet_NaN();  ///< c of the law
  double cpu = std::numeric_limits<double>::quiet_NaN();        ///< s of a step, timed on its first
  double stiffness = std::numeric_limits<double>::quiet_NaN();  ///< N/m; NaN: not asked for
  std::vector<std::string> refused;  ///< reasons, a sentence each; empty: predicted
};

/// Predicts the strain at rest without running the scene (core/reference/strain_at_rest.hpp). For
/// something wanted there are two settings, one with other sweeps and one with other substeps: the
/// fewest that reach the error, those nearest to the stiffness, the most that the budget allows.
std::vector<PredictedStrain> predict(const Scene&, const SolverChoice&,
                                     const PredictionWanted& = {});

}  // namespace taut
