#include "core/model/mesh.hpp"

#include <cassert>

namespace taut {

std::string_view to_string(Family family) {
  switch (family) {
    case Family::structural:
      return "structural";
    case Family::shear:
      return "shear";
    case Family::bend:
      return "bend";
  }
  return "";
}

namespace {

void lump(Mesh& mesh, const SheetShape& s) {
  const auto n = static_cast<std::size_t>(mesh.size());
  if (s.lumping == Lumping::equal) {
    mesh.mass.assign(n, s.mass / static_cast<double>(n));
    return;
  }
  // A vertex owns half of every grid interval next to it, in each direction that has any.
  const auto share = [](int i, int count) {
    if (count == 1) return 1.0;
    return (i == 0 || i == count - 1 ? 0.5 : 1.0) / (count - 1);
  };
  mesh.mass.reserve(n);
  for (int j = 0; j < s.nv; ++j)
    for (int i = 0; i < s.nu; ++i) mesh.mass.push_back(s.mass * share(i, s.nu) * share(j, s.nv));
}

}  // namespace

Mesh make_sheet(const SheetShape& s) {
  assert(s.nu >= 1 && s.nv >= 1 && s.nu * s.nv >= 2);
  Mesh mesh;
  mesh.grid = Grid{s.nu, s.nv};
  const Grid& g = *mesh.grid;
  mesh.rest.reserve(static_cast<std::size_t>(g.size()));
  const auto fraction = [](int i, int count) {
    return count == 1 ? 0.0 : static_cast<double>(i) / (count - 1);
  };
  for (int j = 0; j < s.nv; ++j)
    for (int i = 0; i < s.nu; ++i)
      mesh.rest.push_back(s.origin + fraction(i, s.nu) * s.width * s.u +
                          fraction(j, s.nv) * s.height * s.v);
  for (int j = 0; j + 1 < s.nv; ++j)
    for (int i = 0; i + 1 < s.nu; ++i) {
      const int a = g.index(i, j), b = g.index(i + 1, j);
      const int c = g.index(i, j + 1), d = g.index(i + 1, j + 1);
      if ((i + j) % 2 == 0) {
        mesh.triangles.push_back({a, c, d});
        mesh.triangles.push_back({a, d, b});
      } else {
        mesh.triangles.push_back({a, c, b});
        mesh.triangles.push_back({b, c, d});
      }
    }
  lump(mesh, s);
  return mesh;
}

std::vector<Link> grid_links(const Mesh& mesh, const LinkChoice& choice) {
  assert(mesh.grid);
  const Grid g = *mesh.grid;
  std::vector<Link> links;
  const auto add = [&](int i, int j, int di, int dj, Family family) {
    const int ti = i + di, tj = j + dj;
    if (ti < 0 || ti >= g.nu || tj >= g.nv) return;
    const int a = g.index(i, j), b = g.index(ti, tj);
    const auto& x = mesh.rest;
    links.push_back(
        {a, b, (x[static_cast<std::size_t>(b)] - x[static_cast<std::size_t>(a)]).norm(), family});
  };
  const auto link = [&](int du, int dv, int eu, int ev, Family family) {
    for (int j = 0; j < g.nv; ++j)
      for (int i = 0; i < g.nu; ++i) {
        add(i, j, du, dv, family);
        add(i, j, eu, ev, family);
      }
  };
  if (choice.structural) link(1, 0, 0, 1, Family::structural);
  if (choice.shear) link(1, 1, -1, 1, Family::shear);
  if (choice.bend) link(2, 0, 0, 2, Family::bend);
  return links;
}

}  // namespace taut
