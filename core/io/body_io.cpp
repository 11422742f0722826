#include <utility>

#include "core/io/mesh_io.hpp"
#include "core/io/scene_readers.hpp"
#include "core/model/index.hpp"
#include "core/model/text.hpp"

namespace taut {

namespace {

/// Nothing, and what is wrong at file and line, if it cannot be read.
std::optional<BodySurface> read_file(Section& section, const std::filesystem::path& path) {
  try {
    return read_body_obj(path);
  } catch (const InputError& error) {
    for (const Diagnostic& d : error.diagnostics())
      if (d.line > 0)
        section.diagnostics().report({d});
      else
        section.report("file", "cannot be used: " + d.text());
    return {};
  }
}

/// How many lines of the file were skipped, and which.
std::string remark_on(const std::string& file, const BodySurface& surface) {
  return file + ": lines that say nothing of a body are skipped: " +
         join(surface.skipped, ", ",
              [](const auto& one) { return one.first + " " + std::to_string(one.second); });
}

}  // namespace

std::shared_ptr<const TriangleMesh> read_body(Section& section, const std::filesystem::path& folder,
                                              MeshBody::Sides sides) {
  section.need({"file"});
  const auto name = section.string("file");
  const double scale = section.number("scale", Range{1e-6, 1e6}, 1);
  if (!name) return nullptr;
  const std::filesystem::path path = folder / *name;
  std::optional<BodySurface> surface = read_file(section, path);
  if (!surface) return nullptr;
  if (!surface->skipped.empty()) section.diagnostics().remark(remark_on(path.string(), *surface));
  for (Vec3& x : surface->vertices) {
    x *= scale;
    if (x.cwiseAbs().maxCoeff() <= kFar) continue;
    section.report("file", "reaches farther than " + as_typed(kFar) + " m from its origin");
    return nullptr;
  }
  auto mesh = std::make_shared<const TriangleMesh>(surface->vertices, surface->triangles);
  if (sides == MeshBody::Sides::both) return mesh;
  if (!mesh->closed()) {
    section.diagnostics().report(
        {{path.string(), surface->triangle_lines[to_index(mesh->open_edge())], 1,
          "an edge of the face has no other face that goes along it the "
          "other way: with sides = \"out\" a body is closed; close it, or "
          "set sides = \"both\""}});
    return nullptr;
  }
  const double size = mesh->box().sizes().prod();
  if (!(std::abs(mesh->volume()) > 1e-9 * size)) {
    section.report("file", "encloses no volume: set sides = \"both\"");
    return nullptr;
  }
  if (mesh->volume() > 0) return mesh;
  section.diagnostics().remark(path.string() + ": its faces look inward, and were turned");
  for (Triangle& t : surface->triangles) std::swap(t[1], t[2]);
  return std::make_shared<const TriangleMesh>(std::move(surface->vertices),
                                              std::move(surface->triangles));
}

}  // namespace taut
