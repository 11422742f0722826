#include "experiments/render/opengl/render_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/model/index.hpp"
#include "core/model/triangle_mesh.hpp"

namespace taut {

namespace {

/// A regular grid of points, each with a value and a depth.
struct Lattice {
  int nu = 0, nv = 0;
  std::vector<Vec3f> x;
  std::vector<float> value, depth;
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nu) + static_cast<std::size_t>(i);
  }
};

/// Refines along u into `pieces` per quad side: positions with Catmull-Rom, continued linearly at
/// the ends, values linearly. The result is transposed, so that two calls refine both directions.
Lattice refine_and_transpose(const Lattice& in, int pieces) {
  Lattice out{in.nv, (in.nu - 1) * pieces + 1, {}, {}, {}};
  out.x.resize(in.x.size() / static_cast<std::size_t>(in.nu) * static_cast<std::size_t>(out.nv));
  out.value.resize(out.x.size());
  out.depth.resize(out.x.size());
  for (int j = 0; j < in.nv; ++j)
    for (int k = 0; k < out.nv; ++k) {
      const int i = std::min(k / pieces, in.nu - 2);
      const float s = static_cast<float>(k - i * pieces) / static_cast<float>(pieces);
      const Vec3f &b = in.x[in.index(i, j)], &c = in.x[in.index(i + 1, j)];
      const Vec3f a = i > 0 ? in.x[in.index(i - 1, j)] : Vec3f(2 * b - c);
      const Vec3f d = i + 2 < in.nu ? in.x[in.index(i + 2, j)] : Vec3f(2 * c - b);
      const float s2 = s * s, s3 = s2 * s;
      out.x[out.index(j, k)] = 0.5f * (2 * b + (c - a) * s + (2 * a - 5 * b + 4 * c - d) * s2 +
                                       (3 * b - a - 3 * c + d) * s3);
      for (auto channel : {&Lattice::value, &Lattice::depth})
        (out.*channel)[out.index(j, k)] =
            (in.*channel)[in.index(i, j)] * (1 - s) + (in.*channel)[in.index(i + 1, j)] * s;
    }
  return out;
}

std::vector<std::array<std::uint32_t, 3>> lattice_triangles(int nu, int nv) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (int j = 0; j + 1 < nv; ++j)
    for (int i = 0; i + 1 < nu; ++i) {
      const auto at = [&](int a, int b) {
        return static_cast<std::uint32_t>((j + b) * nu + i + a);
      };
      const bool falling = (i + j) % 2 == 0;
      if (falling) {
        triangles.push_back({at(0, 0), at(0, 1), at(1, 1)});
        triangles.push_back({at(0, 0), at(1, 1), at(1, 0)});
      } else {
        triangles.push_back({at(0, 0), at(0, 1), at(1, 0)});
        triangles.push_back({at(1, 0), at(0, 1), at(1, 1)});
      }
    }
  return triangles;
}

/// Adds a surface of rows x columns quads with two triangles each. at(j, i) returns position and
/// normal of point i in row j.
template <class At>
void append_surface(RenderMesh& mesh, int rows, int columns, float value, const At& at) {
  const auto first = static_cast<std::uint32_t>(mesh.position.size()),
             row = static_cast<std::uint32_t>(columns + 1);
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const std::pair<Vec3f, Vec3f> point = at(j, i);
      mesh.position.push_back(point.first);
      mesh.normal.push_back(point.second);
      mesh.value.push_back(value);
      if (j == rows || i == columns) continue;
      const auto a = first + static_cast<std::uint32_t>(j) * row + static_cast<std::uint32_t>(i);
      mesh.triangles.push_back({a, a + 1, a + row});
      mesh.triangles.push_back({a + 1, a + row + 1, a + row});
    }
}

