#pragma once

#include <limits>

#include "experiments/render/opengl/renderer.hpp"
#include "experiments/render/picture/placing.hpp"
#include "experiments/render/picture/recorded_run.hpp"
#include "experiments/render/picture/vertex_values.hpp"

namespace taut {

/// Presets of cost and beauty.
struct RenderQuality {
  LightQuality light;
  int supersampling = 1;
  int finest_sheet = 64;  ///< quads along a side after refinement

  static RenderQuality draft() { return {{6, 192, 64}, 1, 33}; }
  static RenderQuality video() { return {{32, 256, 112}, 1, 66}; }
  static RenderQuality still() { return {{96, 512, 224}, 2, 132}; }
};

struct SceneRendererOptions {
  int width = 960, height = 836;  ///< of one panel, pixels
  Theme theme = Theme::paper();
  RenderQuality quality = RenderQuality::still();
  View view;
  FitRegion frame;  ///< what the scene has to fill of the panel
  ColourBy colour_by = ColourBy::strain;
  double range = 0;  ///< end of the colour bar, SI; 0: chosen from the runs
  /// s: what the camera and the colour bar have to fit
  double from = 0, to = std::numeric_limits<double>::infinity();
};

/// Draws any moment of several runs of one scene under the same camera, light and colour scale.
class SceneRenderer {
 public:
  /// The scene and the runs outlive the renderer. Throws InputError without a renderer.
  SceneRenderer(const Scene&, const std::vector<RecordedRun>&, const SceneRendererOptions&);
  const ColourScale& scale() const { return scale_; }
  const std::vector<RecordedRun>& runs() const { return runs_; }
  const Scene& scene() const { return scene_; }
  const SceneRendererOptions& options() const { return options_; }
  /// Depth [m] below a collider from which cloth is hatched: 0.2 % of the scene's extent.
  double hatch_depth() const { return 0.002 * extent(scene_); }
  Image panel(std::size_t run, double t) const;
  /// Where its vertices lie in the panel: x and y from -1 to 1, y upwards.
  std::vector<Eigen::Vector2f> projected(std::size_t run, double t) const;
  /// Some vertex of it lies in the panel.
  bool in_sight(std::size_t run, double t) const;
  /// Colours of a sheet laid flat: one pixel block per vertex, no light. Empty image: no sheet.
  Image material_space(std::size_t run, double t, int longest_side) const;

 private:
  void choose_scale();
  std::vector<double> sampled_times() const;
  /// Cloth, colliders, pins; in this order.
  std::vector<RenderMesh> meshes(const TrajectoryReader::Frame&, const Vec3& centre) const;
  const Scene& scene_;
  const std::vector<RecordedRun>& runs_;
  SceneRendererOptions options_;
  ColourScale scale_;
  ClothMesher mesher_;
  GlContext gl_;
  Renderer renderer_;
  Placing placing_;
  std::vector<Light> lights_;
};

}  // namespace taut
