#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/model/scene.hpp"
#include "experiments/case/trajectory.hpp"
#include "experiments/render/image/colour.hpp"
#include "experiments/render/opengl/light.hpp"
#include "experiments/render/opengl/renderer.hpp"

namespace taut {

/// One solver's run of a scene as the renderer shows it: the stable frames, and why they end early.
struct RecordedRun {
  struct Stop {
    double t = 0;     ///< s, of the last stable frame
    std::string why;  ///< "exploded"
  };
  std::string title;     ///< "Jakobsen"
  std::string settings;  ///< "1 × 16, order=mesh": substeps × sweeps first
  Rgb8 colour;           ///< the solver's colour throughout a report
  Trajectory trajectory;
  std::optional<Stop> stop;

  /// The frame nearest to t; the last one if the run ended before t. Precondition: frames exist.
  const Frame& at(double t) const;
};

/// Drops all frames from the first one that is not finite or lies too far from the start of the
/// cloth: `reach` extents of the scene plus |gravity| x duration^2. `stop` records this, and also a
/// trajectory that ends before the scene does. Throws InputError if no stable frame is left.
RecordedRun recorded_run(const Scene&, Trajectory, double reach = 50);

/// The quantity at each vertex [n], in SI units. Strain is the mean over the structural and shear
/// links at the vertex; bend links are left out because they shorten when cloth folds, which is not
/// strain. Speed needs State::v.
std::vector<double> vertex_values(const Scene&, ColourBy, const State&, double t);

/// Numbers for the caption of one moment. Strains are those of the metric `stretch`: structural and
/// shear links, without links between two pins.
struct LiveFigures {
  double max_strain = 0;   ///< largest |strain|
  double mean_strain = 0;  ///< signed
  double rms_strain = 0;
  double max_depth = 0;  ///< m, deepest vertex below a collider
  double max_speed = 0;  ///< m/s
};
LiveFigures live_figures(const Scene&, const State&, double t);

/// Camera, ground and region of interest, shared by all runs and all moments of a picture or video.
struct Placing {
  Vec3 up = Vec3::UnitY();
  Camera camera;                    ///< relative to the cloth's centroid if `follows`
  bool follows = false;             ///< the camera moves with cloth that nothing holds
  Vec3 centre = Vec3::Zero();       ///< m, of the region of interest, relative as the camera is
  double radius = 1;                ///< m, of the region of interest
  double ground = 0;                ///< m, height along up
  double cell = 0.25;               ///< m between ground lines
  double inset = 0;                 ///< m by which colliders are drawn smaller
  const Collider* floor = nullptr;  ///< a level plane at rest, drawn as the ground

  /// The level ground below a point.
  Ground floor_below(const Vec3& point) const;
  /// A wall behind cloth that the camera follows. Its lines stay fixed in the world, so that the
  /// motion is visible.
  Ground wall(const Vec3& point) const;
};

/// Mean position of all runs' vertices at time t [m].
Vec3 centroid(const std::vector<RecordedRun>&, double t);

/// Frames the action at `times` in a picture with this aspect ratio (width / height). Cloth that is
/// held or has something to land on is expected to stay near: parts that slip off or stretch away
/// leave the picture, since showing them would shrink all the rest. Colliders are drawn smaller by
/// `inset` [m].
Placing place(const Scene&, const std::vector<RecordedRun>&, const std::vector<double>& times,
              const View&, const FitRegion&, double aspect, double inset);

/// Trade-off between cost and picture quality.
struct RenderQuality {
  LightQuality light;
  int supersampling = 1;
  int finest_sheet = 64;  ///< quads along a side after refinement
  int segments = 72;      ///< of a collider's full circle; pins have a quarter of them

  static RenderQuality draft() { return {{9, 96, 64}, 1, 33, 40}; }
  static RenderQuality video() { return {{12, 128, 96}, 1, 66, 60}; }
  static RenderQuality still() { return {{96, 256, 224}, 2, 132, 72}; }
};

struct SceneRendererOptions {
  int width = 960, height = 836;  ///< of one panel, pixels
  Theme theme = Theme::paper();
  RenderQuality quality = RenderQuality::still();
  View view;
  FitRegion frame;  ///< the part of the panel that the scene has to fill
  ColourBy colour_by = ColourBy::strain;
  double range = 0;  ///< end of the colour bar, SI; 0: chosen from the runs
  /// s: time span that the camera and the colour bar have to fit
  double from = 0, to = std::numeric_limits<double>::infinity();
};

/// Draws any moment of several runs of one scene under the same camera, light and colour scale.
class SceneRenderer {
 public:
  /// The scene and the runs have to outlive the renderer. Throws InputError without OpenGL.
  SceneRenderer(const Scene&, const std::vector<RecordedRun>&, const SceneRendererOptions&);
  const ColourScale& scale() const { return scale_; }
  const std::vector<RecordedRun>& runs() const { return runs_; }
  const Scene& scene() const { return scene_; }
  const SceneRendererOptions& options() const { return options_; }
  /// Depth [m] below a collider beyond which cloth is hatched: 0.2 % of the scene's extent.
  double hatch_depth() const { return 0.002 * extent(scene_); }
  /// The panel of a run at time t. Consecutive calls for the same frame draw it once.
  Image panel(std::size_t run, double t) const;
  /// Positions of a run's vertices in its panel: x and y from -1 to 1, y upwards. Vertices behind
  /// the camera are left out.
  std::vector<Eigen::Vector2f> projected(std::size_t run, double t) const;
  /// True if some vertex of the run lies in the panel.
  bool in_sight(std::size_t run, double t) const;
  /// Colours of a sheet laid flat, interpolated between its vertices and without light. The image
  /// is empty if the cloth is not a sheet.
  Image material_space(std::size_t run, double t, int longest_side) const;

 private:
  void choose_scale();
  std::vector<double> sampled_times() const;
  Image draw(const Frame&) const;
  /// Meshes of the cloth, the colliders and the pins, in this order.
  std::vector<RenderMesh> meshes(const Frame&, const Vec3& centre) const;
  const Scene& scene_;
  const std::vector<RecordedRun>& runs_;
  SceneRendererOptions options_;
  ColourScale scale_;
  ClothMesher mesher_;
  GlContext gl_;
  Renderer renderer_;
  Placing placing_;
  std::vector<Light> lights_;
  struct Drawn {
    const Frame* frame = nullptr;
    Image image;
  };
  mutable std::vector<Drawn> last_;  ///< the panel drawn last, for each run
};

}  // namespace taut
