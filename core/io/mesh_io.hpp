#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/model/mesh.hpp"

namespace taut {

/// A surface of polygons, as a modelling program writes it.
struct Polygons {
  std::string file;                     ///< as the user named it
  std::vector<Vec3> vertices;           ///< [n]
  std::vector<std::vector<int>> faces;  ///< vertices of each face in order round it, three or more
  std::vector<int> vertex_lines;        ///< [n] where each vertex stands in the file
  std::vector<int> face_lines;          ///< the same of each face
  std::vector<int> numbers;             ///< [n] of each vertex in the file, from 0
  std::vector<int> welded;              ///< as Mesh::welded
  /// Number of skipped lines by keyword, of those whose content a cloth does not have.
  std::map<std::string, int> skipped;
};

/// Reads the `v` and `f` lines of a Wavefront OBJ file; comments, normals, texture coordinates,
/// groups and materials are skipped, and so are the additions of other programs. Throws InputError
/// with file and line of everything that is malformed, of unknown words, and of everything that
/// cannot be part of a cloth: faces that name a vertex which is not there, name one twice, cross
/// themselves or have no area; edges of more than two faces; vertices without a face; vertices that
/// coincide.
///
/// Before that it joins vertices that are at most `weld` apart, in the file's unit: each to the
/// first one that stays. A face with two joined vertices is an error, too. 0: no vertex is joined.
Polygons read_obj(const std::filesystem::path&, double weld = 0);

/// The same for text that is already in memory; `file` is for the messages.
Polygons parse_obj(const std::string& file, const std::string& text, double weld = 0);

/// A body of triangles, as colliders have it.
struct BodySurface {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  std::vector<int> triangle_lines;  ///< where the face of each stands in the file
  std::map<std::string, int> skipped;
};

/// Reads such a file as a body: faces are cut into triangles as make_mesh() cuts them, coinciding
/// vertices become one, and any number of faces may share an edge. Throws InputError with file
/// and line of everything that is malformed, of faces that name a vertex which is not there or one
/// twice, cross themselves or have no area, and of a file without a face.
BodySurface read_body_obj(const std::filesystem::path&);

/// The same for text that is already in memory.
BodySurface parse_body_obj(const std::string& file, const std::string& text);

/// Area of the surface [m^2] if the vertices are in m.
double area(const Polygons&);

/// The cloth of `mass` kg. Faces are cut into triangles: quads along their shorter diagonal, larger
/// ones as a fan, those that are not convex by ears. Lumping::area gives each face's mass to its
/// vertices by the thirds of its triangles, averaged over the fans from each of its vertices, so
/// that no diagonal is preferred (a parallelogram gives a quarter to each corner, as in
/// make_sheet).
Mesh make_mesh(const Polygons&, double mass, Lumping);

/// Links of any surface, families one after the other, sorted by their vertices within each:
/// structural along the edges; shear along both diagonals of the quads; bend across every inner
/// edge, between the vertices that come before and after each of its ends in the two faces (for two
/// triangles: their opposite vertices). No pair is linked twice. A regular sheet of quads gets the
/// links of grid_links.
std::vector<Link> mesh_links(const Polygons&, const LinkChoice&);

}  // namespace taut
