#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/study/frontier.hpp"

namespace taut {

/// A setting of the standard scene, or of the solver on it, that is made harder and harder.
struct ExtremeSetting {
  std::string name;  ///< "time step"
  std::string unit;  ///< of the setting; "": a plain number
  FrontierQuestion question;
  std::string lacks;                 ///< why the solver has no such setting; "": it has
  std::optional<Prediction> theory;  ///< where something is known to end, in the setting's unit
};

/// The standard scene: `swing` (pinned along its top edge, let go 45 degrees from rest) on 9 x 9
/// vertices for 2 s in steps of 1/240 s. It is passive and mirror-symmetric.
///
/// Its settings: time step, sweeps, stiffness, mass ratio, resolution, speed of a collider, size
/// (both ways), distance from the origin, wind; each from where it is easy to where it is absurd.
/// Theories:
///   time step, stiffness, mass ratio: linear_stability, of springs
///   wind: c h/sigma < 2, explicit drag of a face across the wind; h: substep (truth wind-face)
///   distance: in float, g h^2 above half a unit in the last place (truth float-gravity)
///   speed: D/h, beyond which tests at step boundaries miss a plate of thickness D (truth
///          tunnelling); contact=discrete alone
/// Throws InputError: no such solver.
std::vector<ExtremeSetting> extreme_settings(const std::string& solver);

}  // namespace taut
