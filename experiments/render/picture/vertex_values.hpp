#pragma once

#include <vector>

#include "core/model/scene.hpp"
#include "experiments/render/image/colour.hpp"

namespace taut {

/// The quantity at each vertex [n], SI. Strain is the mean of the structural and shear links at the
/// vertex (bend links shorten when cloth folds, which is no strain); speed needs State::v.
std::vector<double> vertex_values(const Scene&, ColourBy, const State&, double t);

/// What a caption says about one moment. Strains are those of the metric `stretch`: structural and
/// shear links, links between two pins left out.
struct LiveFigures {
  double max_strain = 0;   ///< largest |strain|
  double mean_strain = 0;  ///< signed
  double rms_strain = 0;
  double max_depth = 0;  ///< m, deepest vertex below a collider
  double max_speed = 0;  ///< m/s
};
LiveFigures live_figures(const Scene&, const State&, double t);

}  // namespace taut