/// A cylinder of `sides` facets between two points.
void append_cylinder(RenderMesh& mesh, const Vec3f& from, const Vec3f& to, float radius, int sides,
                     float value_from, float value_to) {
  const Vec3f axis = (to - from).normalized();
  const Vec3f across = axis.unitOrthogonal(), other = axis.cross(across);
  const auto first = static_cast<std::uint32_t>(mesh.position.size());
  for (int k = 0; k < sides; ++k) {
    const float angle = 6.2831853f * static_cast<float>(k) / static_cast<float>(sides);
    const Vec3f out = across * std::cos(angle) + other * std::sin(angle);
    for (const bool end : {false, true}) {
      mesh.position.push_back((end ? to : from) + radius * out);
      mesh.normal.push_back(out);
      mesh.value.push_back(end ? value_to : value_from);
    }
    const auto a = first + static_cast<std::uint32_t>(2 * k);
    const auto b = first + static_cast<std::uint32_t>(2 * ((k + 1) % sides));
    mesh.triangles.push_back({a, b, a + 1});
    mesh.triangles.push_back({a + 1, b, b + 1});
  }
}

bool is_sheet(const Scene& scene) {
  return scene.mesh.grid && scene.mesh.grid->nu > 1 && scene.mesh.grid->nv > 1;
}

std::vector<Vec3f> to_float(const std::vector<Vec3>& x) {
  std::vector<Vec3f> out;
  for (const Vec3& p : x) out.push_back(p.cast<float>());
  return out;
}

}  // namespace

void RenderMesh::compute_normals() {
  normal.assign(position.size(), Vec3f::Zero());
  for (const auto& [a, b, c] : triangles) {
    const Vec3f n = (position[b] - position[a]).cross(position[c] - position[a]);
    normal[a] += n;
    normal[b] += n;
    normal[c] += n;
  }
  for (Vec3f& n : normal) n = n.norm() > 0 ? n.normalized() : Vec3f::UnitY();
}

ClothMesher::ClothMesher(const Scene& scene, int finest) : scene_(scene) {
  if (is_sheet(scene)) {
    const int quads = std::max(scene.mesh.grid->nu, scene.mesh.grid->nv) - 1;
    refinement_ = std::clamp(finest / quads, 1, 8);
    grid_spacing_ = std::max(1, (quads + 8) / 16);
  }
  for (const Link& link : scene.links) mean_rest_ += link.rest;
  if (!scene.links.empty()) mean_rest_ /= static_cast<double>(scene.links.size());
}

RenderMesh ClothMesher::mesh(const std::vector<Vec3>& x, const std::vector<double>& values,
                             const std::vector<double>& depths) const {
  return is_sheet(scene_)                 ? sheet(x, values, depths)
         : !scene_.mesh.triangles.empty() ? faces(x, values)
                                          : tube(x, values);
}

RenderMesh ClothMesher::sheet(const std::vector<Vec3>& x, const std::vector<double>& values,
                              const std::vector<double>& depths) const {
  const Grid& grid = *scene_.mesh.grid;
  const Lattice coarse{grid.nu,
                       grid.nv,
                       to_float(x),
                       {values.begin(), values.end()},
                       {depths.begin(), depths.end()}};
  const Lattice fine = refine_and_transpose(refine_and_transpose(coarse, refinement_), refinement_);
  RenderMesh mesh;
  mesh.position = fine.x;
  mesh.value = fine.value;
  mesh.hidden = fine.depth;
  mesh.triangles = lattice_triangles(fine.nu, fine.nv);
  const float step = 1 / static_cast<float>(refinement_);
  for (int j = 0; j < fine.nv; ++j)
    for (int i = 0; i < fine.nu; ++i)
      mesh.uv.emplace_back(static_cast<float>(i) * step, static_cast<float>(j) * step);
  mesh.compute_normals();
  return mesh;
}

RenderMesh ClothMesher::faces(const std::vector<Vec3>& x, const std::vector<double>& values) const {
  RenderMesh mesh;
  mesh.position = to_float(x);
  mesh.value.assign(values.begin(), values.end());
  for (const auto& [a, b, c] : scene_.mesh.triangles)
    mesh.triangles.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                              static_cast<std::uint32_t>(c)});
  mesh.compute_normals();
  return mesh;
}

RenderMesh ClothMesher::tube(const std::vector<Vec3>& x, const std::vector<double>& values) const {
  RenderMesh mesh;
  const std::vector<Vec3f> points = to_float(x);
  const float radius = static_cast<float>(extent(scene_)) * 0.006f;
  const auto value = [&](int i) { return static_cast<float>(values[to_index(i)]); };
  for (const Link& link : scene_.links)
    if (link.family == Family::structural)
      append_cylinder(mesh, points[to_index(link.a)], points[to_index(link.b)], radius, 12,
                      value(link.a), value(link.b));
  for (int i = 0; i < scene_.mesh.size(); ++i)
    append_ball(mesh, points[to_index(i)], 2 * radius, 14, value(i));
  return mesh;
}

