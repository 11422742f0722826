#pragma once

#include <string>
#include <string_view>

#include "core/model/scene.hpp"

namespace taut {

/// SHA-256 (FIPS 180-4) in lower-case hexadecimal, 64 characters.
std::string sha256(std::string_view bytes);

/// SHA-256 of content(scene): equal exactly when the scenes are the same simulation.
std::string digest(const Scene&);

/// SHA-256 of the bits of x and v, -0 and 0 apart: equal exactly when the states are bit-identical.
std::string digest(const State&);

}  // namespace taut
