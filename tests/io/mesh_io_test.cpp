// Cloth from OBJ files: the same cloth as a grid if both describe the same, and a place for every
// error.
#include "core/io/mesh_io.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <locale>
#include <map>
#include <numeric>
#include <set>
#include <sstream>
#include <tuple>

#include "core/io/scene_io.hpp"
#include "core/model/index.hpp"
#include "core/model/input_error.hpp"
#include "core/model/text.hpp"

namespace taut::mesh_io_test {
namespace {

/// The sheet's quads as an OBJ file with all digits.
std::string as_obj(const Mesh& sheet) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(17);
  for (const Vec3& x : sheet.rest) out << "v " << x[0] << ' ' << x[1] << ' ' << x[2] << '\n';
  const Grid g = *sheet.grid;
  for (int j = 0; j + 1 < g.nv; ++j)
    for (int i = 0; i + 1 < g.nu; ++i)
      out << "f " << g.index(i, j) + 1 << "//1 " << g.index(i, j + 1) + 1 << "/2 "
          << g.index(i + 1, j + 1) + 1 << "/2/1 " << g.index(i + 1, j) + 1 << '\n';
  return out.str();
}

using LinkKey = std::tuple<Family, int, int>;
std::map<LinkKey, double> as_set(const std::vector<Link>& links) {
  std::map<LinkKey, double> set;
  for (const Link& l : links)
    EXPECT_TRUE(
        set.emplace(LinkKey{l.family, std::min(l.a, l.b), std::max(l.a, l.b)}, l.rest).second)
        << "linked twice: " << l.a << " " << l.b;
  return set;
}

std::string errors_of(const std::string& obj) {
  std::string all;
  try {
    parse_obj("x.obj", obj);
  } catch (const InputError& error) {
    all = error.what();
  }
  return all;
}

TEST(MeshFromObj, AGridWrittenAsQuadsIsTheSameCloth) {
  for (const auto& [nu, nv] : {std::pair{2, 2}, {5, 4}, {7, 13}, {2, 9}}) {
    const SheetShape shape{.nu = nu, .nv = nv, .width = 1.5, .height = 0.7, .mass = 0.3};
    const Mesh sheet = make_sheet(shape);
    const Polygons polygons = parse_obj("sheet.obj", as_obj(sheet));
    const Mesh mesh = make_mesh(polygons, shape.mass, shape.lumping);
    ASSERT_EQ(mesh.size(), sheet.size());
    for (std::size_t v = 0; v < sheet.rest.size(); ++v) {
      EXPECT_EQ(mesh.rest[v], sheet.rest[v]);
      EXPECT_NEAR(mesh.mass[v], sheet.mass[v], 1e-15);
    }
    EXPECT_EQ(mesh.triangles.size(), sheet.triangles.size());
    const LinkChoice all{.structural = true, .shear = true, .bend = true};
    EXPECT_EQ(as_set(mesh_links(polygons, all)), as_set(grid_links(sheet, all)));
  }
}

TEST(MeshFromObj, StructuralAndBendLinksComeInTheOrderOfTheGrid) {
  const Mesh sheet = make_sheet({.nu = 6, .nv = 5, .width = 1, .height = 1, .mass = 1});
  const Polygons polygons = parse_obj("sheet.obj", as_obj(sheet));
  for (const LinkChoice choice : {LinkChoice{true, false, false}, LinkChoice{false, false, true}}) {
    const auto a = mesh_links(polygons, choice), b = grid_links(sheet, choice);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k)
      EXPECT_EQ(std::pair(a[k].a, a[k].b), std::pair(b[k].a, b[k].b));
  }
}

TEST(MeshFromObj, TwoTrianglesBendAcrossTheirEdge) {
  const Polygons p = parse_obj("x.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nf 1 2 3\nf 2 4 3\n");
  const auto links = mesh_links(p, {.structural = true, .shear = true, .bend = true});
  ASSERT_EQ(links.size(), 6u);  // five edges, no quad, one pair of vertices opposite an edge
  EXPECT_EQ(links[5].family, Family::bend);
  EXPECT_EQ(std::pair(links[5].a, links[5].b), std::pair(0, 3));
  EXPECT_DOUBLE_EQ(links[5].rest, std::sqrt(3.0));
}

