#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/model/scene.hpp"

namespace taut {

/// A cloth at one moment.
struct Frame {
  double t = 0;  ///< s
  State state;   ///< v is empty
};

/// A whole motion in memory.
struct Trajectory {
  std::string solver;   ///< SolverChoice::canonical()
  double frame_dt = 0;  ///< s, nominal: frames carry their own times
  std::vector<Frame> frames;
};

/// A frame as results keep it, little-endian: t [s] as float64, x [n][3] [m] as float32. Non-finite
/// states are data. numpy reads frames as
/// np.frombuffer(motion, [("t", "<f8"), ("x", "<f4", (n, 3))]).
std::string frame_bytes(const Frame&);

/// Reads frames with this number of vertices, one after the other. An incomplete frame at the end,
/// left by a writer that was killed, is dropped. Throws InputError if there is no whole frame or if
/// times decrease.
std::vector<Frame> frames_in(std::string_view bytes, int vertices);

}  // namespace taut
