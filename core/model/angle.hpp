#pragma once

#include <numbers>

namespace taut {

/// Radians per degree: scenes and truths give angles in degrees, everything else uses radians.
constexpr double kDegree = std::numbers::pi / 180;

}  // namespace taut
