#include <algorithm>

#include "experiments/render/opengl/render_mesh.hpp"

namespace taut {

namespace {

RenderMesh ball_mesh(const Ball& ball, double inset) {
  RenderMesh mesh;
  append_ball(mesh, ball.center.cast<float>(),
              static_cast<float>(std::max(ball.radius - inset, 0.5 * ball.radius)), 72, 0);
  return mesh;
}

/// A box whose edges are rounded by `radius`: points of the cube's faces, pulled to within the
/// smaller box and pushed out by the radius.
RenderMesh box_mesh(const Box& box, double inset, double rounding) {
  constexpr int kPieces = 28;
  const Vec3 half = (box.half_extents.array() - inset).max(box.half_extents.array() * 0.5);
  const double radius = std::min(rounding, 0.4 * half.minCoeff());
  const Vec3 inner = half.array() - radius;
  RenderMesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      const auto first = static_cast<std::uint32_t>(mesh.position.size());
      // Points crowd towards the edges, where the rounding is.
      const auto place = [](int k) {
        const double s = 2.0 * k / kPieces - 1;
        return s * (1.5 - 0.5 * s * s);
      };
      for (int j = 0; j <= kPieces; ++j)
        for (int i = 0; i <= kPieces; ++i) {
          Vec3 p;
          p[axis] = sign * half[axis];
          p[(axis + 1) % 3] = place(i) * half[(axis + 1) % 3];
          p[(axis + 2) % 3] = place(j) * half[(axis + 2) % 3];
          const Vec3 core = p.cwiseMax(-inner).cwiseMin(inner);
          const Vec3 out = (p - core).normalized();
          mesh.position.push_back(
              (box.center + box.rotation * (core + radius * out)).cast<float>());
          mesh.normal.push_back((box.rotation * out).cast<float>());
          mesh.value.push_back(0);
        }
      constexpr std::uint32_t row = kPieces + 1;
      for (std::uint32_t j = 0; j < kPieces; ++j)
        for (std::uint32_t i = 0; i < kPieces; ++i) {
          const std::uint32_t a = first + j * row + i;
          mesh.triangles.push_back({a, a + 1, a + row});
          mesh.triangles.push_back({a + 1, a + row + 1, a + row});
        }
    }
  return mesh;
}

RenderMesh plane_mesh(const Plane& plane, double inset, const Vec3& centre, double reach) {
  constexpr int kPieces = 48;
  const Vec3 u = plane.normal.unitOrthogonal(), v = plane.normal.cross(u);
  const Vec3 foot = centre - plane.normal * (plane.normal.dot(centre) - plane.offset + inset);
  RenderMesh mesh;
  for (int j = 0; j <= kPieces; ++j)
    for (int i = 0; i <= kPieces; ++i) {
      const double a = reach * (2.0 * i / kPieces - 1), b = reach * (2.0 * j / kPieces - 1);
      mesh.position.push_back((foot + a * u + b * v).cast<float>());
      mesh.normal.push_back(plane.normal.cast<float>());
      mesh.value.push_back(0);
    }
  constexpr std::uint32_t row = kPieces + 1;
  for (std::uint32_t j = 0; j < kPieces; ++j)
    for (std::uint32_t i = 0; i < kPieces; ++i) {
      const std::uint32_t a = j * row + i;
      mesh.triangles.push_back({a, a + 1, a + row});
      mesh.triangles.push_back({a + 1, a + row + 1, a + row});
    }
  return mesh;
}

/// The depth [m] up to which it is clear on which side of the collider cloth belongs.
double liftable(const Ball& ball, const Scene&) { return 0.2 * ball.radius; }
double liftable(const Box& box, const Scene&) { return 0.2 * box.half_extents.minCoeff(); }
double liftable(const Plane&, const Scene& scene) { return 0.04 * extent(scene); }

}  // namespace

RenderMesh collider_mesh(const Collider& collider, double t, const ColliderLook& look) {
  const Shape shape = shape_at(collider, t);
  RenderMesh mesh;
  if (const auto* ball = std::get_if<Ball>(&shape))
    mesh = ball_mesh(*ball, look.inset);
  else if (const auto* box = std::get_if<Box>(&shape))
    mesh = box_mesh(*box, look.inset, look.rounding);
  else
    mesh = plane_mesh(std::get<Plane>(shape), look.inset, look.centre, look.reach);
  mesh.uv.assign(mesh.position.size(), Eigen::Vector2f::Zero());
  mesh.hidden.assign(mesh.position.size(), 0);
  return mesh;
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
