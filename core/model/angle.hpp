#pragma once

#include <numbers>

namespace taut {

/// Radians in a degree: scenes and truths give angles in degrees, everything else is in radians.
constexpr double kDegree = std::numbers::pi / 180;

}  // namespace taut
