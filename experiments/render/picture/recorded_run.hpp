#pragma once

#include <optional>
#include <string>

#include "experiments/case/record.hpp"
#include "experiments/case/trajectory.hpp"
#include "experiments/render/image/image.hpp"

namespace taut {

/// One solver's run of a scene as the renderer shows it: stable frames only, and why they end
/// early.
struct RecordedRun {
  struct Stop {
    double t = 0;     ///< s, of the last stable frame
    std::string why;  ///< "exploded"
  };
  std::string title;     ///< "Jakobsen"
  std::string settings;  ///< "1 × 16, order=mesh": substeps × sweeps first
  Rgb8 colour;           ///< the solver's throughout a report
  Trajectory trajectory;
  std::optional<Stop> stop;

  /// The frame nearest to t: the last one if the run ended before. Precondition: frames exist.
  const TrajectoryReader::Frame& at(double t) const;
};

/// Drops everything from the first frame that is not finite or lies more than `reach` extents of
/// the scene from where the cloth started, and says so in `stop`; so it does when the file ends
/// before the scene does. Throws InputError if no stable frame is left.
RecordedRun recorded_run(const Scene&, Trajectory, double reach = 50);

}  // namespace taut
