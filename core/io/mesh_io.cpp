// Surfaces of polygons: reading and checking OBJ files, and making meshes and links of them.
#include "core/io/mesh_io.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include "core/io/face.hpp"
#include "core/io/obj_lines.hpp"
#include "core/io/text_file.hpp"
#include "core/model/index.hpp"
#include "core/model/input_error.hpp"
#include "core/model/text.hpp"

namespace taut {

namespace {

/// Collects the errors of a surface, without flooding the terminal for a hopeless file.
class SurfaceErrors {
 public:
  explicit SurfaceErrors(std::string file) : file_(std::move(file)) {}
  void report(int line, const std::string& message, int column = 1) {
    found_.push_back({file_, line, column, message});
  }
  /// Throws InputError with the first hundred errors, in the order of the file, if there are any.
  void throw_if_any() {
    if (found_.empty()) return;
    std::ranges::stable_sort(found_, {},
                             [](const Diagnostic& d) { return std::pair(d.line, d.column); });
    constexpr std::size_t kMost = 100;
    if (found_.size() > kMost) {
      const std::string more = std::to_string(found_.size() - kMost) + " more errors";
      found_.resize(kMost);
      found_.push_back({file_, 0, 0, more});
    }
    throw InputError(found_);
  }

 private:
  std::string file_;
  std::vector<Diagnostic> found_;
};

/// An edge and its faces; a < b.
struct Edge {
  int a = 0, b = 0;
  std::vector<int> faces;
};

Face face_of(const Polygons& p, const std::vector<int>& face) {
  std::vector<Vec3> corners;
  corners.reserve(face.size());
  for (const int v : face) corners.push_back(p.vertices[to_index(v)]);
  return Face(std::move(corners));
}

double triangle_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (b - a).cross(c - a).norm() / 2;
}

/// Share of each vertex in the area of a face: a third of every triangle whose corner it is,
/// averaged over the fans from each vertex; for a face that is not convex, in the triangles of its
/// ears.
std::vector<double> shares(const Polygons& p, const std::vector<int>& face) {
  const std::size_t n = face.size();
  std::vector<double> share(n, 0.0);
  const auto add = [&](const std::array<std::size_t, 3>& corners, double fans) {
    const double third = triangle_area(p.vertices[to_index(face[corners[0]])],
                                       p.vertices[to_index(face[corners[1]])],
                                       p.vertices[to_index(face[corners[2]])]) /
                         3;
    for (const std::size_t corner : corners) share[corner] += third / fans;
  };
  if (n > 3)
    if (const Face shape = face_of(p, face); !shape.convex()) {
      for (const auto& triangle : shape.triangles()) add(triangle, 1);
      return share;
    }
  const double fans = n == 3 ? 1 : static_cast<double>(n);
  for (std::size_t apex = 0; apex < (n == 3 ? 1 : n); ++apex)
    for (std::size_t k = 1; k + 1 < n; ++k) add({apex, (apex + k) % n, (apex + k + 1) % n}, fans);
  return share;
}

double face_area(const Polygons& p, const std::vector<int>& face) {
  const auto share = shares(p, face);
  return std::accumulate(share.begin(), share.end(), 0.0);
}

std::string number(const Polygons& p, int vertex) {  // counted as in OBJ
  return std::to_string(p.numbers[to_index(vertex)] + 1);
}

/// Whether the corners of a face are not all on one line.
bool is_spread(const Polygons& p, const std::vector<int>& face) {
  double largest = 0, longest2 = 0;
  const Vec3& first = p.vertices[to_index(face[0])];
  for (std::size_t k = 1; k < face.size(); ++k) {
    const Vec3 &a = p.vertices[to_index(face[k])],
               &b = p.vertices[to_index(face[(k + 1) % face.size()])];
    largest = std::max(largest, triangle_area(first, a, b));
    longest2 = std::max({longest2, (a - first).squaredNorm(), (b - a).squaredNorm()});
  }
  return largest > 1e-9 * longest2;
}

void judge_faces(const Polygons& p, SurfaceErrors& errors) {
  for (std::size_t f = 0; f < p.faces.size(); ++f) {
    double longest2 = 0;
    for (std::size_t k = 0; k < p.faces[f].size(); ++k) {
      const Vec3& a = p.vertices[to_index(p.faces[f][k])];
      const Vec3& b = p.vertices[to_index(p.faces[f][(k + 1) % p.faces[f].size()])];
      longest2 = std::max(longest2, (b - a).squaredNorm());
    }
    if (p.faces[f].size() > 3 && is_spread(p, p.faces[f]) &&
        face_of(p, p.faces[f]).crosses_itself())
      errors.report(
          p.face_lines[f],
          "the outline of the face crosses or touches itself: it has to go once round an area");
    else if (!(face_area(p, p.faces[f]) > 1e-9 * longest2))
      errors.report(p.face_lines[f], "the face has no area");
  }
}

void judge_vertices(const Polygons& p, SurfaceErrors& errors) {
  std::vector<bool> used(p.vertices.size());
  for (const auto& face : p.faces)
    for (const int v : face) used[to_index(v)] = true;
  for (std::size_t v = 0; v < used.size(); ++v)
    if (!used[v])
      errors.report(p.vertex_lines[v],
                    "vertex " + number(p, static_cast<int>(v)) + " belongs to no face");
  std::map<std::array<double, 3>, int> seen;
  for (int v = 0; v < static_cast<int>(p.vertices.size()); ++v) {
    const Vec3& x = p.vertices[to_index(v)];
    const auto [first, added] = seen.emplace(std::array{x[0] + 0, x[1] + 0, x[2] + 0}, v);
    if (!added)
      errors.report(p.vertex_lines[to_index(v)],
                    "vertex " + number(p, v) + " coincides with vertex " +
                        number(p, first->second) + " (line " +
                        std::to_string(p.vertex_lines[to_index(first->second)]) +
                        "): a cloth is one surface, so join them, or let `weld` in [cloth] do it");
  }
}

/// The edges, sorted by a, then b; faces in their order.
std::vector<Edge> edges_of(const Polygons& p) {
  std::vector<std::array<int, 3>> sides;  // a, b, face
  for (std::size_t f = 0; f < p.faces.size(); ++f)
    for (std::size_t k = 0; k < p.faces[f].size(); ++k) {
      const int a = p.faces[f][k], b = p.faces[f][(k + 1) % p.faces[f].size()];
      sides.push_back({std::min(a, b), std::max(a, b), static_cast<int>(f)});
    }
  std::sort(sides.begin(), sides.end());
  std::vector<Edge> edges;
  for (const auto& [a, b, face] : sides) {
    if (edges.empty() || edges.back().a != a || edges.back().b != b) edges.push_back({a, b, {}});
    edges.back().faces.push_back(face);
  }
  return edges;
}

/// Reports faces without area, edges of more than two faces, vertices without a face and vertices
/// that coincide. Precondition: every face refers to vertices that exist.
void judge_surface(const Polygons& p, SurfaceErrors& errors) {
  if (p.faces.empty()) return errors.report(1, "no face: a cloth needs one at least");
  judge_vertices(p, errors);
  judge_faces(p, errors);
  for (const Edge& edge : edges_of(p))
    if (edge.faces.size() > 2)
      errors.report(p.face_lines[to_index(edge.faces[2])],
                    "the edge from vertex " + number(p, edge.a) + " to " + number(p, edge.b) +
                        " has " + std::to_string(edge.faces.size()) +
                        " faces; a cloth has two at most");
}

/// The neighbour of vertex `of` in the face that is not `other`, its neighbour on the other side.
int beside(const std::vector<int>& face, int of, int other) {
  const auto n = face.size();
  const auto k = static_cast<std::size_t>(std::find(face.begin(), face.end(), of) - face.begin());
  const int before = face[(k + n - 1) % n], after = face[(k + 1) % n];
  return before == other ? after : before;
}

/// For each vertex, the first vertex at the same position.
std::vector<int> first_at_each_place(const std::vector<Vec3>& vertices) {
  std::vector<int> sorted(vertices.size()), first(vertices.size());
  std::iota(sorted.begin(), sorted.end(), 0);
  const auto place = [&](int v) {
    const Vec3& x = vertices[to_index(v)];
    return std::array{x[0], x[1], x[2]};
  };
  std::ranges::stable_sort(sorted, {}, place);
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    const bool same = k > 0 && place(sorted[k]) == place(sorted[k - 1]);
    first[to_index(sorted[k])] = same ? first[to_index(sorted[k - 1])] : sorted[k];
  }
  return first;
}

