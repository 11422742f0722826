#pragma once

#include "experiments/render/opengl/light.hpp"
#include "experiments/render/picture/recorded_run.hpp"

namespace taut {

/// Where camera, ground and the region of interest stand: the same for all runs and all moments of
/// a picture or video.
struct Placing {
  Vec3 up = Vec3::UnitY();
  Camera camera;                    ///< relative to the cloth's centroid if it follows
  bool follows = false;             ///< the camera moves with cloth that nothing holds
  Vec3 centre = Vec3::Zero();       ///< m, of what is seen, relative likewise
  double radius = 1;                ///< m, of what is seen
  double ground = 0;                ///< m, height along up
  double cell = 0.25;               ///< m between ground lines
  double inset = 0;                 ///< m, of colliders
  const Collider* floor = nullptr;  ///< a level plane at rest: it is the ground

  /// The ground below a point.
  GroundLight floor_below(const Vec3& point) const;
  /// Behind cloth that the camera follows: lines that stay where they are in the world, so that the
  /// motion is seen.
  GroundLight wall(const Vec3& point) const;
};

/// Mean position of all runs' vertices at time t [m].
Vec3 centroid(const std::vector<RecordedRun>&, double t);

/// Frames what happens at `times` in a picture of this width / height. Cloth that is held or has
/// something to land on is expected to stay near; what slips off or stretches away leaves the
/// picture rather than shrinking all the rest. `inset` [m] is that of colliders.
Placing place(const Scene&, const std::vector<RecordedRun>&, const std::vector<double>& times,
              const View&, const FitRegion&, double aspect, double inset);

}  // namespace taut
