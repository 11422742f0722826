#pragma once

#include <vector>

#include "core/model/bending.hpp"
#include "core/model/membrane.hpp"
#include "core/model/scene.hpp"

namespace taut {

/// Energies of a scene's cloth [J]: kinetic energy, and potential energy of gravity, bending, the
/// membrane and the links that the scene makes elastic, K/2 (length - rest length)^2 each. Rigid
/// links store no energy.
class MechanicalEnergy {
 public:
  explicit MechanicalEnergy(const Scene&);

  double kinetic(const State&) const;
  double potential(const State&) const;  ///< 0 at the start
  /// M g L, where L is the diagonal of the rest shape's bounding box.
  double unit() const { return unit_; }

 private:
  double stored(const std::vector<Vec3>& x) const;

  struct Spring {
    Link link;
    double stiffness = 0;  ///< N/m
  };
  std::vector<double> mass_;
  std::vector<Vec3> start_;
  Vec3 gravity_;
  std::vector<BendingElement> bending_;
  MembraneModel membrane_;
  std::vector<Spring> springs_;
  double unit_ = 0, at_start_ = 0;
};

}  // namespace taut