/// For each vertex, the first vertex within `reach` that stays, or itself if no vertex does.
/// Vertices that stay are kept in cells of size `reach`, and each vertex searches the cells around
/// its own.
std::vector<int> joined(const std::vector<Vec3>& x, double reach) {
  using Cell = std::array<std::int64_t, 3>;
  const auto cell = [&](const Vec3& at, Eigen::Index axis) {
    return static_cast<std::int64_t>(std::floor(at[axis] / reach));
  };
  std::map<Cell, std::vector<int>> staying;
  std::vector<int> to(x.size());
  for (int v = 0; v < static_cast<int>(x.size()); ++v) {
    const Vec3& at = x[to_index(v)];
    const Cell own{cell(at, 0), cell(at, 1), cell(at, 2)};
    int first = v;
    for (std::int64_t k = 0; k < 27; ++k) {
      const auto found =
          staying.find({own[0] + k % 3 - 1, own[1] + k / 3 % 3 - 1, own[2] + k / 9 - 1});
      if (found == staying.end()) continue;
      for (const int other : found->second)
        if (other < first && (x[to_index(other)] - at).norm() <= reach) first = other;
    }
    to[to_index(v)] = first;
    if (first == v) staying[own].push_back(v);
  }
  return to;
}

/// Leaves out pairs of faces that lie on each other, look opposite ways, and have other faces at
/// all their edges. Returns how many faces that are. `first`: the vertex at each one's place.
int leave_out_inner_faces(Polygons& p, const std::vector<int>& first) {
  std::map<std::pair<int, int>, int> faces_at;                // by the ends of an edge
  std::map<std::vector<int>, std::vector<std::size_t>> like;  // by the corners, the smallest first
  const auto corners_of = [&](const std::vector<int>& face) {
    std::vector<int> all;
    for (const int v : face) all.push_back(first[to_index(v)]);
    std::rotate(all.begin(), std::ranges::min_element(all), all.end());
    return all;
  };
  for (std::size_t f = 0; f < p.faces.size(); ++f) {
    const std::vector<int> all = corners_of(p.faces[f]);
    for (std::size_t k = 0; k < all.size(); ++k)
      ++faces_at[std::minmax(all[k], all[(k + 1) % all.size()])];
    like[all].push_back(f);
  }
  std::vector<bool> inner(p.faces.size());
  for (std::size_t f = 0; f < p.faces.size(); ++f) {
    std::vector<int> turned = corners_of(p.faces[f]);
    const auto touches_others = [&](std::size_t k) {
      return faces_at[std::minmax(turned[k], turned[(k + 1) % turned.size()])] > 2;
    };
    bool all_edges = true;
    for (std::size_t k = 0; k < turned.size(); ++k) all_edges = all_edges && touches_others(k);
    std::reverse(turned.begin() + 1, turned.end());
    const auto opposite = like.find(turned);
    if (inner[f] || !all_edges || opposite == like.end()) continue;
    const auto other =
        std::ranges::find_if(opposite->second, [&](std::size_t g) { return !inner[g]; });
    if (other == opposite->second.end()) continue;
    inner[f] = inner[*other] = true;
  }
  std::size_t kept = 0;
  for (std::size_t f = 0; f < p.faces.size(); ++f) {
    if (inner[f]) continue;
    p.faces[kept] = p.faces[f];
    p.face_lines[kept++] = p.face_lines[f];
  }
  const auto left_out = static_cast<int>(p.faces.size() - kept);
  p.faces.resize(kept);
  p.face_lines.resize(kept);
  return left_out;
}

