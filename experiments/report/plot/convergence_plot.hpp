#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/timing/convergence.hpp"

namespace taut::report {

/// What can be drawn over the iterations of a step: "distance", "gap", "stretch", "residual".
std::vector<std::string> convergence_kinds();

/// The kind over iterations, both logarithmic, a curve a solver; a level where iterations end on a
/// floor of their own, with its distance. Writes `stem`.csv, .gp, .svg into the folder and returns
/// the picture's path. Throws PlotError without gnuplot, InputError if no solver has a value of
/// this kind or the files cannot be written.
std::filesystem::path plot_convergence(const std::vector<Convergence>&, std::string_view kind,
                                       const std::string& title,
                                       const std::filesystem::path& folder,
                                       const std::string& stem);

}  // namespace taut::report
