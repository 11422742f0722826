#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/positions/positions.hpp"
#include "core/model/scene.hpp"
#include "core/model/solver.hpp"

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

/// What rounding the coordinates does to the strain of a scene's links: less says nothing.
struct StrainFloor {
  double rms = 0;  ///< expected, over the links
  double max = 0;  ///< no link is off by more
};

/// A file of positions as a motion of a scene's cloth: in m, y up, in the scene's order.
class MotionFile {
 public:
  /// Throws InputError: malformed file. What does not fit the scene is in misfits().
  MotionFile(const Scene&, const MotionOptions&);
  const PositionsHeader& header() const { return reader_->header(); }
  /// Why it is no motion of this scene, a sentence each; empty: it is one.
  const std::vector<std::string>& misfits() const { return misfits_; }
  double frame_dt() const { return frame_dt_; }  ///< s, said, or the scene's
  /// Positions at t = k frame_dt [m]. Precondition: no misfits.
  std::vector<Vec3> frame(int k);
  StrainFloor floor(const Scene&);
  /// What was said, read or derived, for the record and for people.
  ResolvedSettings settings(const Scene&);

 private:
  void find_place(const Scene&);
  void check_pins(const Scene&);
  std::string place() const;

  std::unique_ptr<PositionReader> reader_;
  MotionOptions options_;
  double frame_dt_;
  std::string order_said_;
  std::vector<std::size_t> of_scene_;
  std::vector<std::string> misfits_;
};

/// Stands for all files of positions where none is named.
extern const SolverEntry kPositions;

/// The entry of "positions:file=...", or of another name: plays what another program computed as if
/// it computed it now, without cost. Lives as long as this program. Throws InputError if the file
/// cannot be read.
const SolverEntry* recorded(const std::string& name, std::string_view params);

/// The text that names this motion as a solver.
std::string solver_text(const MotionOptions&);

}  // namespace taut::external
