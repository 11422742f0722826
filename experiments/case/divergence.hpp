#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/model/scene.hpp"
#include "core/model/solver.hpp"
#include "experiments/case/record.hpp"

namespace taut {

/// An upper bound on the kinetic energy [J] that the scene itself can put into the cloth until time
/// t: the "available potential drop", wind, prescribed motion and a strained start included. It
/// depends on the scene and on the length of a substep, on nothing else of the solver, and it is
/// generous wherever a soft solver may legitimately stretch. dt is the scene's time step or, of
/// a solver with substeps, the substep: a motion has one budget, however it is cut into steps. The
/// sum of
///
///   start    m v^2/2 of every free vertex
///   gravity  m |g| h. h is the discrete free fall |g| t (t + dt)/2. For a piece of cloth that is
///            pinned it is at most its reach, twice the longest way along links (or sides of a
///            membrane's triangles, here and below) from a pin, plus
///            the extension of the softest relaxation (one sweep a step), doubled for overshoot.
///            In that relaxation a cut across c links with the mass M below it opens by
///            M |g| dt^2 w/c (truth hanging-chain-sweeps: e_j = (N - j) |g| dt^2)
///   wind     law "relative": power c A (n.(u - v)) (n.v) <= c A |u|^2/4, times t;
///            law "literal": the speed c |u| t A/m of a vertex that is pushed all the time
///   motion   (2 V)^2 M/2, V the sum of the speeds that moving pins and colliders can impart: every
///            change of a prescribed velocity counts
///   repair   (D/dt)^2 M/2, D the way that relaxation may move a vertex in one step because the
///            start breaks constraints: the summed excess of the links (at most the extent of the
///            cloth, at start and at rest), the longest way of a vertex, an edge or a face out of a
///            collider, twice the self-collision radius
///   bending  the scene's energy of bending and of the membrane at the start
///   stored   energy of links that the start strains by e, k e^2/2. Solvers choose k; the largest
///            stable one is taken, 4/((w1 + w2) dt^2). Up to it the motion stays bounded, but grows
///            over n steps by a factor of at most 2n + 1: x_n = x_0 cos((n + 1/2) a)/cos(a/2),
///            w dt = 2 sin(a/2). So (2 t/dt + 1)^2 sum of 2 e^2/((w1 + w2) dt^2)
///   rounding (1e-6 |x|/dt)^2 M/2: positions in binary32
class EnergyBudget {
 public:
  explicit EnergyBudget(const Scene&, int substeps = 1);
  double available(double t) const;  ///< J at time t [s]
  /// A coordinate [m] that no vertex can have at time t: a thousand sizes of the scene and ten
  /// times the way that start, motion, wind and gravity can carry it, 1e6 at most.
  double farthest(double t) const;

 private:
  double constant_ = 0;           ///< start, motion, repair, bending, rounding [J]
  double stored_ = 0;             ///< J, before the first step
  double gravity_ = 0;            ///< |g| [m/s^2]
  double dt_ = 0;                 ///< s, of a substep
  double free_mass_ = 0;          ///< kg, of pieces without a pin
  double hung_mass_ = 0;          ///< kg, of pinned pieces, without their pins
  double reach_ = 0;              ///< m, of pinned pieces
  double wind_power_ = 0;         ///< W
  double wind_mass_ = 0;          ///< kg pushed by the literal law
  double wind_acceleration_ = 0;  ///< m/s^2, literal law
  double size_ = 0;               ///< m, of the cloth and its distance from the origin
  double speed_ = 0;              ///< m/s that start, motion and wind can give
};

/// The largest strain [1] of a link with which a case is not yet extreme, whoever solves it. It is
/// 2 (three times its length) or, if that is larger, twice the strain of the softest relaxation,
/// one sweep a step (truth legitimate-strain: 2 (N - 1) g dt^2/l in a hanging chain; here by cuts,
/// as in EnergyBudget). It is at most 30: larger strains never enter a mean, even if start, step or
/// forces cause them. Why 2: of 942 cases of the main job that would otherwise count, it marks 29,
/// all with more than 7 % of RMS stretch at the end; 1 would mark 57, some with 3 %.
double legitimate_strain(const Scene&, int substeps = 1);

/// Theoretical settling time [s]: in it the slowest mode of a hanging cloth decays by 1/e. Relaxing
/// strain takes 8 N^2 dt/(pi^2 k) (Gauss-Seidel, N links from a pin to the farthest vertex, k
/// sweeps per step); swinging takes the inverse of ln(1 + w^2 h^2)/(2 h) + damping/2 with h the
/// substep and w = 1.2024 sqrt(g/L) (backward projection of the slowest transverse mode). Their
/// sum. Empty where no such time is known: wind, motion, contact, pins that let go, no gravity,
/// unpinned pieces, no sweeps.
std::optional<double> settling_time(const Scene&, const std::vector<PassCost>& step_cost,
                                    int substeps = 1);

/// Judges a run, step by step. A large strain is no explosion, since soft cloth may rightly have
/// it.
///   error                the solver stored another number of vertices than the scene has
///   exploded{nonfinite}  a position or velocity is not finite
///   exploded{energy}     kinetic energy above ten times EnergyBudget::available
///   exploded{box}        a coordinate beyond EnergyBudget::farthest
///   extreme{stretch}     a structural or shear link with at least one free end exceeded
///                        legitimate_strain(); the run goes on, and its values are kept.
///                        "stretch, moves after five settling times": it is also unsettled
///   unsettled            the run lasted at least five settling times and yet, in its last settling
///                        time, a vertex is faster than 1e-3 sqrt(|g| L) (L: extent) and than the
///                        fastest ever seen times exp(-t/T)
class DivergenceDetector {
 public:
  /// The scene must outlive it.
  DivergenceDetector(const Scene&, const std::vector<PassCost>& step_cost, int substeps = 1);
  /// False if the run has exploded at this boundary; status() says how.
  bool observe(int step, double t, const State&);
  /// To be called at the end of a run that was observed to its end.
  void finish();
  const Status& status() const { return status_; }

 private:
  /// Notes that the run exploded; returns false, which observe() then does.
  bool explode(Reason, int step, std::size_t vertex);
  void judge_stretch(int step, const State&);
  const Scene& scene_;
  std::vector<Link> ties_;
  EnergyBudget budget_;
  double legitimate_strain_ = 0;
  std::vector<double> free_mass_;  ///< [n] kg, 0 for pins that hold to the end
  std::optional<double> settling_;
  double duration_ = 0;
  double slow_ = 0;  ///< 1e-3 sqrt(|g| L) [m/s]
  double peak_ = 0;  ///< fastest vertex so far [m/s]
  double late_ = 0;  ///< fastest vertex in the last settling time [m/s]
  int late_vertex_ = -1;
  Status status_;
};

}  // namespace taut
