#pragma once

#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/study/frontier/frontier.hpp"

namespace taut {

/// A setting of the standard scene, or of the solver on it, that is made harder step by step.
struct FrontierSetting {
  std::string name;  ///< "time step"
  std::string unit;  ///< unit of the setting; "": a plain number
  FrontierQuestion question;
  std::string lacks;                 ///< why the solver has no such setting; "" if it has
  std::optional<Prediction> theory;  ///< known end of what is possible, in the setting's unit
};

/// Relative width of the brackets that frontier_settings() asks for.
inline constexpr double kBracketWidth = 0.02;

/// The settings of the standard scene under a solver: time step, sweeps, stiffness, mass ratio,
/// resolution, speed of a collider, size (in both directions), distance from the origin, bending,
/// wind. Each goes from an easy to an absurd value.
///
/// The standard scene is `swing` (pinned along its top edge and released 45 degrees from rest) with
/// 9 x 9 vertices, for 2 s in steps of kStep (settings.cpp). It is passive and mirror-symmetric.
///
/// Theories:
///   time step, stiffness, bending, mass ratio: linear_stability, for springs
///   wind: c h/sigma < 2, explicit drag of a face across the wind; h: substep (truth wind-face)
///   distance: in float, g h^2 above four units in the last place (truth float-gravity)
///   speed: D/h, beyond which tests at step boundaries miss a plate of thickness D (truth
///          tunnelling); only with contact=discrete
/// Throws InputError if there is no such solver.
std::vector<FrontierSetting> frontier_settings(const std::string& solver);

/// The data by which a run is judged.
struct JudgedRun {
  Case one;
  Record record;
  std::vector<Vec3> end;  ///< positions at the end [m]; empty if the run did not reach it
};

/// Symptoms of a run, the gravest first. Each is measured by its own rule:
///   NaN, explodes       status `exploded`: not finite; beyond the scene's energy or space
///   crashes             the process crashed
///   refuses             the solver says that it would misread the scene
///   tunnels             a vertex ended on the other side of a collider (tunnelling.count)
///   overstretches       a link is stretched by more than kStretched (stretch.max), or status
///                       `extreme`
///   freezes             the centre of mass moved less than kFrozen times as far as at the start
///                       of the range, scaled down with the cloth (drift.max)
///   gains energy        a passive scene's mechanical energy rose by over kGained of
///                       swing_energy() (energy.peak)
///   jitters             in the last second, a vertex accelerates by over kJitter and kMoreJitter
///                       times as much as at the start of the range (popping.max), or status
///                       `unsettled`
///   asymmetric          a mirror-symmetric scene ends over kMirrored of its size from its mirror
///                       image
///   loses energy        a passive scene lost over kLost of swing_energy() (energy.mean)
/// The constants are in symptom.cpp.
/// `start` is the run at the start of the range; nullptr if this run is it.
std::vector<std::string> symptoms(const JudgedRun&, const JudgedRun* start);

/// Energy that a pinned cloth can release by swinging [J]: the potential energy of its start above
/// that of hanging straight down, where each vertex is below its nearest pin at its rest distance
/// from it. 0 if the scene is not passive or the cloth is not pinned.
double swing_energy(const Scene&);

/// Largest distance of a vertex from the mirror image of the cloth [m], for the plane across its
/// first side. 0 if the scene does not have this symmetry: a grid with rows along x, and gravity
/// and all else in the plane.
double asymmetry(const Scene&, const std::vector<Vec3>& end);

/// How far one parameter can go under one solver.
struct ParameterFrontier {
  std::string solver;  ///< "bullet:iterations=4"
  std::string parameter, unit;
  std::string lacks;             ///< why the members below have no values; "" if they have
  bool downwards = false;        ///< whether a smaller value is harder
  double from = 0, to = 0;       ///< easiest and hardest requested setting
  double good = std::nan("");    ///< hardest setting up to which nothing was wrong; NaN: none
  double bad = std::nan("");     ///< easiest setting at which something was wrong; NaN: none
  std::string symptom;           ///< symptoms at `bad`, the gravest first
  std::string at_start;          ///< symptoms at `from`, which are therefore not counted
  double theory = std::nan("");  ///< theoretical end; NaN if it is not within the range
  std::string law;               ///< law of the theory; "": no theory
  CaseSpec beyond;               ///< case at `bad`
  std::size_t cases = 0, ran = 0;

  /// Factor by which the setting may be made harder than its start; NaN if not at all.
  double headroom() const { return downwards ? from / good : good / from; }
};

/// All frontiers of a solver on the standard scene; nothing if interrupted. Every probe is a case
/// in the store and is judged by symptoms(). Calls `progress` after each frontier.
std::optional<std::vector<ParameterFrontier>> find_frontiers(
    const std::string& solver, Store&, const CampaignOptions&,
    const std::function<void(std::size_t done, std::size_t all)>& progress);

/// The answer of `taut frontier --all`.
Answer answer_of(const std::vector<ParameterFrontier>&);
/// Inverse of answer_of(). Throws InputError if it is another kind of answer.
std::vector<ParameterFrontier> frontiers_of(const Answer&);

/// Folder for the pictures of `taut frontier --all`, in a results folder, and for its baselines.
inline constexpr std::string_view kFrontiersFolder = "frontiers";

}  // namespace taut
