#pragma once

#include <cstdint>
#include <string>

namespace taut {

/// Text of a scene file drawn at random.
struct DrawnScene {
  std::string toml;
  std::string obj;  ///< of the mesh that it names, NAME.obj; "": the cloth is a grid
};

/// The scene of this seed, the same text on every machine: a sheet, a strip, a net of structural
/// links that sags between its pins, or irregular triangles. Masses, pins, links and steps vary.
/// Damping brings it to rest. `contact` lays the cloth level above a ball, a box or a capsule, held
/// by its pins or by nothing, in which case there is a floor. `name` is that of the file, without
/// ".toml".
DrawnScene drawn_scene(const std::string& name, std::uint64_t seed, bool contact = false);

}  // namespace taut
