#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "core/io/mesh_io.hpp"
#include "core/io/scene_readers.hpp"
#include "core/model/angle.hpp"
#include "core/model/index.hpp"
#include "core/model/text.hpp"

namespace taut {

namespace {

constexpr Range kSpace = Range::within(kFar);

std::optional<Grid> read_grid(Section& cloth) {
  cloth.need({"grid"});
  const auto counts = cloth.numbers("grid", 2, {1, kMaxVertices});
  if (!counts) return std::nullopt;
  for (const double count : *counts)
    if (count != std::floor(count)) {
      cloth.report("grid", "must hold whole numbers, not " + as_typed(count));
      return std::nullopt;
    }
  const double all = (*counts)[0] * (*counts)[1];
  if (all < 2) {
    cloth.report("grid", "makes a cloth of one vertex; it needs two at least");
  } else if (all > kMaxVertices) {
    cloth.report("grid", "makes " + as_typed(all) + " vertices; at most " +
                             std::to_string(kMaxVertices) + " are allowed");
  } else {
    return Grid{static_cast<int>((*counts)[0]), static_cast<int>((*counts)[1])};
  }
  return std::nullopt;
}

/// Sides of the sheet [m]; a side with a single vertex along it may be zero.
bool read_size(Section& cloth, SheetShape& shape) {
  cloth.need({"size"});
  const auto size = cloth.numbers("size", 2, Range::non_negative(kFar));
  if (!size) return false;
  shape.width = (*size)[0];
  shape.height = (*size)[1];
  const auto too_small = [](int count, double side) {
    return count > 1 && side / (count - 1) < 1e-9;
  };
  if (!too_small(shape.nu, shape.width) && !too_small(shape.nv, shape.height)) return true;
  cloth.report("size",
               "puts vertices on top of each other; sides must be greater than 0 (links "
               "need 1e-9 m at least)");
  return false;
}

/// Total mass [kg] of a cloth of this area [m^2], from the fabric, `mass` or `area_density`.
std::optional<double> read_mass(Section& cloth, const Fabric* fabric, const FileKeys& said,
                                double area) {
  const bool both = cloth.find("mass") && cloth.find("area_density");
  if (both) cloth.report("area_density", "excludes 'mass': give one of them");
  if (both) return std::nullopt;
  if (fabric && area > 0) return fabric->mass * area;
  if (cloth.find("mass")) return said.mass > 0 ? std::optional(said.mass) : std::nullopt;
  if (area > 0) return said.area_density * area;
  cloth.report(cloth.find("area_density") ? "area_density" : "size",
               "means nothing for a cloth without area: give 'mass'");
  return std::nullopt;
}

/// A row of `count` vertices along a circular arc, whose ends are `span` apart and whose links keep
/// their rest length. Returns the offsets of each vertex along u and perpendicular to it [m].
std::vector<std::pair<double, double>> arc(int count, double width, double span) {
  const int links = count - 1;
  const double chord = width / links;
  // span / chord = sin(links a / 2) / sin(a / 2) falls from `links` to 0 as the angle a between
  // neighbouring links goes from 0 to 2 pi / links.
  double low = 0, high = 2 * std::numbers::pi / links;
  for (int k = 0; k < 200; ++k) {
    const double a = (low + high) / 2;
    const bool wide = std::sin(links * a / 2) * chord > span * std::sin(a / 2);
    (wide ? low : high) = a;
  }
  std::vector<std::pair<double, double>> row{{0, 0}};
  for (int k = 0; k < links; ++k) {
    const double slope = low * ((links - 1) / 2.0 - k);
    const auto [u, v] = row.back();
    row.emplace_back(u + chord * std::cos(slope), v + chord * std::sin(slope));
  }
  row.back() = {span, 0};  // without the rounding of bisection
  return row;
}

/// Sets the start of the sheet: its rest shape, or hung between sides that are closer than its
/// width, then turned about its top edge.
void start_sheet(Section& cloth, const SheetShape& shape, const FileKeys& said, Scene& scene) {
  const bool hung = said.span > 0;
  if (hung && shape.nu < 3) {
    cloth.report("span", "needs three vertices along u at least");
  } else if (hung && said.span > shape.width) {
    cloth.report("span", "must be at most the width " + as_typed(shape.width) + ", not " +
                             as_typed(said.span));
  } else if (hung && said.span < shape.width) {
    const auto row = arc(shape.nu, shape.width, said.span);
    // perpendicular to u even in a parallelogram, so that links keep their lengths
    const Vec3 sag = (shape.v - shape.v.dot(shape.u) * shape.u).normalized();
    const Grid& g = *scene.mesh.grid;
    for (int j = 0; j < g.nv; ++j)
      for (int i = 0; i < g.nu; ++i) {
        const Vec3 down = scene.mesh.rest[to_index(g.index(0, j))];
        scene.start.x[to_index(g.index(i, j))] =
            down + row[to_index(i)].first * shape.u + row[to_index(i)].second * sag;
      }
  }
  if (said.tilt != 0)
    for (Vec3& x : scene.start.x)
      x = shape.origin + Eigen::AngleAxisd(said.tilt * kDegree, shape.u) * (x - shape.origin);
}

LinkChoice links_of(const FileKeys& said) { return {said.structural, said.shear, said.bend}; }

bool read_sheet(Section& cloth, const Fabric* fabric, const FileKeys& said, Scene& scene) {
  SheetShape shape{.origin = said.origin, .u = said.u, .v = said.v, .lumping = said.lumping};
  const double sine = shape.u.cross(shape.v).norm();
  if (sine < 1e-3) cloth.report("v", "must not be parallel to 'u'");
  const auto grid = read_grid(cloth);
  if (grid) {
    shape.nu = grid->nu;
    shape.nv = grid->nv;
  }
  const bool sized = read_size(cloth, shape);
  const auto mass =
      read_mass(cloth, fabric, said, grid && sized ? shape.width * shape.height * sine : 1);
  if (!grid || !sized || !mass || sine < 1e-3) return false;
  shape.mass = *mass;
  scene.mesh = make_sheet(shape);
  scene.links = grid_links(scene.mesh, links_of(said));
  scene.start.x = scene.mesh.rest;
  start_sheet(cloth, shape, said, scene);
  return true;
}

/// A sentence: "sheet.obj: 5 lines skipped, which mean nothing for a cloth: adje 1, vv 4".
std::string remark_on(const Polygons& surface) {
  int lines = 0;
  for (const auto& [word, count] : surface.skipped) lines += count;
  return surface.file + ": " + std::to_string(lines) + (lines == 1 ? " line" : " lines") +
         (lines == 1 ? " skipped, which means" : " skipped, which mean") +
         " nothing for a cloth: " + join(surface.skipped, ", ", [](const auto& one) {
           return one.first + " " + std::to_string(one.second);
         });
}

/// Reads the surface in an OBJ file, scaled, turned and moved. Returns false if the file has
/// errors, which are reported.
bool read_surface(Section& cloth, const std::filesystem::path& folder, const Fabric* fabric,
                  const FileKeys& said, Scene& scene) {
  const Eigen::Quaterniond rotation = read_rotation(cloth);
  const auto name = cloth.string("mesh");
  const double weld = cloth.number("weld", allowed_at("cloth.weld"), 0);
  Polygons surface;
  try {
    if (name) surface = read_obj(folder / *name, weld / said.scale);
  } catch (const InputError& error) {
    for (const Diagnostic& d : error.diagnostics())
      if (d.line > 0)
        cloth.diagnostics().report({d});
      else
        cloth.report("mesh", "cannot be used: " + d.text());
  }
  for (Vec3& x : surface.vertices) {
    x = said.origin + rotation * (said.scale * x);
    if (x.cwiseAbs().maxCoeff() <= kFar) continue;
    cloth.report("mesh", "reaches farther than " + as_typed(kFar) + " m from the origin");
    return false;
  }
  const auto mass = read_mass(cloth, fabric, said, surface.faces.empty() ? 1 : area(surface));
  if (!mass || surface.faces.empty()) return false;
  if (!surface.skipped.empty()) cloth.diagnostics().remark(remark_on(surface));
  scene.mesh = make_mesh(surface, *mass, said.lumping);
  scene.links = mesh_links(surface, links_of(said));
  scene.start.x = scene.mesh.rest;
  return true;
}

/// Scales the rest shape to the start, so that every link has the same strain.
void stretch_start(double factor, Scene& scene) {
  if (factor == 1 || scene.start.x.empty()) return;
  const Vec3 fixed = scene.start.x.front();
  for (Vec3& x : scene.start.x) x = fixed + factor * (x - fixed);
}

/// A named part of a grid: a range of columns and one of rows.
struct Part {
  std::string name;
  int i0, i1, j0, j1;  ///< inclusive; -1: the last
};
const std::vector<Part> kParts{{"top", 0, -1, 0, 0},          {"bottom", 0, -1, -1, -1},
                               {"left", 0, 0, 0, -1},         {"right", -1, -1, 0, -1},
                               {"top-left", 0, 0, 0, 0},      {"top-right", -1, -1, 0, 0},
                               {"bottom-left", 0, 0, -1, -1}, {"bottom-right", -1, -1, -1, -1}};

class VertexReader {
 public:
  VertexReader(Section& section, std::string key, const Mesh& mesh)
      : section_(section), key_(std::move(key)), mesh_(mesh) {}

