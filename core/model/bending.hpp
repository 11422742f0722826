#pragma once

#include <array>
#include <vector>

#include "core/model/index.hpp"
#include "core/model/scene.hpp"

namespace taut {

/// One component of the second derivative of position over the cloth, sum c_i x_i [1/m], with its
/// energy k/2 |sum c_i x_i|^2. The coefficients add up to 0 and are the same for the three
/// coordinates: with g = sum c_i x_i, the gradient k c_i g is linear and the Hessian k c_i c_j I
/// constant.
struct BendingElement {
  std::size_t size = 0;            ///< number of vertices, 3 to 6
  std::array<int, 6> vertex{};     ///< [size]
  std::array<double, 6> weight{};  ///< [size] c_i [1/m^2]
  double stiffness = 0;            ///< k [N m^3]: bending stiffness times area

  /// sum c_i x_i, computed from differences, which stay exact for nearby positions in float. at(v):
  /// position of vertex v.
  template <class At>
  auto value(const At& at) const {
    const auto first = at(to_index(vertex[0]));
    using Point = std::remove_const_t<decltype(first)>;
    using Real = typename Point::Scalar;
    Point sum = static_cast<Real>(weight[1]) * (at(to_index(vertex[1])) - first);
    for (std::size_t i = 2; i < size; ++i)
      sum += static_cast<Real>(weight[i]) * (at(to_index(vertex[i])) - first);
    return sum;
  }
};

/// Bending elements of a sheet that is flat when nothing bends it, with the thin-plate energy of
/// each coordinate,
///
///     1/2 integral of  B_warp |x_pp|^2 + B_weft |x_tt|^2 + 2 sqrt(B_warp B_weft) |x_pt|^2
///
/// p along the warp, t across it. If no length changes, this is the bending energy of the sheet,
/// because second derivatives are then normal to it (Bergou et al., A Quadratic Bending Model for
/// Inextensible Surfaces, SGP 2006). A strip cut at an angle a to the warp bends with the stiffness
/// 1/(cos^2 a/sqrt(B_warp) + sin^2 a/sqrt(B_weft))^2, since its other two curvatures are free. A
/// strip forced into a cylinder across its length bends with (sqrt(B_warp) cos^2 a + sqrt(B_weft)
/// sin^2 a)^2.
///
/// The second derivatives at a triangle are those of the quadratic through its vertices and the
/// ones beyond its edges, unfolded into its plane: exact for quadratic shapes on any mesh. At the
/// cloth's edge, where no vertex lies beyond, the quadratic that bends least is taken, so the edge
/// carries no moment. (The paper's sum over hinges, 3/(A_1 + A_2) of each, is three times as stiff
/// for a fold along the lines of a grid.) A grid takes the mean of its two triangulations: second
/// differences along its lines at every vertex and a twist in every cell. Equal elements are
/// merged. Empty without scene.bending.
std::vector<BendingElement> make_bending(const Scene&);

/// Bending energy [J] at x.
double bending_energy(const std::vector<BendingElement>&, const std::vector<Vec3>& x);

}  // namespace taut