/// Joins vertices within `reach` of each other; the remaining ones keep their order.
void weld(Polygons& p, double reach, SurfaceErrors& errors) {
  const std::vector<int> to = joined(p.vertices, reach);
  for (std::size_t f = 0; f < p.faces.size(); ++f) {
    std::map<int, int> corners;  // by the vertex that they become
    for (const int v : p.faces[f])
      if (const auto [other, added] = corners.emplace(to[to_index(v)], v); !added) {
        const double apart = (p.vertices[to_index(v)] - p.vertices[to_index(other->second)]).norm();
        errors.report(p.face_lines[f], "`weld` in [cloth] joins vertices " +
                                           number(p, other->second) + " and " + number(p, v) +
                                           " of this face, which are " + shortest(apart) +
                                           " apart: the face would collapse");
        break;
      }
  }
  Polygons whole{.file = p.file,
                 .faces = std::move(p.faces),
                 .face_lines = std::move(p.face_lines),
                 .skipped = std::move(p.skipped)};
  for (std::size_t v = 0; v < to.size(); ++v) {
    if (to[v] != static_cast<int>(v)) {
      whole.welded.push_back(whole.welded[to_index(to[v])]);
      continue;
    }
    whole.welded.push_back(static_cast<int>(whole.vertices.size()));
    whole.vertices.push_back(p.vertices[v]);
    whole.vertex_lines.push_back(p.vertex_lines[v]);
    whole.numbers.push_back(static_cast<int>(v));
  }
  for (std::vector<int>& face : whole.faces)
    for (int& v : face) v = whole.welded[to_index(v)];
  p = std::move(whole);
}

