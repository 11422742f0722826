#pragma once

#include <array>
#include <vector>

#include "core/model/scene.hpp"

namespace taut {

/// What is known of a cloth whose motion in contact is chaotic, at one moment.
struct Observables {
  Vec3 centre = Vec3::Zero();   ///< m, of mass
  Vec3 lengths = Vec3::Zero();  ///< m, RMS distances of the mass from the centre along the axes
  double in_contact = 0;        ///< share of the vertices within kTouch of a body's surface

  /// A vertex touches up to this share of the cloth's extent beyond the thickness.
  static constexpr double kTouch = 1e-3;

  Observables& operator+=(const Observables&);
  Observables operator*(double) const;
};
Observables observables(const Scene&, const std::vector<Vec3>& x, double t);

/// The largest of: distance of the centres over `fall`, largest difference of a length over `fall`,
/// difference of the shares in contact.
double apart(const Observables&, const Observables&, double fall);

}  // namespace taut
