#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/extremes/extremes.hpp"

namespace taut::report {

/// A bar for each knob and solver, as long as the knob may be made harder than where it starts,
/// with what goes wrong at its end; a mark where theory has the end. Writes `stem`.csv, .gp and
/// .svg into the folder and gives the picture's path. Throws PlotError without gnuplot and
/// InputError if the files cannot be written.
std::filesystem::path plot_frontiers(const std::vector<KnobFrontier>&,
                                     const std::filesystem::path& folder, const std::string& stem);

}  // namespace taut::report