/// Keywords that do not affect the shape.
constexpr std::string_view kOfOthers[] = {"vt", "vn", "vp", "g", "o", "s", "usemtl", "mtllib"};
/// Keywords that other programs add for what no cloth of taut has: plastic and moving cloth, its
/// edges and neighbours (ArcSim), seams, lines and points; how it is shown (the format's section on
/// display attributes). They are skipped, and counted.
constexpr std::string_view kCounted[] = {
    "vv",     "ny",    "nv",       "vl",       "e",          "ea",        "ed",    "tl",
    "adje",   "adjf",  "stitch",   "l",        "p",          "mg",        "lod",   "usemap",
    "maplib", "bevel", "c_interp", "d_interp", "shadow_obj", "trace_obj", "ctech", "stech"};

bool is_among(std::span<const std::string_view> all, std::string_view word) {
  return std::ranges::find(all, word) != all.end();
}

class ObjReader {
 public:
  ObjReader(const std::string& file, SurfaceErrors& errors) : errors_(errors) {
    polygons_.file = file;
  }

  void read(std::string_view text) {
    for (ObjLines lines(text); lines.next(words_);) {
      if (words_.empty()) continue;
      const std::string_view what = words_[0].text;
      if (what == "v")
        vertex();
      else if (what == "f")
        face();
      else if (is_among(kCounted, what))
        ++polygons_.skipped[std::string(what)];
      else if (!is_among(kOfOthers, what))
        report(0, shown(0) + " is not read: a cloth is made of 'v' and 'f' lines");
    }
  }

  /// Returns the surface. Faces may refer to vertices that come later in the file, so their numbers
  /// are checked only now.
  Polygons take() {
    const auto count = static_cast<long>(polygons_.vertices.size());
    for (std::size_t f = 0; f < polygons_.faces.size(); ++f)
      for (const int v : polygons_.faces[f])
        if (v >= count) {
          errors_.report(polygons_.face_lines[f], "the face names vertex " +
                                                      std::to_string(v + 1L) + ", but there are " +
                                                      std::to_string(count));
          break;
        }
    return std::move(polygons_);
  }

