#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <type_traits>
#include <vector>

#include "core/model/index.hpp"
#include "core/model/scene.hpp"

namespace taut {

/// Axes of a triangle in its own plane, the first of which is the warp's projection.
struct WarpAxes {
  Vec3 along, across;  ///< unit vectors
  double area = 0;     ///< m^2
};
/// corners: [m], not on a line. The first side stands for a warp that is normal to the triangle.
WarpAxes warp_axes(const std::array<Vec3, 3>& corners, const Vec3& warp);

/// Derivative F of position over the cloth: columns along warp and weft, f1 and f2.
using Deformation = Eigen::Matrix<double, 3, 2>;

/// A triangle of the membrane, in which F is constant.
struct MembraneElement {
  Triangle vertex{};
  double area = 0;                            ///< m^2, at rest
  std::array<Eigen::Vector2d, 3> gradient{};  ///< g_a [1/m] of corner a's shape function

  /// F = sum_a x_a g_a^T, from differences, which stay exact for nearby positions in float. at(v):
  /// position of vertex v.
  template <class At>
  Deformation deformation(const At& at) const {
    const auto first = at(to_index(vertex[0]));
    const Vec3 to_second = (at(to_index(vertex[1])) - first).template cast<double>();
    const Vec3 to_third = (at(to_index(vertex[2])) - first).template cast<double>();
    return to_second * gradient[1].transpose() + to_third * gradient[2].transpose();
  }
};

/// The law of a membrane: energy by area of F, and its derivatives. With the identity's two columns
/// F = R, a rotation, nothing is strained.
///
///     stvk   psi = e.C e/2,         e = ((f1.f1 - 1)/2, (f2.f2 - 1)/2, f1.f2)     Green's strain
///            C = 1/(1 - nu12 nu21) [Y1, nu21 Y1, 0;  nu12 Y2, Y2, 0;  0, 0, G (1 - nu12 nu21)],
///            nu21 = nu12 Y2/Y1 (plane stress; valid while nu12^2 < Y1/Y2)
///     arap   psi = Y/2 |F - R|^2,   R the rotation nearest to F: nu = 0 and G = Y/2 for small
///            strains (Sorkine, Alexa, As-Rigid-As-Possible Surface Modeling, SGP 2007)
///
/// Damping in proportion to stiffness (b [s], stvk) by backward Euler over a step of h, with e_t
/// the strain at its start, is another C and another strain at rest e', as of links
/// (link_damping.hpp):
///
///     e.C e/2 + b (e - e_t).C (e - e_t)/(2 h) = (1 + q) (e - e').C (e - e')/2 + what e does not
///     change,   q = b/h,   e' = q/(1 + q) e_t
class MembraneLaw {
 public:
  /// stiffer: by what C is multiplied.
  explicit MembraneLaw(const Membrane&, double stiffer = 1);

  // `rest` is e' of stvk.
  double energy(const Deformation&, const Vec3& rest = Vec3::Zero()) const;  ///< J/m^2
  /// The strain c with psi = c.C c/2 and its derivatives, of which row k is d c_k/d f_i. It is e
  /// for stvk, and (T11 - 1, T22 - 1, sqrt 2 T12) with F = R T for arap, where C = Y I.
  struct Strain {
    Vec3 value;
    Eigen::Matrix3d by_f1, by_f2;
    /// d c/d x_a [1/m], for the shape gradient of corner a.
    Eigen::Matrix3d by_corner(const Eigen::Vector2d& gradient) const {
      return gradient.x() * by_f1 + gradient.y() * by_f2;
    }
  };
  Strain strain(const Deformation&) const;
  /// The energy's derivative P [N/m].
  Deformation stress(const Deformation&, const Vec3& rest = Vec3::Zero()) const;
  /// The second derivative: `of(i, j)` is d P_i/d f_j [N/m], with (2, 1) the transpose of (1, 2).
  struct Second {
    Eigen::Matrix3d of11, of12, of22;
    /// d force_a/d x_b without the area, for the shape gradients of a and b [N/m^3].
    Eigen::Matrix3d between(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const {
      return a.x() * b.x() * of11 + a.x() * b.y() * of12 + a.y() * b.x() * of12.transpose() +
             a.y() * b.y() * of22;
    }
  };
  /// positive: without what makes it indefinite. That is, for stvk, the negative part of the stress
  /// where it resists turning, and for arap the negative eigenvalues.
  Second second(const Deformation&, bool positive, const Vec3& rest = Vec3::Zero()) const;

