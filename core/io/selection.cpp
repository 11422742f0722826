#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/io/cloth_io.hpp"
#include "core/model/shortest.hpp"

namespace taut {

namespace {

/// Rows and columns of a grid that a name stands for.
struct Part {
  std::string name;
  int i0, i1, j0, j1;  ///< inclusive; -1: the last one
};
const std::vector<Part> kParts{{"top", 0, -1, 0, 0},          {"bottom", 0, -1, -1, -1},
                               {"left", 0, 0, 0, -1},         {"right", -1, -1, 0, -1},
                               {"top-left", 0, 0, 0, 0},      {"top-right", -1, -1, 0, 0},
                               {"bottom-left", 0, 0, -1, -1}, {"bottom-right", -1, -1, -1, -1}};

class Selector {
 public:
  Selector(Section& section, std::string key, const Mesh& mesh)
      : section_(section), key_(std::move(key)), mesh_(mesh) {}

  void add(const Value& value) {
    if (value.is_string())
      add_part(value);
    else if (value.is_table())
      add_box(value);
    else if (value.is_number())
      add_number(value);
    else if (value.is_array())
      add_pair(value);
    else
      report(value,
             "must name vertices: a number, [i, j], an edge such as \"top\", or a box "
             "{ min, max }; not " +
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
    std::vector<std::string> names;
    for (const Part& part : kParts) names.push_back(part.name);
    const auto part = std::find_if(kParts.begin(), kParts.end(),
                                   [&](const Part& p) { return p.name == value.string; });
    if (part == kParts.end())
      return report(value, "names no edge or corner: \"" + value.string + "\"" +
                               suggestion(value.string, names));
    if (!mesh_.grid)
      return report(value, "names \"" + value.string + "\", but only a grid has edges and corners");
    const Grid& g = *mesh_.grid;
    const auto at = [](int index, int count) { return index < 0 ? count + index : index; };
    for (int j = at(part->j0, g.nv); j <= at(part->j1, g.nv); ++j)
      for (int i = at(part->i0, g.nu); i <= at(part->i1, g.nu); ++i) all_.push_back(g.index(i, j));
  }

  void add_number(const Value& value) {
    if (value.kind != Value::Kind::integer || value.number < 0 || value.number >= mesh_.size())
      return report(value, "names vertex " + shortest(value.number) + ", but the cloth has 0 to " +
                               std::to_string(mesh_.size() - 1));
    all_.push_back(static_cast<int>(value.number));
  }

  void add_pair(const Value& value) {
    const bool pair = value.items.size() == 2 && value.items[0].kind == Value::Kind::integer &&
                      value.items[1].kind == Value::Kind::integer;
    if (!pair) return report(value, "must be a pair of whole numbers [i, j]");
    const double i = value.items[0].number, j = value.items[1].number;
    const std::string given = "[" + shortest(i) + ", " + shortest(j) + "]";
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
    for (const char* corner : {"min", "max"})
      if (!box.find(corner)) box.missing(corner);
    const auto low = box.vec3("min", kFar), high = box.vec3("max", kFar);
    box.finish();
    if (!low || !high) return;
    const std::size_t before = all_.size();
    const Eigen::AlignedBox3d inside(*low - Vec3::Constant(kBoxSlack),
                                     *high + Vec3::Constant(kBoxSlack));
    for (int v = 0; v < mesh_.size(); ++v)
      if (inside.contains(mesh_.rest[static_cast<std::size_t>(v)])) all_.push_back(v);
    if (all_.size() == before) report(value, "has a box that holds no vertex");
  }

  static constexpr double kBoxSlack = 1e-9;  ///< m, so that a vertex on the face is inside
  Section& section_;
  std::string key_;
  const Mesh& mesh_;
  std::vector<int> all_;
};

}  // namespace

std::vector<int> read_vertices(Section& section, const std::string& key, const Mesh& mesh) {
  const Value* value = section.find(key);
  if (!value) return {};
  Selector selector(section, key, mesh);
  if (value->is_array())
    for (const Value& item : value->items) selector.add(item);
  else
    selector.add(*value);
  return selector.take();
}

}  // namespace taut
