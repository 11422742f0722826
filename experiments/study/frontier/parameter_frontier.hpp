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

/// A setting of the standard scene, or of the solver on it, that is made harder and harder.
struct FrontierSetting {
  std::string name;  ///< "time step"
  std::string unit;  ///< of the setting; "": a plain number
  FrontierQuestion question;
  std::string lacks;                 ///< why the solver has no such setting; "": it has
  std::optional<Prediction> theory;  ///< where something is known to end, in the setting's unit
};

/// The standard scene: `swing` (pinned along its top edge, let go 45 degrees from rest) on 9 x 9
/// vertices for 2 s in steps of 1/240 s. It is passive and mirror-symmetric.
///
/// Its settings: time step, sweeps, stiffness, mass ratio, resolution, speed of a collider, size
/// (both ways), distance from the origin, bending, wind; each from where it is easy to where it is
/// absurd.
/// Theories:
///   time step, stiffness, bending, mass ratio: linear_stability, of springs
///   wind: c h/sigma < 2, explicit drag of a face across the wind; h: substep (truth wind-face)
///   distance: in float, g h^2 above half a unit in the last place (truth float-gravity)
///   speed: D/h, beyond which tests at step boundaries miss a plate of thickness D (truth
///          tunnelling); contact=discrete alone
/// Throws InputError: no such solver.
std::vector<FrontierSetting> frontier_settings(const std::string& solver);

/// What there is to judge a run by.
struct JudgedRun {
  Case one;
  Record record;
  std::vector<Vec3> end;  ///< positions at the end [m]; empty: it did not come to its end
};

/// What is wrong with a run, the gravest first. Measured, each by its own rule:
///   NaN, explodes       status `exploded`: not finite; beyond the scene's energy or space
///   crashes             the process ended so
///   refuses             the solver says that it would misread the scene
///   tunnels             a vertex ended on the other side of a collider (tunnelling.count)
///   overstretches       a link is longer than twice its length (stretch.max > 1), or status
///                       `extreme`
///   freezes             the centre of mass moved less than a tenth as far as at the start
///                       of the range, scaled down with the cloth (drift.max)
///   gains energy        a passive scene's mechanical energy rose by over 5 % of what its swing can
///                       set free (energy.peak)
///   jitters             a vertex accelerates by over 100 g, and ten times as much as at the start
///                       of the range, in the last second (popping.max), or status `unsettled`
///   asymmetric          a mirror-symmetric scene ends over a tenth of its size from its mirror
///                       image
///   loses energy        a passive scene lost over half of that (energy.mean)
/// `start`: the run at the start of the range; nullptr: this is it.
std::vector<std::string> symptoms(const JudgedRun&, const JudgedRun* start);

/// What a pinned cloth's swing can set free [J]: from where it starts to hanging straight below its
/// pins, each vertex its distance at rest from the nearest pin. 0: not passive, or not pinned.
double swing_energy(const Scene&);

/// How far the cloth is from its mirror image in the plane across its first side [m]; 0 if the
/// scene has no such symmetry: a grid with rows along x, gravity and all else in the plane.
double asymmetry(const Scene&, const std::vector<Vec3>& end);

/// How far one parameter goes under one solver.
struct ParameterFrontier {
  std::string solver;  ///< "bullet:iterations=4"
  std::string parameter, unit;
  std::string lacks;             ///< why there is nothing below; "": there is
  bool downwards = false;        ///< smaller is harder
  double from = 0, to = 0;       ///< the easiest and the hardest setting asked for
  double good = std::nan("");    ///< hardest setting up to which nothing was wrong; NaN: none
  double bad = std::nan("");     ///< easiest setting found at which something is; NaN: none
  std::string symptom;           ///< what is wrong at `bad`, the gravest first
  std::string at_start;          ///< what is wrong at `from` already, and therefore not counted
  double theory = std::nan("");  ///< where it ends in theory; NaN: not within the range
  std::string law;               ///< of the theory; "": there is none
  CaseSpec beyond;               ///< the case at `bad`
  std::size_t cases = 0, ran = 0;

  /// How many times harder than its start it may be made; NaN: not at all.
  double headroom() const { return downwards ? from / good : good / from; }
};

/// All frontiers of a solver on the standard scene; nothing: interrupted. Every probe is a case of
/// the store, judged by symptoms(). Calls `progress` after each of them.
std::optional<std::vector<ParameterFrontier>> find_frontiers(
    const std::string& solver, Store&, const CampaignOptions&,
    const std::function<void(std::size_t done, std::size_t all)>& progress);

/// What `taut frontier --all` answers.
Answer answer_of(const std::vector<ParameterFrontier>&);
/// What such an answer was made of. Throws InputError: it is another one.
std::vector<ParameterFrontier> frontiers_of(const Answer&);

/// Where `taut frontier --all` draws its pictures in a results folder, and keeps its baselines.
inline constexpr std::string_view kFrontiersFolder = "frontiers";

}  // namespace taut