  void add(const Value& value) {
    if (value.is_string())
      add_part(value);
    else if (value.is_table() && value.find("edge"))
      add_along(value);
    else if (value.is_table())
      value.find("radius") ? add_ball(value) : add_box(value);
    else if (value.is_number())
      add_number(value);
    else if (value.is_array())
      add_pair(value);
    else
      report(value,
             "must name vertices: a number, [i, j], an edge such as \"top\", a place "
             "{ edge, at }, a box { min, max } or a ball { center, radius }; not " +
                 describe(value));
  }
  std::vector<int> take() {
    std::sort(all_.begin(), all_.end());
    all_.erase(std::unique(all_.begin(), all_.end()), all_.end());
    return std::move(all_);
  }

 private:
  void report(const Value& value, const std::string& message) {
    section_.diagnostics().report(value.place,
                                  "'" + key_ + "' in " + section_.name() + " " + message);
  }

  void add_part(const Value& value) {
    for (const int vertex : part_of(value)) all_.push_back(vertex);
  }

  /// The vertices of an edge or corner, in order; empty, with a report, if there is no such part.
  std::vector<int> part_of(const Value& value) {
    std::vector<std::string> names;
    for (const Part& part : kParts) names.push_back(part.name);
    const auto part = std::find_if(kParts.begin(), kParts.end(),
                                   [&](const Part& p) { return p.name == value.string; });
    if (part == kParts.end())
      report(value,
             "names no edge or corner: \"" + value.string + "\"" + suggestion(value.string, names));
    else if (!mesh_.grid)
      report(value, "names \"" + value.string + "\", but only a grid has edges and corners");
    if (part == kParts.end() || !mesh_.grid) return {};
    std::vector<int> vertices;
    const Grid& g = *mesh_.grid;
    const auto at = [](int index, int count) { return index < 0 ? count + index : index; };
    for (int j = at(part->j0, g.nv); j <= at(part->j1, g.nv); ++j)
      for (int i = at(part->i0, g.nu); i <= at(part->i1, g.nu); ++i)
        vertices.push_back(g.index(i, j));
    return vertices;
  }

