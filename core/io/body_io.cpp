#include <utility>

#include "core/io/mesh_io.hpp"
#include "core/io/positions/positions.hpp"
#include "core/io/scene_readers.hpp"
#include "core/io/text_file.hpp"
#include "core/model/body_frames.hpp"
#include "core/model/index.hpp"
#include "core/model/text.hpp"

namespace taut {

namespace {

/// The surface in the file, or nothing if it cannot be read; errors are reported at file and line.
std::optional<BodySurface> read_file(Section& section, const std::filesystem::path& path,
                                     MeshBody::Sides sides) {
  try {
    return read_body_obj(path, sides == MeshBody::Sides::out);
  } catch (const InputError& error) {
    for (const Diagnostic& d : error.diagnostics())
      if (d.line > 0)
        section.diagnostics().report({d});
      else
        section.report("file", "cannot be used: " + d.text());
    return {};
  }
}

/// A sentence about skipped lines of the file: how many, and which.
std::string remark_on(const std::string& file, const BodySurface& surface) {
  return file + ": skipped lines that mean nothing for a body: " +
         join(surface.skipped, ", ",
              [](const auto& one) { return one.first + " " + std::to_string(one.second); });
}

/// Scales the vertices. Returns false, with a report, if they reach too far.
bool scaled(std::vector<Vec3>& vertices, double scale, Section& section, const std::string& key) {
  for (Vec3& x : vertices) {
    x *= scale;
    if (x.cwiseAbs().maxCoeff() <= kFar) continue;
    section.report(key, "reaches farther than " + as_typed(kFar) + " m from its origin");
    return false;
  }
  return true;
}

/// The mesh of a solid body; triangles that face inward are turned outward. Null, with a report, if
/// it encloses no volume.
std::shared_ptr<const TriangleMesh> solid(const std::filesystem::path& path, BodySurface surface,
                                          Section& section) {
  auto mesh = std::make_shared<const TriangleMesh>(surface.vertices, surface.triangles);
  if (!mesh->closed()) {
    section.diagnostics().report(
        {{path.string(), surface.triangle_lines[to_index(mesh->open_edge())], 1,
          "an edge of the face has no other face that goes along it the "
          "other way (where solids touch: one each way by turns): with sides = \"out\" a body is "
          "closed; close it, or set sides = \"both\""}});
    return nullptr;
  }
  const double size = mesh->box().sizes().prod();
  if (!(std::abs(mesh->volume()) > 1e-9 * size)) {
    section.report("file", "encloses no volume: set sides = \"both\"");
    return nullptr;
  }
  if (mesh->volume() > 0) return mesh;
  section.diagnostics().remark(path.string() +
                                   ": its faces look inward, and were turned; cloth that is to be "
                                   "inside, as in a room, needs sides = \"both\"",
                               section.place());
  for (Triangle& t : surface.triangles) std::swap(t[1], t[2]);
  return std::make_shared<const TriangleMesh>(std::move(surface.vertices),
                                              std::move(surface.triangles));
}

std::shared_ptr<const TriangleMesh> read_mesh(Section& section, const std::filesystem::path& folder,
                                              double scale, MeshBody::Sides sides) {
  section.need({"file"});
  const auto name = section.string("file");
  if (!name) return nullptr;
  const std::filesystem::path path = folder / *name;
  std::optional<BodySurface> surface = read_file(section, path, sides);
  if (!surface) return nullptr;
  if (!surface->skipped.empty()) section.diagnostics().remark(remark_on(path.string(), *surface));
  if (surface->inner_faces > 0)
    section.diagnostics().remark(path.string() + ": left out " +
                                 std::to_string(surface->inner_faces) +
                                 " faces that lie on each other where solids touch");
  if (!scaled(surface->vertices, scale, section, "file")) return nullptr;
  if (sides == MeshBody::Sides::out) return solid(path, std::move(*surface), section);
  return std::make_shared<const TriangleMesh>(std::move(surface->vertices),
                                              std::move(surface->triangles));
}

/// The error in a frame of a body, or "". `mesh` has the body's triangles.
std::string problem_of(const std::vector<Vec3>& x, TriangleMesh& mesh, MeshBody::Sides sides) {
  const auto bad = std::ranges::find_if(x, [](const Vec3& p) { return !p.allFinite(); });
  if (bad != x.end()) return "vertex " + std::to_string(bad - x.begin()) + " is not finite";
  for (const auto& [a, b, c] : mesh.triangles()) {
    const Vec3 u = x[to_index(b)] - x[to_index(a)], v = x[to_index(c)] - x[to_index(a)];
    const double longest2 = std::max({u.squaredNorm(), v.squaredNorm(), (v - u).squaredNorm()});
    if (!(u.cross(v).norm() > 2e-9 * longest2))
      return "the triangle of vertices " + std::to_string(a) + ", " + std::to_string(b) + " and " +
             std::to_string(c) + " has no area";
  }
  if (sides == MeshBody::Sides::both) return "";
  mesh.refit(x);
  if (mesh.volume() > 1e-9 * mesh.box().sizes().prod()) return "";
  return "it encloses no volume, or is turned inside out: set sides = \"both\"";
}

/// The body's frames. Null, with a report, if they do not fit the mesh.
std::shared_ptr<const BodyFrames> read_frames(Section& section, const std::filesystem::path& folder,
                                              double scale, MeshBody::Sides sides,
                                              const TriangleMesh* mesh) {
  const auto name = section.string("frames");
  const auto fps = section.number("fps", allowed_at("collider.fps"));
  if (!name) {
    if (section.find("fps"))
      section.report("fps",
                     "says how many 'frames' there are in a second, and there are no "
                     "frames");
    return nullptr;
  }
  section.need({"fps"});
  const std::filesystem::path path = folder / *name;
  const auto refuse = [&](const std::string& why) {
    section.report("frames", path.string() + ": " + why);
    return nullptr;
  };
  try {
    if (path.extension() != ".npy")
      return refuse("frames are a NumPy array, whose name ends in .npy");
    const auto reader = open_positions(path);
    const PositionsHeader& header = reader->header();
    const auto n = static_cast<std::size_t>(header.vertices);
    if (static_cast<std::uint64_t>(header.frames) * n > kMostMeshBytes / sizeof(Vec3))
      return refuse("more than " + std::to_string(kMostMeshBytes >> 20) + " MiB as float64");
    if (header.frames < 2) return refuse("has one frame: a body that deforms has two at least");
    if (!mesh || !fps) return nullptr;
    if (n != mesh->vertices().size())
      return refuse("has " + std::to_string(n) + " vertices in a frame, and 'file' has " +
                    std::to_string(mesh->vertices().size()));
    auto frames = std::make_shared<BodyFrames>();
    frames->fps = *fps;
    TriangleMesh posed = *mesh;
    for (int k = 0; k < header.frames; ++k) {
      frames->places.push_back(reader->read(k));
      const std::string wrong = problem_of(frames->places.back(), posed, sides);
      if (!wrong.empty()) return refuse("frame " + std::to_string(k) + ": " + wrong);
      if (!scaled(frames->places.back(), scale, section, "frames")) return nullptr;
    }
    return frames;
  } catch (const InputError& error) {
    for (const Diagnostic& d : error.diagnostics())
      section.report("frames", "cannot be used: " + d.text());
    return nullptr;
  }
}

}  // namespace

void read_body(Section& section, const std::filesystem::path& folder, Collider& collider) {
  auto& body = std::get<MeshBody>(collider.shape);
  const double scale = section.number("scale", allowed_at("collider.scale"), 1);
  body.mesh = read_mesh(section, folder, scale, body.sides);
  collider.frames = read_frames(section, folder, scale, body.sides, body.mesh.get());
  if (!collider.frames) return;
  auto mesh =
      std::make_shared<TriangleMesh>(collider.frames->places.front(), body.mesh->triangles());
  body.mesh = std::move(mesh);
}

}  // namespace taut
