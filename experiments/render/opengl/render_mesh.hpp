#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/model/scene.hpp"
#include "experiments/render/opengl/camera.hpp"

namespace taut {

/// A surface to be drawn: triangles with what the shader needs at each vertex.
struct RenderMesh {
  std::vector<Vec3f> position;      ///< m
  std::vector<Vec3f> normal;        ///< unit
  std::vector<Eigen::Vector2f> uv;  ///< of a sheet: material coordinates in quads
  std::vector<float> hidden;        ///< of a sheet: particles' depth below a collider [m]
  std::vector<float> value;         ///< the quantity that colours it, SI
  std::vector<std::array<std::uint32_t, 3>> triangles;

  /// Area-weighted means of the faces' normals.
  void compute_normals();
};

/// Makes the mesh of one scene's cloth again and again: what does not move is computed once.
/// A sheet is drawn as the Catmull-Rom surface through its particles (it passes through each of
/// them), a mesh as it is, cloth without triangles as a tube along its links.
class ClothMesher {
 public:
  /// `finest`: at most this many quads along a side; coarser sheets are refined towards it.
  ClothMesher(const Scene&, int finest);
  /// Preconditions: x, values and depths (below colliders, m) have the scene's size; x is finite.
  RenderMesh mesh(const std::vector<Vec3>& x, const std::vector<double>& values,
                  const std::vector<double>& depths) const;
  /// Quads between two lines of the material grid; 0: no grid.
  int grid_spacing() const { return grid_spacing_; }
  /// Of a link [m].
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
  double inset = 0;            ///< m that they are smaller, so that cloth on them is not pierced
  double rounding = 0;         ///< m: radius of a box's edges, which coarse triangles cut
  Vec3 centre = Vec3::Zero();  ///< planes are a square patch around this point
  double reach = 1;            ///< m, half its side
  int segments = 72;           ///< of a full circle; flat faces have pieces in proportion
};
/// A collider at its place at time t.
RenderMesh collider_mesh(const Collider&, double t, const ColliderLook&);

/// Moves what is less than `clearance` [m] outside a collider, or inside but not deep, to just
/// outside: cloth that sinks into a ball stays visible, the renderer hatches it by `hidden`.
void lift_out_of_colliders(RenderMesh&, const Scene&, double t, double clearance);

/// A ball of this radius [m]: a pin, a bead.
void append_ball(RenderMesh&, const Vec3f& centre, float radius, int segments, float value);

}  // namespace taut