  /// Adds the vertex nearest to a fraction of the edge, the first of two equally near ones.
  void add_along(const Value& value) {
    Section place(section_.diagnostics(), value, "a place of '" + key_ + "' in " + section_.name());
    place.need({"edge", "at"});
    const auto edge = place.string("edge");
    const auto at = place.number("at", {0, 1});
    place.finish();
    if (!edge || !at) return;
    const std::vector<int> vertices = part_of(*value.find("edge"));
    if (vertices.empty()) return;
    const double exact = *at * static_cast<double>(vertices.size() - 1);
    all_.push_back(vertices[static_cast<std::size_t>(std::ceil(exact - 0.5 - 1e-9))]);
  }

  void add_number(const Value& value) {
    const std::vector<int>& welded = mesh_.welded;
    const int count = welded.empty() ? mesh_.size() : static_cast<int>(welded.size());
    if (value.kind != Value::Kind::integer || value.number < 0 || value.number >= count)
      return report(value, "names vertex " + as_typed(value.number) + ", but the cloth has 0 to " +
                               std::to_string(count - 1));
    const int vertex = static_cast<int>(value.number);
    all_.push_back(welded.empty() ? vertex : welded[to_index(vertex)]);
  }

  void add_pair(const Value& value) {
    const bool pair = value.items.size() == 2 && value.items[0].kind == Value::Kind::integer &&
                      value.items[1].kind == Value::Kind::integer;
    if (!pair) return report(value, "must be a pair of whole numbers [i, j]");
    const double i = value.items[0].number, j = value.items[1].number;
    const std::string given = "[" + as_typed(i) + ", " + as_typed(j) + "]";
    if (!mesh_.grid)
      return report(value, "names " + given + ", but only a grid has [i, j]; name vertex numbers");
    const Grid& g = *mesh_.grid;
    if (i < 0 || i >= g.nu || j < 0 || j >= g.nv)
      return report(value, "names " + given + " outside the grid, which has [0, 0] to [" +
                               std::to_string(g.nu - 1) + ", " + std::to_string(g.nv - 1) + "]");
    all_.push_back(g.index(static_cast<int>(i), static_cast<int>(j)));
  }