void append_ball(RenderMesh& mesh, const Vec3f& centre, float radius, int segments, float value) {
  const int rings = segments / 2;
  append_surface(mesh, rings, segments, value, [&](int j, int i) {
    const float down = 3.1415927f * static_cast<float>(j) / static_cast<float>(rings);
    const float turn = 6.2831853f * static_cast<float>(i) / static_cast<float>(segments);
    const Vec3f out(std::sin(down) * std::cos(turn), std::cos(down),
                    std::sin(down) * std::sin(turn));
    return std::pair<Vec3f, Vec3f>(centre + radius * out, out);
  });
}

namespace {

RenderMesh ball_mesh(const Ball& ball, double inset, int segments) {
  RenderMesh mesh;
  append_ball(mesh, ball.center.cast<float>(),
              static_cast<float>(std::max(ball.radius - inset, 0.5 * ball.radius)), segments, 0);
  return mesh;
}

/// A box whose edges are rounded by `radius`: each point on the faces of the cube is clamped to the
/// box that is smaller by `radius`, then pushed out by `radius`.
RenderMesh box_mesh(const Box& box, double inset, double rounding, int pieces) {
  const Vec3 half = (box.half_extents.array() - inset).max(box.half_extents.array() * 0.5);
  const double radius = std::min(rounding, 0.4 * half.minCoeff());
  const Vec3 inner = half.array() - radius;
  RenderMesh mesh;
  // Points are denser near the edges, where the rounding is.
  const auto place = [pieces](int k) {
    const double s = 2.0 * k / pieces - 1;
    return s * (1.5 - 0.5 * s * s);
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0})
      append_surface(mesh, pieces, pieces, 0, [&](int j, int i) {
        Vec3 p;
        p[axis] = sign * half[axis];
        p[(axis + 1) % 3] = place(i) * half[(axis + 1) % 3];
        p[(axis + 2) % 3] = place(j) * half[(axis + 2) % 3];
        const Vec3 core = p.cwiseMax(-inner).cwiseMin(inner);
        const Vec3 out = (p - core).normalized();
        return std::pair<Vec3f, Vec3f>(
            (box.center + box.rotation * (core + radius * out)).cast<float>(),
            (box.rotation * out).cast<float>());
      });
  return mesh;
}

RenderMesh plane_mesh(const Plane& plane, double inset, const Vec3& centre, double reach,
                      int pieces) {
  const Vec3 u = plane.normal.unitOrthogonal(), v = plane.normal.cross(u);
  const Vec3 foot = centre - plane.normal * (plane.normal.dot(centre) - plane.offset + inset);
  RenderMesh mesh;
  append_surface(mesh, pieces, pieces, 0, [&](int j, int i) {
    const double a = reach * (2.0 * i / pieces - 1), b = reach * (2.0 * j / pieces - 1);
    return std::pair<Vec3f, Vec3f>((foot + a * u + b * v).cast<float>(),
                                   plane.normal.cast<float>());
  });
  return mesh;
}

/// A ball cut in half, with the halves moved apart.
RenderMesh capsule_mesh(const Capsule& capsule, double inset, int segments) {
  const int rings = segments / 2;
  const double radius = std::max(capsule.radius - inset, 0.5 * capsule.radius);
  const Vec3 side = capsule.beside(), along = capsule.to - capsule.from;
  const Vec3 up = along.isZero(0) ? Vec3(Vec3::UnitX()) : along.normalized();
  const Vec3 other = side.cross(up);
  RenderMesh mesh;
  append_surface(mesh, rings + 1, segments, 0, [&](int j, int i) {
    const bool upper = j <= rings / 2;  // the middle ring exists twice
    const double down = std::numbers::pi * (upper ? j : j - 1) / rings;
    const double turn = 2 * std::numbers::pi * i / segments;
    const Vec3 out =
        std::cos(down) * up + std::sin(down) * (std::cos(turn) * side + std::sin(turn) * other);
    return std::pair<Vec3f, Vec3f>(
        ((upper ? capsule.to : capsule.from) + radius * out).cast<float>(), out.cast<float>());
  });
  return mesh;
}

