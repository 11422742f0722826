#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "core/model/declared_step.hpp"
#include "core/model/scene.hpp"

namespace taut::reference {

/// A position as a weighted sum of the positions of these vertices.
using Weights = std::map<std::size_t, double>;

/// Linear relations of rigidly linked vertices: four in a plane or three on a line stay so, which
/// their links ensure at second order only. Each relation is solved for one vertex that moves.
/// Returns [n] the position of each vertex from those without a relation, which have themselves
/// alone; empty if there is no relation. inertia: [n], 0 for pins. Links without a finite stiffness
/// [N/m] are rigid.
std::vector<Weights> rigid_relations(const Scene&, const Stiffness&,
                                     const std::vector<double>& inertia);

}  // namespace taut::reference