TEST(MeshFromObj, NoPairIsLinkedTwiceWhereThreeQuadsMeet) {
  // The corner of a cube: vertex 0 is the corner, 1, 2 and 3 are its neighbours. Across the edge
  // 0-1, vertices 2 and 3 are opposite, but they are also a diagonal of the third quad.
  const std::vector<std::string> vertices{"v 0 0 0\n", "v 1 0 0\n", "v 0 1 0\n", "v 0 0 1\n",
                                          "v 1 1 0\n", "v 0 1 1\n", "v 1 0 1\n"};
  for (std::size_t shift = 0; shift < 7; ++shift) {  // for every numbering of the vertices
    std::string text;
    for (std::size_t v = 0; v < 7; ++v) text += vertices[(v + shift) % 7];
    for (const std::array<std::size_t, 4>& face :
         {std::array<std::size_t, 4>{0, 1, 4, 2}, {0, 2, 5, 3}, {0, 3, 6, 1}}) {
      text += 'f';
      for (const std::size_t v : face) text += ' ' + std::to_string((v + 7 - shift) % 7 + 1);
      text += '\n';
    }
    const Polygons p = parse_obj("x.obj", text);
    const auto links = mesh_links(p, {.structural = true, .shear = true, .bend = true});
    std::set<std::pair<int, int>> pairs;
    for (const Link& l : links) EXPECT_TRUE(l.a < l.b && pairs.emplace(l.a, l.b).second) << shift;
    EXPECT_EQ(as_set(links).size(), 9u + 6u + 3u);
    EXPECT_EQ(mesh_links(p, {.structural = false, .shear = false, .bend = true}).size(), 6u);
  }
}

TEST(MeshFromObj, QuadsAreCutAlongTheirShorterDiagonal) {
  const Polygons p = parse_obj("x.obj",
                               "v 0 0 0\nv 1 0 0\nv 2 2 0\nv 0 1 0\nv -1 0 0\n"
                               "f 1 2 3 4\nf 1 4 5\n");
  EXPECT_DOUBLE_EQ(area(p), 2.5);
  const Mesh mesh = make_mesh(p, 5, Lumping::area);
  EXPECT_EQ(mesh.triangles[0], (Triangle{1, 2, 3}));  // 2-4 is 1.41 m long, 1-3 is 2.83 m
  EXPECT_EQ(mesh.triangles[1], (Triangle{1, 3, 0}));
  EXPECT_DOUBLE_EQ(mesh.mass[4], 5 * (0.5 / 3) / 2.5);
}

