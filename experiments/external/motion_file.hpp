#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/model/solver.hpp"
#include "experiments/case/computed_motion.hpp"

namespace taut::external {

/// Options of a motion that a file holds. Missing ones are inferred.
struct MotionOptions {
  std::filesystem::path file;  ///< positions; core/io/positions lists the formats
  double fps = 0;              ///< frames per second; 0: one frame for each step of the scene
  double scale = 1;            ///< m per unit of the file
  bool z_up = false;           ///< the file's up axis: z if true, y otherwise
  /// File whose first frame is the cloth at rest, in the same order of vertices. Empty: the first
  /// frame of `file` itself is the start of the scene.
  std::filesystem::path rest;
};

/// Opens the files. Throws InputError if one is unreadable or malformed.
ComputedFrames opened(const MotionOptions&);

/// Entry for a solver text "positions" that names no file.
extern const SolverEntry kPositions;

/// Entry of "positions:file=...", or of the same under another name. It plays back another
/// program's positions as if they were computed now, at no cost. The entry lives until this program
/// ends. Throws InputError if the file cannot be read.
const SolverEntry* recorded(const std::string& name, std::string_view params);

/// Solver text that stands for this motion.
std::string solver_text(const MotionOptions&);

}  // namespace taut::external
