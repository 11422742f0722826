#include "experiments/render/picture/obj_export.hpp"

#include <array>
#include <cstdio>

#include "experiments/system/files.hpp"

namespace taut {

namespace {

template <class... Values>
void line(std::string& out, const char* format, Values... values) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  out += text.data();
}

/// What is the same in every file: material coordinates, then faces or lines.
std::string connectivity(const Scene& scene) {
  std::string out;
  const bool grid = scene.mesh.grid.has_value() && !scene.mesh.triangles.empty();
  if (grid)
    for (int j = 0; j < scene.mesh.grid->nv; ++j)
      for (int i = 0; i < scene.mesh.grid->nu; ++i)
        line(out, "vt %.9g %.9g\n", 1.0 * i / (scene.mesh.grid->nu - 1),
             1 - 1.0 * j / (scene.mesh.grid->nv - 1));
  for (const auto& [a, b, c] : scene.mesh.triangles)
    grid ? line(out, "f %d/%d %d/%d %d/%d\n", a + 1, a + 1, b + 1, b + 1, c + 1, c + 1)
         : line(out, "f %d %d %d\n", a + 1, b + 1, c + 1);
  if (scene.mesh.triangles.empty())
    for (const Link& link : scene.links)
      if (link.family == Family::structural) line(out, "l %d %d\n", link.a + 1, link.b + 1);
  return out;
}

}  // namespace

int export_obj(const Scene& scene, const RecordedRun& run, const std::filesystem::path& folder,
               const std::string& prefix, int stride,
               const std::function<void(int, int)>& progress) {
  make_folder(folder);
  const std::string shared = connectivity(scene);
  const auto& frames = run.trajectory.frames;
  const int total = (static_cast<int>(frames.size()) + stride - 1) / stride;
  for (int k = 0; k < total; ++k) {
    const auto& frame = frames[static_cast<std::size_t>(k) * static_cast<std::size_t>(stride)];
    std::string out = "# " + scene.name + ", " + run.trajectory.header.solver + "\n";
    line(out, "# t = %.9g s, metres\n", frame.t);
    for (const Vec3& p : frame.state.x) line(out, "v %.9g %.9g %.9g\n", p.x(), p.y(), p.z());
    std::array<char, 24> number{};
    std::snprintf(number.data(), number.size(), "_%05d.obj", k);
    write_file(folder / (prefix + number.data()), out + shared);
    if (progress) progress(k + 1, total);
  }
  return total;
}

}  // namespace taut