 private:
  void report(std::size_t word, const std::string& message) {
    errors_.report(words_[word].line, message, words_[word].column);
  }
  std::string shown(std::size_t word) const {
    return "'" + std::string(words_[word].text.substr(0, 40)) + "'";
  }

  void vertex() {
    Vec3 x = Vec3::Zero();
    if (words_.size() < 4) return report(0, "a vertex needs three coordinates");
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto value = whole<double>(words_[axis + 1].text);
      if (!value || !std::isfinite(*value) || std::abs(*value) > 1e9) {
        report(axis + 1, shown(axis + 1) + " is not a coordinate: a finite number within 1e9");
        break;  // the vertex is kept, so that faces keep their numbers
      }
      x[static_cast<Eigen::Index>(axis)] = *value;
    }
    polygons_.numbers.push_back(static_cast<int>(polygons_.vertices.size()));
    polygons_.vertices.push_back(x);
    polygons_.vertex_lines.push_back(words_[0].line);
  }

  /// "7", "7/1", "7//3" or "7/1/3"; -1 is the latest vertex. Only the first number matters.
  void face() {
    std::vector<int> corners;
    for (std::size_t w = 1; w < words_.size(); ++w) {
      const std::string_view word = words_[w].text;
      const auto index = whole<long>(word.substr(0, word.find('/')));
      const auto so_far = static_cast<long>(polygons_.vertices.size());
      if (!index || *index > (1L << 30)) return report(w, shown(w) + " is not a vertex number");
      if (*index == 0) return report(w, "vertices are numbered from 1; 0 names none");
      if (*index < -so_far)
        return report(w, "the face names vertex " + std::to_string(*index) + ", but there are " +
                             std::to_string(so_far) + " before it");
      corners.push_back(static_cast<int>(*index > 0 ? *index - 1 : so_far + *index));
    }
    if (corners.size() < 3) return report(0, "a face needs three vertices at least");
    std::vector<int> sorted = corners;
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice != sorted.end())
      return report(0, "the face names vertex " + std::to_string(*twice + 1) + " twice");
    polygons_.faces.push_back(std::move(corners));
    polygons_.face_lines.push_back(words_[0].line);
  }

  SurfaceErrors& errors_;
  Polygons polygons_;
  std::vector<ObjWord> words_;
};

}  // namespace

double area(const Polygons& p) {
  double sum = 0;
  for (const auto& face : p.faces) sum += face_area(p, face);
  return sum;
}

Mesh make_mesh(const Polygons& p, double mass, Lumping lumping) {
  assert(!p.faces.empty() && mass > 0);
  Mesh mesh;
  mesh.rest = p.vertices;
  mesh.welded = p.welded;
  for (std::vector<int> face : p.faces) {
    if (face.size() > 3)
      if (const Face shape = face_of(p, face); !shape.convex()) {
        for (const auto& [a, b, c] : shape.triangles())
          mesh.triangles.push_back({face[a], face[b], face[c]});
        continue;
      }
    const auto x = [&](std::size_t k) { return p.vertices[to_index(face[k])]; };
    if (face.size() == 4 && (x(1) - x(3)).squaredNorm() < (x(0) - x(2)).squaredNorm())
      std::rotate(face.begin(), face.begin() + 1, face.end());
    for (std::size_t k = 1; k + 1 < face.size(); ++k)
      mesh.triangles.push_back({face[0], face[k], face[k + 1]});
  }
  const auto n = p.vertices.size();
  if (lumping == Lumping::equal) {
    mesh.mass.assign(n, mass / static_cast<double>(n));
    return mesh;
  }
  mesh.mass.assign(n, 0.0);
  const double density = mass / area(p);
  for (const auto& face : p.faces) {
    const auto share = shares(p, face);
    for (std::size_t k = 0; k < face.size(); ++k)
      mesh.mass[to_index(face[k])] += density * share[k];
  }
  return mesh;
}

