#pragma once

#include <string>

#include "core/model/scene.hpp"

namespace taut::external {

/// The scene as a program gets it: JSON, everything resolved, SI units, doubles in shortest exact
/// form. Every key stands in experiments/external/README.md.
std::string scene_file(const Scene&);

}  // namespace taut::external