  const Eigen::Matrix3d& stiffness() const { return stiffness_; }  ///< C of `strain` [N/m]
  /// Largest resistance to a strain [N/m]: the largest eigenvalue of `second` at rest.
  double stiffest() const;

 private:
  Membrane::Law law_;
  double young_;  ///< N/m, Y of arap
  Eigen::Matrix3d stiffness_;
};

/// The membrane of a scene. Empty without one.
struct MembraneModel {
  MembraneLaw law;
  std::vector<MembraneElement> elements;
  double share = 0;              ///< q/(1 + q)
  std::vector<Vec3> rests = {};  ///< e' of each element in this step; empty: no damping

  bool empty() const { return elements.empty(); }
  double energy(const std::vector<Vec3>& x) const;  ///< J
  std::size_t bytes() const {
    return elements.size() * sizeof elements[0] + rests.size() * sizeof(Vec3);
  }

  /// e' of an element of this membrane.
  Vec3 rest(const MembraneElement& e) const {
    if (rests.empty()) return Vec3::Zero();
    return rests[static_cast<std::size_t>(&e - elements.data())];
  }
  /// Sets e' for a step from these positions.
  template <class At>
  void begin(const At& at) {
    for (std::size_t k = 0; k < rests.size(); ++k)
      rests[k] = share * law.strain(elements[k].deformation(at)).value;
  }

  /// Adds to each corner a bound on the sum of the norms of its row of the second derivative at
  /// rest [N/m].
  void add_stiffness(std::vector<double>& at_vertex) const;

  /// Calls add(vertex, force [N]) for the corners of an element at these positions.
  template <class At, class Add>
  void add_forces(const MembraneElement& e, const At& at, const Add& add) const {
    const Deformation stress = law.stress(e.deformation(at), rest(e));
    for (std::size_t a = 0; a < 3; ++a)
      add(to_index(e.vertex[a]), Vec3(-e.area * (stress * e.gradient[a])));
  }
  /// Calls add(a, b, block [N/m]) for each pair of corners of an element, of which only one order
  /// is visited: the energy's second derivative by their positions.
  template <class At, class Add>
  void add_second(const MembraneElement& e, const At& at, bool positive, const Add& add) const {
    const MembraneLaw::Second second = law.second(e.deformation(at), positive, rest(e));
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b <= a; ++b)
        add(to_index(e.vertex[a]), to_index(e.vertex[b]),
            Eigen::Matrix3d(e.area * second.between(e.gradient[a], e.gradient[b])));
  }
};

/// One element for each triangle of the mesh with a vertex that ever moves.
MembraneModel make_membrane(const Scene&);
/// The same with its damping, in steps of h [s]: begin() starts each.
MembraneModel make_membrane(const Scene&, double h);

/// The membrane that a rectangular grid of springs is for small strains, away from its edges.
/// k: N/m by family; cells of a along u and b along v, d^2 = a^2 + b^2:
///
///     C_uu = k_s a/b + 2 k_d a^3/(b d^2) + 4 k_b a/b,    C_uv = G = 2 k_d a b/d^2
///
/// Its warp is v. A row of links along an edge is a whole one for half a row of cells, so a sheet
/// of 8 cells is up to 12 % stiffer. Empty without a rectangular grid or with a rigid family,
/// without shear links (the net has no G) or where links are missing.
std::optional<Membrane> membrane_of_links(const Scene&,
                                          const std::array<double, kFamilies.size()>& stiffness);

/// Largest |poisson| that has an energy for these stiffnesses: sqrt(warp/weft), which is excluded.
double most_poisson(const Membrane&);

}  // namespace taut
