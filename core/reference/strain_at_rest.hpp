#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/model/scene.hpp"
#include "core/model/solver.hpp"
#include "core/reference/resting_springs.hpp"

namespace taut::reference {

/// What a sweep visits, one after the other.
enum class Visits { links, vertices };

/// Strain that k sweeps in each substep of h [s] leave in a cloth at rest under gravity. The scene
/// is not run.
///
/// At rest each substep has to give every link the impulse of its tension, so the corrections of k
/// sweeps add up to T h^2. Slow modes hardly change within a substep, and a sweep of Gauss-Seidel
/// corrects them by (D + L)^-1, about 2 D^-1. A link thus behaves like a spring:
///
///     projections    K = c k / (h^2 (w_a + w_b)); with a spring K_s of its own 1/K + 1/K_s
///     descent (VBD)  K = K_s / F,  F = (1 + q e^-s) / (1 - e^-s),  q = g h^2 / (sag at K_s),
///                    s = k (1 + q) a / (a + K_s / c),  a = m/h^2
///
/// A vertex's own update lifts it by what its links hold along gravity, d = sum (u.g/|g|)^2 over
/// that of most vertices: F is a factor of its weight with d K_s in place of K_s and its own m.
///
/// The sheet of these springs at rest (RestingSprings) has the strains, times s / (e^s - 1) with
/// s = g h^2 / sag, because the slow modes change within a substep, too. Links with a spring of
/// their own have s + 2 k a / (w_a + w_b + a), a = 1/(K_s h^2), in place of s: this term was
/// fitted.
///
/// c depends on the order of the links, on which links there are and on the pins; hardly on the
/// number of vertices, h, k, masses and strain. It is that of one run of a twin, the same sheet
/// with 13 x 13 vertices and a strain of some 1e-3. The twin also says how much more the largest
/// strain is than that of the springs, and what the factor of s misses where s is large. A chain in
/// its order has c = 2, as collapsed_strain().
class StrainAtRest {
 public:
  /// Reasons, a sentence each, why no strain is predicted; empty: it may be, and outside() decides.
  static std::vector<std::string> refuse(const Scene&, const SolverChoice&);
  /// Runs the twin, some 10 ms. Precondition: refuse() has no reason.
  StrainAtRest(const Scene&, const SolverChoice&);
  ~StrainAtRest();

  double correction() const;  ///< c; NaN: the twin did not come to rest

  struct Strain {
    double rms = 0;        ///< of structural and shear links, as the metric stretch.rms
    double largest = 0;    ///< of such a link
    double sag = 0;        ///< m, mean over the weight of how far stretching lowers it
    double s = 0;          ///< share of the slow modes that the sweeps of a substep correct
    double share = 1;      ///< s / (e^s - 1), of links without a spring
    double of_sweeps = 1;  ///< share of the strain (RMS) that more sweeps would take away
    bool found = false;    ///< whether the sheet of springs came to rest
  };
  /// With so many sweeps in a substep and substeps in a step; neither has to be whole.
  Strain at(double sweeps, double substeps);
  /// Strain of springs of K [N/m] in all links, with no solver.
  Strain of_springs(double stiffness);
  /// The K [N/m] of springs in all links that have this RMS strain.
  double stiffness_of(const Strain&);

  /// Reasons, a sentence each, why this strain is outside of what the law holds for.
  std::vector<std::string> outside(const Strain&, double substeps) const;

 private:
  class Twin;
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace taut::reference
