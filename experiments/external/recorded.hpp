#pragma once

#include <string>
#include <string_view>

#include "core/model/solver.hpp"
#include "experiments/external/motion_file.hpp"

namespace taut::external {

/// Stands for all files of positions where none is named.
extern const SolverEntry kPositions;

/// The entry of "positions:file=...", or of another name: plays what another program computed as if
/// it computed it now, without cost. Lives as long as this program. Throws InputError if the file
/// cannot be read.
const SolverEntry* recorded(const std::string& name, std::string_view params);

/// The text that names this motion as a solver.
std::string solver_text(const MotionOptions&);

}  // namespace taut::external
