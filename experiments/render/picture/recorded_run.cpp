#include "experiments/render/picture/recorded_run.hpp"

#include <algorithm>

#include "core/model/input_error.hpp"
#include "core/model/params.hpp"

namespace taut {

namespace {

bool is_sound(const State& state, const Vec3& centre, double reach) {
  return std::ranges::all_of(
      state.x, [&](const Vec3& p) { return p.allFinite() && (p - centre).norm() <= reach; });
}

/// Fills in what a trajectory without velocities leaves out: backward differences, as Verlet has
/// them; the scene's own at the start.
void add_velocities(const Scene& scene, std::vector<TrajectoryReader::Frame>& frames) {
  for (std::size_t k = 0; k < frames.size(); ++k) {
    State& now = frames[k].state;
    if (!now.v.empty()) continue;
    now.v = scene.start.v;
    const double dt = k > 0 ? frames[k].t - frames[k - 1].t : 0;
    if (dt <= 0) continue;
    for (std::size_t i = 0; i < now.x.size(); ++i)
      now.v[i] = (now.x[i] - frames[k - 1].state.x[i]) / dt;
  }
}

}  // namespace

const TrajectoryReader::Frame& RecordedRun::at(double t) const {
  const auto& frames = trajectory.frames;
  const auto after = std::ranges::lower_bound(frames, t, {}, &TrajectoryReader::Frame::t);
  if (after == frames.begin()) return *after;
  if (after == frames.end()) return frames.back();
  return t - std::prev(after)->t <= after->t - t ? *std::prev(after) : *after;
}

RecordedRun recorded_run(const Scene& scene, Trajectory trajectory, double reach) {
  RecordedRun run;
  auto& frames = trajectory.frames;
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : scene.start.x) centre += p / scene.mesh.size();
  const double limit =
      reach * extent(scene) + scene.gravity.norm() * scene.duration() * scene.duration();
  const auto bad = std::ranges::find_if_not(
      frames, [&](const auto& frame) { return is_sound(frame.state, centre, limit); });
  const bool exploded = bad != frames.end();
  frames.erase(bad, frames.end());
  if (frames.empty())
    throw InputError("the trajectory of '" + trajectory.header.solver +
                     "' has no stable frame: there is nothing to draw");
  add_velocities(scene, frames);
  const double slack = 1.5 * std::max(trajectory.header.frame_dt, scene.dt);
  if (exploded || frames.back().t < scene.duration() - slack)
    run.stop = RecordedRun::Stop{frames.back().t, exploded ? "exploded" : "ended"};
  run.trajectory = std::move(trajectory);
  return run;
}

}  // namespace taut