  void add_box(const Value& value) {
    Section box(section_.diagnostics(), value, "a box of '" + key_ + "' in " + section_.name());
    box.need({"min", "max"});
    const auto low = box.vec3("min", kSpace), high = box.vec3("max", kSpace);
    box.finish();
    if (!low || !high) return;
    const Eigen::AlignedBox3d box_of(*low - Vec3::Constant(kSlack), *high + Vec3::Constant(kSlack));
    add_if(value, "box", [&](const Vec3& x) { return box_of.contains(x); });
  }

  void add_ball(const Value& value) {
    Section ball(section_.diagnostics(), value, "a ball of '" + key_ + "' in " + section_.name());
    ball.need({"center"});
    const auto center = ball.vec3("center", kSpace);
    const auto radius = ball.number("radius", Range::positive(kFar));
    ball.finish();
    if (!center || !radius) return;
    add_if(value, "ball", [&](const Vec3& x) { return (x - *center).norm() <= *radius + kSlack; });
  }

  template <class Inside>
  void add_if(const Value& value, const std::string& what, const Inside& inside) {
    const std::size_t before = all_.size();
    for (int v = 0; v < mesh_.size(); ++v)
      if (inside(mesh_.rest[to_index(v)])) all_.push_back(v);
    if (all_.size() == before) report(value, "has a " + what + " that holds no vertex");
  }

