#pragma once

#include <vector>

#include "experiments/render/opengl/render_mesh.hpp"

namespace taut {

/// What a distant light sees: the nearest surface along its direction, in an orthographic map that
/// covers a sphere.
class DepthMap {
 public:
  DepthMap(int size, const Vec3f& direction, const Vec3f& centre, float radius);
  /// Starts again for another light.
  void aim(const Vec3f& direction);
  void draw(const RenderMesh&);
  /// Share of the four texels around p that see the light; p is moved towards it by one texel.
  /// Outside the map: 1.
  float visibility(const Vec3f& p) const;
  float texel() const { return 1 / scale_; }  ///< m

 private:
  void draw_triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c);
  int size_;
  Vec3f centre_;
  float scale_;  ///< texels per metre
  Eigen::Matrix3f axes_;
  std::vector<float> depth_;
  std::vector<Vec3f> projected_;
};

}  // namespace taut
