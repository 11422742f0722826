#include "experiments/study/references.hpp"

#include <algorithm>

#include "core/model/text.hpp"
#include "core/reference/shake.hpp"
#include "core/reference/static_equilibrium.hpp"
#include "experiments/case/reference_store.hpp"

namespace taut {

namespace {

struct Goal {
  std::filesystem::path folder;
  bool replace = false;
};

/// Why a reference of this kind need not be computed; "" if it must be.
std::string kept(const Scene& scene, const std::string& kind, double t, const Goal& goal) {
  const std::filesystem::path file = reference_file(
      {scene.name, reference_digest(scene, kind), kind, t, "", 0, {}}, goal.folder / scene.name);
  if (goal.replace || !std::filesystem::exists(file)) return "";
  return file.string() + " is there; --replace computes it again";
}

ReferenceOutcome write_static(const Scene& scene, const Goal& goal) {
  if (const std::string why = kept(scene, "static", 0, goal); !why.empty())
    return {scene.name, "static", "", why};
  const reference::Equilibrium rest = reference::static_equilibrium(scene);
  if (!rest.unique) return {scene.name, "static", "", rest.reason};
  write_reference({scene.name, reference_digest(scene, "static"), "static", 0, rest.derivation,
                   rest.floor, rest.x},
                  goal.folder / scene.name);
  return {scene.name, "static", rest.derivation, "", 0, rest.floor};
}

/// Two results for the same moment agree if they differ by less than this share of the cloth's
/// size.
constexpr double kConverged = 1e-4;

/// Most halvings of the step for a moment that is not converged; they end earlier if halving does
/// not help.
constexpr int kHalvings = 3;

/// Index of the first moment that is not converged; floor.size() if all are.
std::size_t horizon(const reference::Trajectory& motion, const Scene& scene) {
  const auto beyond = [&](double floor) { return !(floor <= kConverged * extent(scene)); };
  return static_cast<std::size_t>(std::ranges::find_if(motion.floor, beyond) -
                                  motion.floor.begin());
}

/// Computes as many of these moments as the projection reaches, and removes the others from
/// `times`. Halves the step until they are converged or stop improving.
reference::Trajectory motion_of(const Scene& scene, std::vector<double>& times) {
  reference::Trajectory motion = reference::converged_motion(scene, times, 1.0 / 1024);
  for (; !motion.unique && times.size() > 1 && reference::refuse_dynamic(scene).empty();
       motion = reference::converged_motion(scene, times, 1.0 / 1024))
    times.pop_back();  // the last moment may be out of reach
  for (int halved = 0; motion.unique && halved < kHalvings; ++halved) {
    const std::size_t k = horizon(motion, scene);
    if (k == times.size()) break;
    reference::Trajectory finer = reference::converged_motion(scene, times, motion.dt / 2);
    if (!finer.unique || !(finer.floor[k] < motion.floor[k] / 2)) break;
    motion = std::move(finer);
  }
  return motion;
}

/// Writes the references of states in motion, up to the horizon to which they are converged.
std::vector<ReferenceOutcome> write_motion(const Scene& scene, const Goal& goal) {
  if (const std::string why = kept(scene, "motion", 0.5, goal); !why.empty())
    return {{scene.name, "motion", "", why}};
  std::vector<double> times{0.5, 1, 1.5, 2};
  const reference::Trajectory motion = motion_of(scene, times);
  if (!motion.unique) return {{scene.name, "motion", "", motion.reason}};
  std::vector<ReferenceOutcome> outcomes;
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (k == horizon(motion, scene)) {
      outcomes.push_back({scene.name, "motion", "",
                          "chaotic: with dt = 1/" + shortest(1 / motion.dt) +
                              " s and half of it places differ by this floor, more than 1e-4 of "
                              "the cloth's size, and halving the step does not help: only "
                              "statistics have a meaning",
                          times[k], motion.floor[k]});
      break;
    }
    write_reference({scene.name, reference_digest(scene, "motion"), "motion", times[k],
                     motion.derivation, motion.floor[k], motion.states[k].x},
                    goal.folder / scene.name);
    outcomes.push_back({scene.name, "motion", motion.derivation, "", times[k], motion.floor[k]});
  }
  return outcomes;
}

}  // namespace

std::vector<ReferenceOutcome> write_references(const Scene& scene,
                                               const std::filesystem::path& folder, bool replace) {
  const Goal goal{folder, replace};
  std::vector<ReferenceOutcome> all{write_static(scene, goal)};
  std::ranges::move(write_motion(scene, goal), std::back_inserter(all));
  return all;
}

}  // namespace taut