/// Smooth where triangles meet at less than the angle of `kCrease`, with a sharp edge elsewhere.
RenderMesh body_mesh(const MeshBody& body, double inset) {
  constexpr double kCrease = 0.8;  // cosine: 37 degrees
  const TriangleMesh& mesh = *body.mesh;
  const double in = body.sides == MeshBody::Sides::out ? inset : 0;
  std::vector<std::vector<int>> around(mesh.vertices().size());
  for (std::size_t t = 0; t < mesh.triangles().size(); ++t)
    for (const int v : mesh.triangles()[t]) around[to_index(v)].push_back(static_cast<int>(t));
  const auto area_normal = [&](int triangle) {
    const auto& [a, b, c] = mesh.triangles()[to_index(triangle)];
    const Vec3& x = mesh.vertices()[to_index(a)];
    return Vec3((mesh.vertices()[to_index(b)] - x).cross(mesh.vertices()[to_index(c)] - x));
  };
  RenderMesh drawn;
  for (std::size_t t = 0; t < mesh.triangles().size(); ++t) {
    const Vec3& own = mesh.normal(static_cast<int>(t));
    const auto first = static_cast<std::uint32_t>(drawn.position.size());
    for (const int v : mesh.triangles()[t]) {
      Vec3 sum = Vec3::Zero();
      for (const int other : around[to_index(v)])
        if (mesh.normal(other).dot(own) > kCrease) sum += area_normal(other);
      const Vec3 out = body.rotation * sum.normalized();
      const Vec3 at = body.center + body.rotation * mesh.vertices()[to_index(v)] - in * out;
      drawn.position.push_back(at.cast<float>());
      drawn.normal.push_back(out.cast<float>());
      drawn.value.push_back(0);
    }
    drawn.triangles.push_back({first, first + 1, first + 2});
  }
  return drawn;
}

/// Depth [m] up to which the side of the collider on which cloth belongs is unambiguous.
double liftable(const Ball& ball, const Scene&) { return 0.2 * ball.radius; }
double liftable(const Box& box, const Scene&) { return 0.2 * box.half_extents.minCoeff(); }
double liftable(const Capsule& capsule, const Scene&) { return 0.2 * capsule.radius; }
double liftable(const MeshBody& body, const Scene&) {
  return 0.1 * body.mesh->box().sizes().minCoeff();
}
double liftable(const Plane&, const Scene& scene) { return 0.04 * extent(scene); }

}  // namespace

RenderMesh collider_mesh(const Collider& collider, double t, const ColliderLook& look) {
  const Shape shape = shape_at(collider, t);
  if (const auto* ball = std::get_if<Ball>(&shape))
    return ball_mesh(*ball, look.inset, look.segments);
  if (const auto* box = std::get_if<Box>(&shape))
    return box_mesh(*box, look.inset, look.rounding, 2 * look.segments / 5);
  if (const auto* capsule = std::get_if<Capsule>(&shape))
    return capsule_mesh(*capsule, look.inset, look.segments);
  if (const auto* body = std::get_if<MeshBody>(&shape)) return body_mesh(*body, look.inset);
  return plane_mesh(std::get<Plane>(shape), look.inset, look.centre, look.reach,
                    2 * look.segments / 3);
}

void lift_out_of_colliders(RenderMesh& mesh, const Scene& scene, double t, double clearance) {
  bool lifted = false;
  for (const Collider& collider : scene.colliders) {
    const Shape shape = shape_at(collider, t);
    const double deepest = std::visit([&](const auto& s) { return liftable(s, scene); }, shape);
    for (std::size_t i = 0; i < mesh.position.size(); ++i) {
      const auto [distance, normal] = surface(shape, mesh.position[i].cast<double>());
      if (distance >= clearance || distance < -deepest) continue;
      mesh.position[i] += (normal * (clearance - distance)).cast<float>();
      lifted = true;
    }
  }
  if (lifted) mesh.compute_normals();
}

}  // namespace taut
