#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "core/model/vec3.hpp"

namespace taut {

using Triangle = std::array<int, 3>;

/// Vertices of a regular sheet: (i, j) is vertex j * nu + i.
///
///     (0,0) --u--> (nu-1, 0)      pins of a hanging sheet are usually (0, 0) and (nu-1, 0)
///       |
///       v
///     (0, nv-1)
struct Grid {
  int nu = 0;
  int nv = 0;
  int index(int i, int j) const { return j * nu + i; }
  int size() const { return nu * nv; }
};

/// The material: shape at rest, connectivity and mass. Fixes the vertex order for every solver.
struct Mesh {
  std::vector<Vec3> rest;           ///< [n] m
  std::vector<Triangle> triangles;  ///< vertex triples; wind, face contact and pictures use them
  std::vector<double> mass;         ///< [n] kg, > 0, pinned vertices included
  std::optional<Grid> grid;         ///< set if the vertices form a regular sheet
  /// [vertices of the file] vertex that each became, where `cloth.weld` joined some; otherwise
  /// empty. Vertex numbers in a scene's file refer to the file's vertices. Not part of what is
  /// simulated.
  std::vector<int> welded;

  int size() const { return static_cast<int>(rest.size()); }
};

/// The three families of springs (Provot 1995; Lander 1999; Vasilovici).
enum class Family { structural, shear, bend };
inline constexpr std::array kFamilies{Family::structural, Family::shear, Family::bend};
std::string_view to_string(Family);

/// Keeps vertices a and b at distance rest [m].
struct Link {
  int a = 0;
  int b = 0;
  double rest = 0;
  Family family = Family::structural;
};
/// Rest length of a seam, which draws two vertices together [m]: 0, except that solvers divide by
/// it. A seam is a structural link and has no strain.
inline constexpr double kSeamRest = 1e-18;
inline bool is_seam(const Link& link) { return link.rest == kSeamRest; }

/// How the mass of a sheet is divided among its vertices.
enum class Lumping {
  area,  ///< a quarter of each quad (half of each segment of a chain): edges weigh half
  equal  ///< the same for every vertex
};

/// A rectangular sheet of nu x nv vertices, flat at rest: vertex (i, j) is at origin +
/// i/(nu-1) * width * u + j/(nv-1) * height * v. One column (nu = 1) is a chain.
struct SheetShape {
  int nu = 0, nv = 0;            ///< >= 1 each, at least two vertices in all
  double width = 0, height = 0;  ///< m along u and v
  Vec3 origin = Vec3::Zero();    ///< m
  Vec3 u = Vec3::UnitX();        ///< unit
  Vec3 v = -Vec3::UnitY();       ///< unit
  double mass = 0;               ///< kg in total
  Lumping lumping = Lumping::area;
};

/// Makes the sheet's mesh. Quads are split along alternating diagonals, so that no direction is
/// preferred.
Mesh make_sheet(const SheetShape&);

/// The families of links to derive from a mesh.
struct LinkChoice {
  bool structural = true;
  bool shear = false;
  bool bend = false;
};

/// Links of a grid, in the order in which Gauss-Seidel visits them: one family after another, and
/// within a family vertex by vertex in row order, first along u, then along v (shear: down-right,
/// then down-left; bend: every second vertex). The links of a chain thus run from its first vertex
/// to its last.
std::vector<Link> grid_links(const Mesh&, const LinkChoice&);

}  // namespace taut
