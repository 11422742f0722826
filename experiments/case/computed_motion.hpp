#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/io/positions/positions.hpp"
#include "core/model/scene.hpp"
#include "core/model/solver.hpp"
#include "experiments/case/run_case.hpp"

/// Positions that another program computed, as a motion of a scene's cloth. `taut external score`,
/// the solver `positions` and taut.score of Python all judge them here.
namespace taut {

/// Frames, and how to read them; what is not given is inferred.
struct ComputedFrames {
  std::string name;                           ///< in messages: a file, "positions"
  std::shared_ptr<PositionReader> positions;  ///< the start first
  std::shared_ptr<PositionReader> rest;       ///< its first frame is the cloth at rest, in the same
                                              ///< order; null: `positions` begin at the start
  std::string rest_name = "rest";             ///< in messages
  double fps = 0;                             ///< frames in a second; 0: one a step of the scene
  double scale = 1;                           ///< m per unit
  bool z_up = false;                          ///< else y
};

/// Strain of a scene's links that rounding of the coordinates causes; smaller strains mean nothing.
struct StrainFloor {
  double rms = 0;  ///< expected, over the links
  double max = 0;  ///< no link is off by more
};

/// Frames in m, y up, in the scene's order.
class ComputedMotion {
 public:
  /// misfits() lists what does not fit the scene. Throws InputError if a file is malformed.
  ComputedMotion(const Scene&, ComputedFrames);
  const PositionsHeader& header() const { return frames_.positions->header(); }
  /// Reasons, one sentence each, why it is no motion of this scene; empty: it is one.
  const std::vector<std::string>& misfits() const { return misfits_; }
  double frame_dt() const { return frame_dt_; }  ///< [s] as given, or the scene's
  /// Positions at t = k frame_dt [m]. Precondition: no misfits.
  std::vector<Vec3> frame(int k);
  /// The scene's start, or what follows it if the frames begin later, with the velocity at which
  /// they go on. Precondition: no misfits.
  State start(const Scene&);
  StrainFloor floor(const Scene&);
  /// The settings that were given, read or derived, for the record and for people.
  ResolvedSettings settings(const Scene&);

 private:
  void find_place(const Scene&);
  void check_pins(const Scene&);
  std::string place() const;

  ComputedFrames frames_;
  double frame_dt_;
  std::string order_said_;
  std::vector<std::size_t> of_scene_;
  std::vector<std::string> misfits_;
};

/// The solver `positions`: plays what `open` gives as if it computed it now, without cost.
SolverEntry player(std::function<ComputedFrames(const Params&)> open);

/// Reads a scene with these settings (core/io/scene_io.hpp).
using LoadScene = std::function<Scene(const SceneSettings&)>;

/// The settings with which the scene has the frames' time step and, if they end earlier, their
/// duration. Throws InputError if the scene cannot be read with them or there is only one frame.
SceneSettings fitted(const LoadScene&, SceneSettings, const ComputedFrames&);

/// Runs the frames through every metric and the verdict on a run, as run_case does with a solver's;
/// velocities are differences between frames. A coordinate that is not finite is a result
/// (exploded). Throws InputError, with the reasons, if the frames are no motion of this scene.
CaseRun score(const Scene&, const ComputedFrames&, const RunOptions& = {});

}  // namespace taut
