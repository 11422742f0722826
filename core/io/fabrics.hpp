#pragma once

#include <span>
#include <string>
#include <string_view>

namespace taut {

/// A fabric as somebody measured it.
struct Fabric {
  std::string_view name;
  double mass = 0;   ///< kg/m^2
  double warp = 0;   ///< N m, bending stiffness along the warp
  double weft = 0;   ///< N m, across it
  double drape = 0;  ///< drape coefficient, measured
  std::string_view source, licence;
};

/// In the order of their names.
std::span<const Fabric> fabrics();

/// Null: none has this name; `problem` then says so, with a suggestion.
const Fabric* find_fabric(const std::string& name, std::string& problem);

}  // namespace taut