TEST(MeshFromObj, TheShorterDiagonalCutsAQuad) {
  const std::string far =
      "v 10 7 0\nv 11 7 0\nv 12 9 0\nv 10 8 0\n";  // 2-4 is the shorter diagonal
  const std::vector<Triangle> cut{{1, 2, 3}, {1, 3, 0}};
  for (const char* from : {"f 1 2 3 4\n", "f 2 3 4 1\n"})
    EXPECT_EQ(make_mesh(parse_obj("x.obj", far + from), 1, Lumping::area).triangles, cut) << from;
  const std::string square = "v 10 7 0\nv 11 7 0\nv 11 8 0\nv 10 8 0\nf 1 2 3 4\n";
  EXPECT_EQ(make_mesh(parse_obj("x.obj", square), 1, Lumping::area).triangles,
            (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
}

TEST(MeshFromObj, EachTriangleGivesAThirdToItsCorners) {
  const Polygons p = parse_obj("x.obj", "v 0 0 0\nv 2 0 0\nv 0 2 0\nv -4 0 0\nf 1 2 3\nf 1 3 4\n");
  EXPECT_DOUBLE_EQ(area(p), 6);
  const Mesh mesh = make_mesh(p, 6, Lumping::area);
  const double expected[] = {2, 2.0 / 3, 2, 4.0 / 3};
  for (std::size_t v = 0; v < 4; ++v) EXPECT_NEAR(mesh.mass[v], expected[v], 1e-15);
  EXPECT_EQ(make_mesh(p, 6, Lumping::equal).mass, std::vector<double>(4, 1.5));
}

std::string vertices_of(const std::vector<Vec3>& corners) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(17);
  for (const Vec3& x : corners) out << "v " << x[0] << ' ' << x[1] << ' ' << x[2] << '\n';
  return out.str();
}

/// The outline as one face, starting at each of its corners in turn, in both directions, with the
/// vertices listed in the order of the face or of the outline.
std::vector<Polygons> every_way_round(const std::vector<Vec3>& outline) {
  const std::size_t n = outline.size();
  std::vector<Polygons> all;
  for (std::size_t first = 0; first < n; ++first)
    for (const bool back : {false, true}) {
      std::vector<Vec3> turned;
      std::string in_order = "f", of_outline = "f";
      for (std::size_t k = 0; k < n; ++k) {
        const std::size_t at = back ? (first + n - k) % n : (first + k) % n;
        turned.push_back(outline[at]);
        in_order += ' ' + std::to_string(k + 1);
        of_outline += ' ' + std::to_string(at + 1);
      }
      all.push_back(parse_obj("x.obj", vertices_of(turned) + in_order + '\n'));
      all.push_back(parse_obj("x.obj", vertices_of(outline) + of_outline + '\n'));
    }
  return all;
}

// The area follows from the outline (shoelace formula). Each corner's mass does not depend on the
// corner where the face starts.
TEST(MeshFromObj, AConcaveFaceIsCutWithinItsOutline) {
  struct Shape {
    std::vector<Vec3> outline;
    double area;
  };
  const std::vector<Shape> shapes{
      {{{0, 0, 0}, {2, 0, 0}, {2, 0, 1}, {1, 0, 1}, {1, 0, 2}, {0, 0, 2}}, 3},  // an L
      {{{0, 0, 0}, {1, 0, 0}, {0.25, 0, 0.25}, {0, 0, 1}}, 0.25},               // a dart
      {{{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {2, 3, 0}, {2, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}}, 7},
      {{{0, 0, 0}, {2, 0, 0}, {2, 0, 0.5}, {2, 0, 1}, {1, 0, 1}, {1, 0, 2}, {0, 0, 2}}, 3}};
  for (const Shape& shape : shapes) {
    std::map<std::array<double, 3>, double> mass_at;
    for (const Polygons& p : every_way_round(shape.outline)) {
      EXPECT_NEAR(area(p), shape.area, 1e-12);
      const Mesh mesh = make_mesh(p, 3, Lumping::area);
      EXPECT_EQ(mesh.triangles.size(), shape.outline.size() - 2);
      double covered = 0;
      for (const auto& [a, b, c] : mesh.triangles)
        covered += (mesh.rest[to_index(b)] - mesh.rest[to_index(a)])
                       .cross(mesh.rest[to_index(c)] - mesh.rest[to_index(a)])
                       .norm() /
                   2;
      EXPECT_NEAR(covered, shape.area, 1e-12) << "triangles reach out of the face";
      for (std::size_t v = 0; v < mesh.rest.size(); ++v) {
        const Vec3& x = mesh.rest[v];
        const auto [at, fresh] = mass_at.emplace(std::array{x[0], x[1], x[2]}, mesh.mass[v]);
        EXPECT_NEAR(at->second, mesh.mass[v], 1e-12) << "depends on where the face begins";
      }
    }
    EXPECT_EQ(mass_at.size(), shape.outline.size());
  }
}

TEST(MeshFromObj, AFaceThatCrossesItselfIsRefused) {
  const std::string said =
      ": the outline of the face crosses or touches itself: it has to go once round an area";
  EXPECT_EQ(errors_of("v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nf 1 2 3 4\n"), "x.obj:5:1" + said)
      << "a crossed quad";
  std::string star;  // a star of five corners that winds around twice
  for (const int k : {0, 2, 4, 1, 3})
    star += "v " + shortest(std::cos(1.2566370614 * k)) + " " +
            shortest(std::sin(1.2566370614 * k)) + " 0\n";
  EXPECT_EQ(errors_of(star + "f 1 2 3 4 5\n"), "x.obj:6:1" + said);
  EXPECT_EQ(errors_of("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nf 1 2 3 4\n"),
            "x.obj:5:1: the face has no area");
}

TEST(MeshFromObj, WhatOtherProgramsAddIsSkippedAndCounted) {
  const std::string sheet = "v 0 0 0\nvv 0 0 0\nny 0 0 0\nv 1 0 0\nvv 0 0 0\nv 0 1 0\n";
  const Polygons p = parse_obj("x.obj", sheet +
                                            "nv 0\nvl 1\ne 1 2\nea 0\ned 0\ntl 1\nadje 0\nadjf 0\n"
                                            "stitch 1 2\nl 1 2\np 1\nmg 1\nlod 1\nusemap x\nvt 0\n"
                                            "bevel on\nc_interp on\nd_interp on\nshadow_obj x\n"
                                            "trace_obj x\n"
                                            "f 1 2 3\n");
  EXPECT_EQ(p.faces.size(), 1u);
  EXPECT_EQ(p.skipped.size(), 21u);
  EXPECT_EQ(p.skipped.at("vv"), 2);
  EXPECT_EQ(errors_of(sheet + "vvv 1\nf 1 2 3\n"),
            "x.obj:7:1: 'vvv' is not read: a cloth is made of 'v' and 'f' lines");
}

TEST(MeshFromObj, ALineMayBeContinuedAndBeginWithAByteOrderMark) {
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_EQ(parse_obj("x", "\xEF\xBB\xBF" + v + "f 1 \\\n2\\\r\n 3\n").faces[0],
            (std::vector{0, 1, 2}));
  EXPECT_EQ(parse_obj("x", "v 0 0 \\\n0\n# of a folder C:\\\nv 1 0 0\nv 0 1 0\nf 1 2 3\\")
                .vertices.size(),
            3u);
  EXPECT_EQ(errors_of(v + "f 1 \\\n 2 x\nf 1 2 3\n"), "x.obj:5:4: 'x' is not a vertex number");
}

TEST(MeshFromObj, NegativeNumbersCountBack) {
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_EQ(parse_obj("x", v + "f -3 -2 -1\n").faces[0], (std::vector{0, 1, 2}));
  EXPECT_EQ(parse_obj("x", "f 1 2 3 # first\r\n" + v).faces[0], (std::vector{0, 1, 2}));
}

TEST(MeshFromObj, FlawsOfTheTextAreNamedWithLineAndColumn) {
  EXPECT_EQ(errors_of("v 0 0 0\nv 1 0\nv 1 1 nan\nf 1 2 3\nf 0 1 2\nf 1 2\nf 1 1 2\nf 1 x 2\n"
                      "f 1 2 9\nf -9 1 2\nline 1\n"),
            "x.obj:2:1: a vertex needs three coordinates\n"
            "x.obj:3:7: 'nan' is not a coordinate: a finite number within 1e9\n"
            "x.obj:4:1: the face names vertex 3, but there are 2\n"
            "x.obj:5:3: vertices are numbered from 1; 0 names none\n"
            "x.obj:6:1: a face needs three vertices at least\n"
            "x.obj:7:1: the face names vertex 1 twice\n"
            "x.obj:8:5: 'x' is not a vertex number\n"
            "x.obj:9:1: the face names vertex 9, but there are 2\n"
            "x.obj:10:3: the face names vertex -9, but there are 2 before it\n"
            "x.obj:11:1: 'line' is not read: a cloth is made of 'v' and 'f' lines");
}

TEST(MeshFromObj, SurfacesThatNoClothHasAreNamed) {
  EXPECT_EQ(errors_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nv 2 0 0\nv 0 0 1\nv 9 9 9\n"
                      "f 1 2 3\nf 1 2 4\nf 1 2 5\nf 1 2 6\nf 2 3 7\n"),
            "x.obj:7:1: vertex 7 coincides with vertex 4 (line 4): a cloth is one surface, so join "
            "them, or let `weld` in [cloth] do it\n"
            "x.obj:8:1: vertex 8 belongs to no face\n"
            "x.obj:11:1: the edge from vertex 1 to 2 has 4 faces; a cloth has two at most\n"
            "x.obj:12:1: the face has no area");
  EXPECT_EQ(errors_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nf 1 2 3\nf 1 2 4\nf 2 1 5\n"),
            "x.obj:8:1: the edge from vertex 1 to 2 has 3 faces; a cloth has two at most");
  EXPECT_EQ(errors_of(""), "x.obj:1:1: no face: a cloth needs one at least");
  EXPECT_THROW(read_obj("no/such.obj"), InputError);
}

TEST(MeshFromObj, AHopelessFileDoesNotFloodTheTerminal) {
  std::string obj;
  for (int i = 0; i < 1000; ++i) obj += "f 0 0 0\n";
  const std::string text = errors_of(obj);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 100);
  EXPECT_NE(text.find("900 more errors"), std::string::npos);
}