std::vector<Link> mesh_links(const Polygons& p, const LinkChoice& choice) {
  using Pair = std::pair<int, int>;
  const auto edges = edges_of(p);
  std::set<Pair> edge_pairs, diagonals, across;
  for (const Edge& e : edges) edge_pairs.emplace(e.a, e.b);
  const auto add = [&](std::set<Pair>& to, int a, int b, const std::set<Pair>& except) {
    const Pair pair = std::minmax(a, b);
    if (a != b && !edge_pairs.count(pair) && !except.count(pair)) to.insert(pair);
  };
  for (const auto& face : p.faces)
    if (face.size() == 4) {
      add(diagonals, face[0], face[2], {});
      add(diagonals, face[1], face[3], {});
    }
  const std::set<Pair> sheared = choice.shear ? diagonals : std::set<Pair>{};
  for (const auto& [a, b, faces] : edges) {
    if (faces.size() != 2) continue;
    const auto &left = p.faces[to_index(faces[0])], &right = p.faces[to_index(faces[1])];
    add(across, beside(left, a, b), beside(right, a, b), sheared);
    add(across, beside(left, b, a), beside(right, b, a), sheared);
  }
  std::vector<Link> links;
  const auto emit = [&](const std::set<Pair>& pairs, Family family) {
    for (const auto& [a, b] : pairs)
      links.push_back({a, b, (p.vertices[to_index(b)] - p.vertices[to_index(a)]).norm(), family});
  };
  if (choice.structural) emit(edge_pairs, Family::structural);
  if (choice.shear) emit(diagonals, Family::shear);
  if (choice.bend) emit(across, Family::bend);
  return links;
}

Polygons parse_obj(const std::string& file, const std::string& text, double reach) {
  SurfaceErrors errors(file);
  ObjReader reader(file, errors);
  reader.read(text);
  Polygons polygons = reader.take();
  errors.throw_if_any();  // the rest requires faces whose vertices exist
  if (reach > 0) weld(polygons, reach, errors);
  errors.throw_if_any();
  judge_surface(polygons, errors);
  errors.throw_if_any();
  return polygons;
}

Polygons read_obj(const std::filesystem::path& path, double weld) {
  return parse_obj(path.string(), read_text(path, kMostMeshBytes), weld);
}

BodySurface parse_body_obj(const std::string& file, const std::string& text, bool solid) {
  SurfaceErrors errors(file);
  ObjReader reader(file, errors);
  reader.read(text);
  Polygons polygons = reader.take();
  errors.throw_if_any();
  if (polygons.faces.empty()) errors.report(1, "no face: a body needs one at least");
  judge_faces(polygons, errors);
  errors.throw_if_any();
  const std::vector<int> first = first_at_each_place(polygons.vertices);
  const int inner = solid ? leave_out_inner_faces(polygons, first) : 0;
  BodySurface body{polygons.vertices,
                   make_mesh(polygons, 1, Lumping::equal).triangles,
                   {},
                   inner,
                   polygons.skipped};
  for (std::size_t f = 0; f < polygons.faces.size(); ++f)
    body.triangle_lines.insert(body.triangle_lines.end(), polygons.faces[f].size() - 2,
                               polygons.face_lines[f]);
  for (std::size_t t = 0; t < body.triangles.size(); ++t) {
    std::array<Vec3, 3> x;
    double longest2 = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      body.triangles[t][k] = first[to_index(body.triangles[t][k])];
      x[k] = body.vertices[to_index(body.triangles[t][k])];
    }
    for (std::size_t k = 0; k < 3; ++k)
      longest2 = std::max(longest2, (x[(k + 1) % 3] - x[k]).squaredNorm());
    if (!(triangle_area(x[0], x[1], x[2]) > 1e-9 * longest2))
      errors.report(body.triangle_lines[t], "a triangle of the face has no area");
  }
  errors.throw_if_any();
  return body;
}

BodySurface read_body_obj(const std::filesystem::path& path, bool solid) {
  return parse_body_obj(path.string(), read_text(path, kMostMeshBytes), solid);
}

}  // namespace taut
