#include "experiments/study/references.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <utility>

#include "core/model/index.hpp"
#include "core/model/larger.hpp"
#include "core/model/text.hpp"
#include "core/reference/shake.hpp"
#include "core/reference/springs.hpp"
#include "core/reference/static_equilibrium.hpp"
#include "experiments/answer/number.hpp"
#include "experiments/case/reference_store.hpp"
#include "experiments/metrics/observables.hpp"
#include "experiments/metrics/reference_path.hpp"

namespace taut {

namespace {

struct Goal {
  std::filesystem::path folder;
  bool replace = false;
};

/// Why a reference of this kind need not be computed; "" if it must be.
std::string kept(const Scene& scene, const std::string& kind, const Goal& goal) {
  const std::filesystem::path file =
      reference_file(kind, reference_digest(scene, kind), goal.folder / scene.name);
  if (goal.replace || !std::filesystem::exists(file)) return "";
  return file.string() + " is there; --replace computes it again";
}

ReferenceOutcome write_static(const Scene& scene, const Goal& goal) {
  if (const std::string why = kept(scene, "static", goal); !why.empty())
    return {scene.name, "static", "", why};
  const reference::Equilibrium rest = reference::static_equilibrium(scene);
  if (!rest.unique) return {scene.name, "static", "", rest.reason};
  write_reference(
      {scene.name, reference_digest(scene, "static"), rest.derivation, rest.floor, rest.x},
      goal.folder / scene.name);
  return {scene.name, "static", rest.derivation, "", 0, rest.floor};
}

constexpr int kMoments = 32;
/// Longest horizon [s]: about two periods of the slowest mode of a square metre that swings.
constexpr double kLongest = 2;
/// A horizon is a multiple of this [s].
constexpr double kGrain = 0.125;
/// Horizon [s] for which a smaller level is given up, and the shortest that tells something.
constexpr double kWanted = 1.25, kShortest = 0.5;
constexpr double kSampling = kGrain / kMoments;  ///< s; it divides the intervals of all horizons
/// Stiffness [N/m] of springs in place of rigid links, and a second one that should make no
/// difference.
constexpr double kStiff = 1e6, kLessStiff = 1e5;
constexpr double kPerturbation = 1e-6;  ///< of the cloth's size
/// Errors of which a reference may be a third; the least is the last level of the trade.
constexpr double kLeastLevels[] = {0.01, 0.02, 0.05, 0.1, 0.2};

using Path = std::vector<State>;  ///< at multiples of kSampling, the start included

/// A way to compute the motion, and its result.
struct Computed {
  std::string how;
  Path path;  ///< shorter if it did not get further
  /// Largest error of the first way as a share of the distance between the two.
  double share = 1;
};

Path springs_path(const Scene& scene, double rigid, double dt, double seconds) {
  reference::Springs springs(scene, rigid, dt);
  Path path{scene.start};
  for (int k = 1; k * kSampling <= seconds + 1e-9; ++k) {
    while (springs.time() < k * kSampling - dt / 2) springs.step();
    path.push_back(springs.state());
  }
  return path;
}

/// The path of SHAKE, as far as its projection reaches.
Path shake_path(const Scene& scene, double seconds, std::string& derivation) {
  for (double end = seconds; end >= kShortest; end /= 2) {
    std::vector<double> times;
    for (int k = 1; k * kSampling <= end + 1e-9; ++k) times.push_back(k * kSampling);
    reference::Trajectory motion = reference::converged_motion(scene, times, 1.0 / 1024);
    if (!motion.unique) continue;
    derivation = motion.derivation;
    Path path{scene.start};
    std::ranges::move(motion.states, std::back_inserter(path));
    return path;
  }
  return {};
}

/// The scene with its free vertices moved by up to kPerturbation of its size along the normals of
/// the cloth: across, links change their lengths in second order alone.
Scene perturbed(const Scene& scene, unsigned seed = 1) {
  Scene moved = scene;
  std::vector<Vec3> normals(scene.start.x.size(), Vec3::Zero());
  for (const auto& [a, b, c] : scene.mesh.triangles) {
    const std::vector<Vec3>& x = scene.start.x;
    const Vec3 normal = (x[to_index(b)] - x[to_index(a)]).cross(x[to_index(c)] - x[to_index(a)]);
    for (const int i : {a, b, c}) normals[to_index(i)] += normal;
  }
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(-1, 1);
  for (const std::size_t i : free_vertices(scene)) {
    const Vec3 across = normals[i].isZero(0) ? Vec3::UnitZ() : Vec3(normals[i].normalized());
    moved.start.x[i] += kPerturbation * extent(scene) * share(random) * across;
  }
  return moved;
}

/// Every state of the path up to the horizon that is a moment of it, with the start.
MotionReference cut(const Scene& scene, const Path& path, double horizon) {
  MotionReference motion{scene.name, reference_digest(scene, "motion"), "", horizon};
  const auto stride = static_cast<std::size_t>(std::lround(horizon / kMoments / kSampling));
  for (std::size_t k = 0; k <= kMoments; ++k) motion.states.push_back(path.at(k * stride));
  return motion;
}

/// motion.error of a cloth that is at place(t) at each moment; NaN if the reference hardly moves.
double error_of(const Scene& scene, const MotionReference& motion,
                const std::function<std::vector<Vec3>(int moment)>& place) {
  Scene timed = scene;
  timed.dt = motion.interval();
  timed.steps = kMoments;
  ReferencePath path(timed, motion);
  for (int k = 0; k <= kMoments; ++k) {
    const State state{k == 0 ? scene.start.x : place(k), scene.start.v};
    path.observe({k, k * timed.dt, state});
  }
  return path.error();
}

/// Largest error of the first path that the others show, up to the horizon; NaN if the cloth hardly
/// moves.
double spread(const Scene& scene, const std::vector<Computed>& all, const MotionReference& motion) {
  double most = 0;
  for (const Computed& other : all) {
    if (other.path.size() <= static_cast<std::size_t>(std::lround(motion.horizon / kSampling)))
      return Summary::kNone;
    const MotionReference beside = cut(scene, other.path, motion.horizon);
    const double error =
        error_of(scene, motion, [&](int k) { return beside.states[to_index(k)].x; });
    most = larger(most, other.share * error);
  }
  return most;
}

/// motion.error of a cloth that stands still and is only pushed out of the bodies.
double error_when_pushed_out(const Scene& scene, const MotionReference& motion) {
  std::vector<Vec3> x = scene.start.x;
  constexpr int kSteps = 16;  // between two moments
  return error_of(scene, motion, [&](int k) {
    for (int s = 1; s <= kSteps; ++s)
      for (const std::size_t i : free_vertices(scene))
        x[i] = reference::pushed_out(scene, x[i],
                                     (k - 1 + static_cast<double>(s) / kSteps) * motion.interval());
    return x;
  });
}

/// All ways to compute this motion, the most accurate first. Springs stand in for rigid links where
/// SHAKE refuses, and beside it.
std::vector<Computed> compute(const Scene& scene, double seconds) {
  std::vector<Computed> all;
  const Scene moved = perturbed(scene);
  const std::string start = "a start that differs by 1e-6 of the cloth's size across it";
  if (reference::refuse_dynamic(scene).empty()) {
    std::string derivation, ignored;
    Path path = shake_path(scene, seconds, derivation);
    if (!path.empty()) {
      all.push_back({derivation, std::move(path)});
      all.push_back({start, shake_path(moved, seconds, ignored)});
    }
  }
  if (!reference::refuse_springs(scene).empty()) return all;
  const bool rigid = std::ranges::any_of(scene.stiffness, [](double k) { return std::isinf(k); });
  const double dt = reference::Springs::longest_step(scene, kStiff);
  const std::string steps = " in explicit steps of " + number_text(1e6 * dt, 3) + " us";
  const std::string how = (rigid ? "springs of 1e6 N/m" : "springs of the scene") + steps;
  const bool alone = all.empty();
  all.push_back({how, springs_path(scene, kStiff, dt, seconds)});
  if (!alone) return all;
  all.push_back({"half the step", springs_path(scene, kStiff, dt / 2, seconds)});
  all.push_back({start, springs_path(moved, kStiff, dt, seconds)});
  // Ten times the stiffness is at least five times nearer to rigid links (springs_test), so that a
  // quarter of what the two differ by is the most that is left.
  if (rigid)
    all.push_back({"1e5 N/m",
                   springs_path(scene, kLessStiff,
                                reference::Springs::longest_step(scene, kLessStiff), seconds),
                   0.25});
  return all;
}

/// The longest horizon at which all ways agree within a third of the smallest possible level.
std::optional<MotionReference> agreed(const Scene& scene, const std::vector<Computed>& all,
                                      double seconds) {
  for (const double shortest_one : {kWanted, kShortest})
    for (const double level : kLeastLevels)
      for (double horizon = seconds; horizon >= shortest_one; horizon -= kGrain) {
        if (all.front().path.size() <= static_cast<std::size_t>(std::lround(horizon / kSampling)))
          continue;
        MotionReference motion = cut(scene, all.front().path, horizon);
        motion.floor = spread(scene, all, motion);
        if (motion.floor <= level / 3) return motion;
      }
  return {};
}

ReferenceOutcome write_motion(const Scene& scene, const Goal& goal) {
  ReferenceOutcome outcome{scene.name, "motion"};
  outcome.refused = kept(scene, "motion", goal);
  if (!outcome.refused.empty()) return outcome;
  const bool turns = std::ranges::any_of(
      scene.pin_motions, [](const PinMotion& pins) { return !pins.motion.spin.isZero(0); });
  std::vector<Computed> all;
  if (!turns) all = compute(scene, kLongest);
  if (all.size() < 2) {
    const auto reasons = reference::refuse_springs(scene);
    outcome.refused = turns             ? "its pins turn"
                      : reasons.empty() ? "the motion could not be computed"
                                        : join(reasons, "; ");
    return outcome;
  }
  std::optional<MotionReference> motion = agreed(scene, all, kLongest);
  if (!motion) {
    outcome.refused = "no horizon: " + join(all, ", ", [](const Computed& c) { return c.how; }) +
                      " differ by more than 7 % of the motion after " + shortest(kShortest) +
                      " s, or the cloth hardly moves before";
    return outcome;
  }
  for (const Computed& one : all)
    motion->derivation += (motion->derivation.empty() ? "" : "; beside ") + one.how;
  motion->pushed_out = error_when_pushed_out(scene, *motion);
  write_motion(*motion, goal.folder / scene.name);
  outcome.derivation = motion->derivation;
  outcome.t = motion->horizon;
  outcome.floor_share = motion->floor;
  return outcome;
}

}  // namespace

namespace {

constexpr int kMembers = 5;
/// Time over which observables are averaged [s].
constexpr double kEnsembleFrom = 1, kEnsembleTo = 2;
constexpr double kEnsembleSampling = 1.0 / 64;  ///< s

Observables mean_of_member(const Scene& scene, double dt) {
  reference::Springs springs(scene, kStiff, dt);
  Observables sum;
  int count = 0;
  for (int k = 1; k * kEnsembleSampling <= kEnsembleTo; ++k) {
    while (springs.time() < k * kEnsembleSampling - dt / 2) springs.step();
    if (springs.time() < kEnsembleFrom - dt / 2) continue;
    sum += observables(scene, springs.state().x, springs.time());
    ++count;
  }
  return sum * (1.0 / count);
}

/// The start moved along gravity until it touches a body, at most by 10 of its extents: a plate
/// that does not bend.
std::vector<Vec3> plate(const Scene& scene) {
  const Vec3 down = scene.gravity.normalized();
  std::vector<Vec3> x = scene.start.x;
  const double end = 10 * extent(scene);
  for (double gone = 0; gone < end;) {
    double gap = end;
    for (const Collider& body : scene.colliders) {
      const Shape shape = shape_at(body, kEnsembleTo);
      for (const Vec3& p : x) gap = std::min(gap, surface(shape, p).distance - scene.thickness);
    }
    if (gap < 1e-6 * extent(scene)) break;
    for (Vec3& p : x) p += gap * down;
    gone += gap;
  }
  return x;
}

ReferenceOutcome write_ensemble(const Scene& scene, const Goal& goal) {
  ReferenceOutcome outcome{scene.name, "ensemble"};
  outcome.refused = kept(scene, "ensemble", goal);
  if (!outcome.refused.empty()) return outcome;
  outcome.refused = join(reference::refuse_springs(scene), "; ");
  if (scene.colliders.empty()) outcome.refused = "nothing touches the cloth";
  if (!outcome.refused.empty()) return outcome;
  const double dt = reference::Springs::longest_step(scene, kStiff);
  std::vector<Observables> members;
  for (unsigned seed = 1; seed <= kMembers; ++seed)
    members.push_back(mean_of_member(perturbed(scene, seed), dt));
  Ensemble ensemble{scene.name, reference_digest(scene, "ensemble"),
                    std::to_string(kMembers) + " runs of springs of 1e6 N/m in explicit steps of " +
                        number_text(1e6 * dt, 3) +
                        " us, from starts that differ by 1e-6 of the cloth's size across it",
                    kEnsembleFrom, kEnsembleTo};
  for (const Observables& one : members) ensemble.mean += one * (1.0 / kMembers);
  ensemble.fall = (ensemble.mean.centre - observables(scene, scene.start.x, 0).centre).norm();
  double square = 0;
  for (const Observables& one : members)
    square += std::pow(apart(one, ensemble.mean, ensemble.fall), 2) / (kMembers - 1);
  ensemble.floor = 2 * std::sqrt(square);
  ensemble.plate =
      apart(observables(scene, plate(scene), kEnsembleTo), ensemble.mean, ensemble.fall);
  write_ensemble(ensemble, goal.folder / scene.name);
  outcome.derivation = ensemble.derivation;
  outcome.t = ensemble.to;
  outcome.floor_share = ensemble.floor;
  return outcome;
}

}  // namespace

std::vector<ReferenceOutcome> write_references(const Scene& scene,
                                               const std::filesystem::path& folder, bool replace) {
  const Goal goal{folder, replace};
  std::vector<ReferenceOutcome> all{write_static(scene, goal), write_motion(scene, goal)};
  // observables are for motion that is too chaotic to be known
  if (!all.back().refused.empty() && !find_references(scene, folder).motion)
    all.push_back(write_ensemble(scene, goal));
  return all;
}

}  // namespace taut
