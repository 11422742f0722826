#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "core/model/declared_step.hpp"
#include "core/model/scene.hpp"

namespace taut::reference {

/// A place as a sum of weights times the places of these vertices.
using Weights = std::map<std::size_t, double>;

/// Four vertices in a plane, or three on a line, all rigidly linked, stay so: linear relations,
/// which their links say at second order only. Each is solved for one vertex that moves. [n] The
/// place of each vertex by those that have no relation, which have themselves alone; empty: there
/// is no relation. inertia: [n], 0 of pins; links without a finite stiffness [N/m] are rigid.
std::vector<Weights> rigid_relations(const Scene&, const Stiffness&,
                                     const std::vector<double>& inertia);

}  // namespace taut::reference
