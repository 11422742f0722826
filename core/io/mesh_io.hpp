#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/model/mesh.hpp"

namespace taut {

/// A surface of polygons, as written by a modelling program.
struct Polygons {
  std::string file;                     ///< as the user named it
  std::vector<Vec3> vertices;           ///< [n]
  std::vector<std::vector<int>> faces;  ///< vertices of each face in order around it, three or more
  std::vector<int> vertex_lines;        ///< [n] line of each vertex in the file
  std::vector<int> face_lines;          ///< line of each face in the file
  std::vector<int> numbers;             ///< [n] number of each vertex in the file, from 0
  std::vector<int> welded;              ///< see Mesh::welded
  /// Number of skipped lines by keyword; cloth has nothing that they describe.
  std::map<std::string, int> skipped;
};

/// Reads the `v` and `f` lines of a Wavefront OBJ file. Comments, normals, texture coordinates,
/// groups, materials and the additions of other programs are skipped. Throws InputError, with file
/// and line, for everything malformed, for unknown words, and for everything that cannot be part of
/// a cloth: faces that refer to a vertex that does not exist or to the same vertex twice, cross
/// themselves or have no area; edges of more than two faces; vertices without a face; vertices that
/// coincide.
///
/// Vertices that are at most `weld` apart, in the file's unit, are joined first: each to the first
/// one that stays. A face with two joined vertices is also an error. 0: no vertex is joined.
Polygons read_obj(const std::filesystem::path&, double weld = 0);

/// read_obj() for text in memory; `file` is for messages.
Polygons parse_obj(const std::string& file, const std::string& text, double weld = 0);

/// A body of triangles, for colliders.
struct BodySurface {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  std::vector<int> triangle_lines;  ///< line of each triangle's face in the file
  int inner_faces = 0;              ///< number of faces left out
  std::map<std::string, int> skipped;
};

/// Reads an OBJ file as a body. Faces are cut into triangles as in make_mesh(), coinciding vertices
/// become one, and any number of faces may share an edge. Throws InputError, with file and line,
/// for everything malformed, for faces that refer to a vertex that does not exist or to the same
/// vertex twice, cross themselves or have no area, and for a file without a face.
///
/// `solid`: faces where two solids touch, which lie on each other and look opposite ways, are left
/// out, so that the solids become one. The two sides of a sheet have no other faces at their edges,
/// and stay.
BodySurface read_body_obj(const std::filesystem::path&, bool solid = false);

/// read_body_obj() for text in memory.
BodySurface parse_body_obj(const std::string& file, const std::string& text, bool solid = false);

/// Area of the surface [m^2] if the vertices are in m.
double area(const Polygons&);

/// Makes a cloth of `mass` kg. Faces are cut into triangles: quads along their shorter diagonal,
/// larger ones as a fan, those that are not convex by ears. Lumping::area gives each face's mass to
/// its vertices by thirds of its triangles, averaged over the fans from each of its vertices, so
/// that no diagonal is preferred (a parallelogram gives a quarter to each corner, as in
/// make_sheet).
Mesh make_mesh(const Polygons&, double mass, Lumping);

/// Links of any surface, one family after another, sorted by their vertices within each. Structural
/// links are along the edges, and shear links along both diagonals of the quads. Bend links are
/// across every inner edge, between the vertices that come before and after each of its ends in the
/// two faces (for two triangles: their opposite vertices). No pair is linked twice. A regular sheet
/// of quads gets the links of grid_links.
std::vector<Link> mesh_links(const Polygons&, const LinkChoice&);

}  // namespace taut
