#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/case/case.hpp"
#include "experiments/results/store.hpp"

namespace taut {

/// A stored case under a title.
struct TitledCase {
  CaseSpec spec;
  std::string title;
};

/// Draws the cloths of the cases at their ends side by side, each under its own camera.
/// Precondition: their motions are stored. Throws InputError without a renderer.
void draw_side_by_side(const std::vector<TitledCase>&, const Store&,
                       const std::filesystem::path& file);

}  // namespace taut
