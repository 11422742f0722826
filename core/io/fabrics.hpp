#pragma once

#include <span>
#include <string>
#include <string_view>

namespace taut {

/// A fabric with measured properties.
struct Fabric {
  std::string_view name;
  double mass = 0;   ///< kg/m^2
  double warp = 0;   ///< N m, bending stiffness along the warp
  double weft = 0;   ///< N m, bending stiffness across the warp
  double drape = 0;  ///< measured drape coefficient
  std::string_view source, licence;
};

/// All fabrics, sorted by name.
std::span<const Fabric> fabrics();

/// The fabric of this name. Null if there is no such fabric; `problem` then says so, with a
/// suggestion.
const Fabric* find_fabric(const std::string& name, std::string& problem);

}  // namespace taut