  static constexpr double kSlack = 1e-9;  ///< m, so that a vertex on the surface counts as inside
  Section& section_;
  std::string key_;
  const Mesh& mesh_;
  std::vector<int> all_;
};

/// The vertices that a value names on its own; an array is a pair [i, j].
std::vector<int> vertices_of(const Value& value, Section& section, const std::string& key,
                             const Mesh& mesh) {
  VertexReader reader(section, key, mesh);
  reader.add(value);
  return reader.take();
}

/// Applies factors to the mass that the lumping gives to vertices.
void read_weights(Section& cloth, Scene& scene) {
  for (const Value* entry : cloth.tables("weights")) {
    Section weight(cloth.diagnostics(), *entry, "'weights' in [cloth]");
    weight.need({"vertices", "factor"});
    const double factor = weight.number("factor", allowed_at("cloth.weights"), 1);
    for (const int vertex : read_vertices(weight, "vertices", scene.mesh))
      scene.mesh.mass[to_index(vertex)] *= factor;
    weight.finish();
  }
}

/// Moves vertices whose start differs from the shape.
void read_placed(Section& cloth, Scene& scene) {
  for (const Value* entry : cloth.tables("placed")) {
    Section placed(cloth.diagnostics(), *entry, "'placed' in [cloth]");
    placed.need({"vertex", "at"});
    const Value* vertex = placed.find("vertex");
    const auto target = placed.vec3("at", allowed_at("cloth.placed"));
    placed.finish();
    if (!vertex || !target) continue;
    const auto vertices = vertices_of(*vertex, placed, "vertex", scene.mesh);
    if (vertices.size() > 1) placed.report("vertex", "must name one vertex");
    if (vertices.size() == 1) scene.start.x[to_index(vertices[0])] = *target;
  }
}

/// Reports keys that the other kind of cloth has, so that the message can say why.
void refuse_other(Section& cloth, ClothKind kind) {
  for (const SceneKey& key : scene_keys()) {
    if (!key.cloth || key.cloth == kind) continue;
    if (const std::string name(key.name()); cloth.find(name))
      cloth.report(name, "belongs to a " + std::string(to_string(*key.cloth)) + ", not to a " +
                             std::string(to_string(kind)));
  }
}

}  // namespace

bool read_cloth(Section& cloth, const std::filesystem::path& folder, const Fabric* fabric,
                const FileKeys& said, Scene& scene) {
  const bool surface = cloth.find("mesh");
  refuse_other(cloth, surface ? ClothKind::mesh : ClothKind::grid);
  const bool built = surface ? read_surface(cloth, folder, fabric, said, scene)
                             : read_sheet(cloth, fabric, said, scene);
  cloth.know();
  if (!built) return false;
  scene.start.v.assign(scene.start.x.size(), said.velocity);
  scene.pins = read_vertices(cloth, "pins", scene.mesh);
  for (const int pin : scene.pins) scene.start.v[to_index(pin)].setZero();
  stretch_start(said.stretch, scene);
  read_weights(cloth, scene);
  read_placed(cloth, scene);
  return true;
}

namespace {

/// The vertices that the items of a list name, one item after another.
std::vector<int> in_order(Section& section, const std::string& key, const Mesh& mesh) {
  std::vector<int> all;
  const Value* value = section.find(key);
  if (!value) return all;
  if (!value->is_array()) return vertices_of(*value, section, key, mesh);
  for (const Value& item : value->items)
    for (const int vertex : vertices_of(item, section, key, mesh)) all.push_back(vertex);
  return all;
}

using VertexPair = std::pair<int, int>;

/// Pairs of vertices that share a face or are already linked, lesser vertex first.
std::set<VertexPair> together(const Scene& scene) {
  std::set<VertexPair> all;
  const auto add = [&](int a, int b) { all.insert(std::minmax(a, b)); };
  for (const auto& [a, b, c] : scene.mesh.triangles) {
    add(a, b);
    add(b, c);
    add(a, c);
  }
  for (const Link& link : scene.links)
    if (link.family != Family::bend) add(link.a, link.b);
  if (const auto& g = scene.mesh.grid)
    for (int j = 0; j + 1 < g->nv; ++j)
      for (int i = 0; i + 1 < g->nu; ++i) {
        add(g->index(i, j), g->index(i + 1, j + 1));
        add(g->index(i + 1, j), g->index(i, j + 1));
      }
  return all;
}

}  // namespace

void read_seams(Section& root, Scene& scene) {
  const auto items = root.tables("seam");
  if (items.empty()) return;
  std::set<VertexPair> known = together(scene);
  std::vector<Link> seams;
  for (const Value* item : items) {
    Section seam(root.diagnostics(), *item, "[[seam]]", "seam");
    seam.need({"a", "b"});
    const std::vector<int> a = in_order(seam, "a", scene.mesh), b = in_order(seam, "b", scene.mesh);
    seam.finish();
    if (a.empty() || b.empty()) continue;
    if (a.size() != b.size())
      seam.report("b", "names " + std::to_string(b.size()) + " vertices, 'a' names " +
                           std::to_string(a.size()) + ": a seam is of pairs");
    for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
      const std::string who = "vertices " + std::to_string(a[k]) + " and " + std::to_string(b[k]);
      if (a[k] == b[k])
        seam.report("b", "sews vertex " + std::to_string(a[k]) + " to itself");
      else if (!known.insert(std::minmax(a[k], b[k])).second)
        seam.report("b", "sews " + who + ", which one face, link or seam has already");
      else
        seams.push_back({a[k], b[k], kSeamRest, Family::structural});
    }
  }
  const auto behind = std::ranges::find_if(
      scene.links, [](const Link& l) { return l.family != Family::structural; });
  scene.links.insert(behind, seams.begin(), seams.end());
}

std::vector<int> read_vertices(Section& section, const std::string& key, const Mesh& mesh) {
  const Value* value = section.find(key);
  if (!value) return {};
  if (!value->is_array()) return vertices_of(*value, section, key, mesh);
  VertexReader reader(section, key, mesh);
  for (const Value& item : value->items) reader.add(item);
  return reader.take();
}

}  // namespace taut
