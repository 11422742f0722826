#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/model/scene.hpp"
#include "experiments/render/opengl/camera.hpp"

namespace taut {

/// A surface to draw: triangles, with the data that the shader needs at each vertex.
struct RenderMesh {
  std::vector<Vec3f> position;      ///< m
  std::vector<Vec3f> normal;        ///< unit
  std::vector<Eigen::Vector2f> uv;  ///< of a sheet only: material coordinates in quads
  std::vector<float> hidden;  ///< of a sheet only: depth of its particles below a collider [m]
  std::vector<float> value;   ///< the quantity that colours it, SI
  std::vector<std::array<std::uint32_t, 3>> triangles;

  /// Sets the normals to the area-weighted means of the faces' normals.
  void compute_normals();
};

/// Makes meshes of one scene's cloth, and computes only once what does not change between them. A
/// sheet is drawn as the Catmull-Rom surface through its particles, a mesh as it is, and cloth
/// without triangles as a tube along its links.
class ClothMesher {
 public:
  /// `finest`: most quads along a side. Coarser sheets are refined up to it.
  ClothMesher(const Scene&, int finest);
  /// Preconditions: x, values and depths (below colliders, m) have the scene's size; x is finite.
  RenderMesh mesh(const std::vector<Vec3>& x, const std::vector<double>& values,
                  const std::vector<double>& depths) const;
  /// Quads between two lines of the material grid; 0 if there is no grid.
  int grid_spacing() const { return grid_spacing_; }
  /// Mean rest length of the links [m].
  double mean_rest_length() const { return mean_rest_; }

 private:
  RenderMesh sheet(const std::vector<Vec3>& x, const std::vector<double>& values,
                   const std::vector<double>& depths) const;
  RenderMesh faces(const std::vector<Vec3>& x, const std::vector<double>& values) const;
  RenderMesh tube(const std::vector<Vec3>& x, const std::vector<double>& values) const;
  const Scene& scene_;
  int refinement_ = 1;  ///< pieces per quad side
  int grid_spacing_ = 0;
  double mean_rest_ = 0;
};

/// How colliders are drawn.
struct ColliderLook {
  /// m by which colliders are drawn smaller, so that they do not pierce cloth that lies on them.
  double inset = 0;
  /// m: radius of a box's edges, so that coarse triangles of cloth do not cut into them.
  double rounding = 0;
  Vec3 centre = Vec3::Zero();  ///< a plane is drawn as a square patch around this point
  double reach = 1;            ///< m, half the side of that patch
  int segments = 72;           ///< of a full circle; flat faces get a proportional number
};
/// A collider at its place at time t.
RenderMesh collider_mesh(const Collider&, double t, const ColliderLook&);

/// Moves vertices that lie less than `clearance` [m] outside a collider, or slightly inside it, to
/// `clearance` outside. Cloth that sinks into a ball thus stays visible; the renderer hatches it
/// according to `hidden`.
void lift_out_of_colliders(RenderMesh&, const Scene&, double t, double clearance);

/// Adds a ball of this radius [m], for a pin or a bead.
void append_ball(RenderMesh&, const Vec3f& centre, float radius, int segments, float value);

}  // namespace taut
