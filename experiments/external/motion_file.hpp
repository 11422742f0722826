#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/model/solver.hpp"
#include "experiments/case/computed_motion.hpp"

namespace taut::external {

/// User-supplied options; missing ones are inferred.
struct MotionOptions {
  std::filesystem::path file;  ///< positions (core/io/positions)
  double fps = 0;              ///< frames in a second; 0: one a step of the scene
  double scale = 1;            ///< m per unit of the file
  bool z_up = false;           ///< else y
  std::filesystem::path rest;  ///< its first frame is the cloth at rest, in the file's order;
                               ///< empty: the file's own first frame is the scene's start
};

/// Throws InputError: unreadable or malformed.
ComputedFrames opened(const MotionOptions&);

/// Stands for all files of positions where none is named.
extern const SolverEntry kPositions;

/// The entry of "positions:file=...", or of another name: plays what another program computed as if
/// it computed it now, without cost. Lives as long as this program. Throws InputError if the file
/// cannot be read.
const SolverEntry* recorded(const std::string& name, std::string_view params);

/// The text that names this motion as a solver.
std::string solver_text(const MotionOptions&);

}  // namespace taut::external
