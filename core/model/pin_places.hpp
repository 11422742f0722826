#pragma once

#include <vector>

#include "core/model/scene.hpp"

namespace taut {

/// Where a scene has its pins at every step boundary. Costs nothing without pins.
class PinPlaces {
 public:
  explicit PinPlaces(const Scene&);

  /// A pin that is not at its place.
  struct Stray {
    int vertex = -1;            ///< negative: every pin is at its place
    double distance = 0;        ///< m
    Vec3 place = Vec3::Zero();  ///< m
  };
  /// The pin that is farthest from its place after `step` steps, and farther than `within` [m] and
  /// the share `rounding` of the coordinates from which its place is computed. Pins that are let go
  /// at that boundary still count; a position that is not finite does not.
  Stray farthest(int step, const std::vector<Vec3>& x, double within, double rounding) const;

 private:
  struct Pin {
    int vertex;
    int until;   ///< the last step boundary at which it is held
    Vec3 start;  ///< m
  };
  struct Group {
    Motion motion;
    std::vector<Pin> pins;
  };
  std::vector<Group> groups_;
  double dt_, extent_;
};

}  // namespace taut