TEST(MeshFromObj, TheShippedDiscIsTurnedScaledAndMoved) {
  const auto disc = std::filesystem::path(TAUT_SOURCE_DIR) / "experiments/scenes/disc.toml";
  const Scene flat = load_scene(disc, {"cloth.scale=2", "cloth.pins=[0]"});
  EXPECT_EQ(flat.mesh.size(), 217);
  EXPECT_EQ(flat.mesh.rest[0], Vec3(0, 0.45, 0));
  EXPECT_EQ(flat.pins, std::vector{0});
  const double mass = std::accumulate(flat.mesh.mass.begin(), flat.mesh.mass.end(), 0.0);
  // a circle of radius 1 m without what its 48 chords cut off
  EXPECT_NEAR(mass, 0.2 * 3.14159, 0.002);
  const Scene upright = load_scene(
      disc, {"cloth.rotation={ axis = [1, 0, 0], angle = 90 }", "cloth.start_inside=\"resolve\""});
  EXPECT_EQ(upright.mesh.size(), 217);
  for (const Vec3& x : upright.mesh.rest) EXPECT_NEAR(x.z(), 0, 1e-15);
  EXPECT_THROW(load_scene(disc, {"cloth.size=[1, 1]"}), InputError);
  EXPECT_THROW(load_scene(disc, {"cloth.pins=[\"top\"]"}), InputError);
  EXPECT_THROW(load_scene(disc, {"cloth.mesh=\"nowhere.obj\""}), InputError);
}

}  // namespace
}  // namespace taut::mesh_io_test
