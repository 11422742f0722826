#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/model/scene.hpp"

namespace taut::reference {

/// Rest of a cloth of springs under gravity, with a stiffness for each link: m g and the pulls K C
/// u of its links cancel at every vertex that moves. Nothing but gravity, pins and links acts.
class RestingSprings {
 public:
  explicit RestingSprings(const Scene&);  ///< a copy is kept
  ~RestingSprings();

  struct Rest {
    std::vector<Vec3> x;          ///< [n] m
    std::vector<double> tension;  ///< [links] N, > 0: pulls; 0 between two pins
    double unbalanced = 0;        ///< RMS force left on a vertex, over the RMS weight of one
    int solves = 0;               ///< linear systems solved, on this sheet
    bool found = false;           ///< whether `unbalanced` is small enough for the strains
  };
  /// stiffness: [links] N/m, > 0. load: [n] the weight of each vertex is that many times its own;
  /// empty: once.
  ///
  /// Newton's method with kept tensions: a link resists sideways motion by the tension that follows
  /// from the last linear system, not by that of an iterate, which for large K is mostly error
  /// (core/solver/newton/kept_tensions.hpp). M/h^2 is added with h growing, so that a sheet without
  /// tension, or one that shears freely, has a definite matrix. A grid starts at the rest of a grid
  /// of half its links along each side. If `near` is given, it starts there.
  Rest rest(std::span<const double> stiffness, const Rest* near = nullptr,
            std::span<const double> load = {});

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

/// The sheet with nu x nv vertices: the same size, pins, start, families of links and total mass,
/// and masses in the same proportions. Precondition: the cloth is a grid, and nu, nv are at least 2
/// where the scene's are, and at most the scene's.
Scene coarse_sheet(const Scene&, int nu, int nv);

}  // namespace taut::reference
