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

/// One solver's run of a scene as the renderer shows it: stable frames only, and why they end
/// early.
struct RecordedRun {
  struct Stop {
    double t = 0;     ///< s, of the last stable frame
    std::string why;  ///< "exploded"
  };
  std::string title;     ///< "Jakobsen"
  std::string settings;  ///< "1 × 16, order=mesh": substeps × sweeps first
  Rgb8 colour;           ///< the solver's throughout a report
  Trajectory trajectory;
  std::optional<Stop> stop;

  /// The frame nearest to t: the last one if the run ended before. Precondition: frames exist.
  const Frame& at(double t) const;
};

/// Drops everything from the first frame that is not finite or lies more than `reach` extents of
/// the scene from where the cloth started, and says so in `stop`; so it does when the file ends
/// before the scene does. Throws InputError if no stable frame is left.
RecordedRun recorded_run(const Scene&, Trajectory, double reach = 50);

/// The quantity at each vertex [n], SI. Strain is the mean of the structural and shear links at the
/// vertex (bend links shorten when cloth folds, which is no strain); speed needs State::v.
std::vector<double> vertex_values(const Scene&, ColourBy, const State&, double t);

/// What a caption says about one moment. Strains are those of the metric `stretch`: structural and
/// shear links, links between two pins left out.
struct LiveFigures {
  double max_strain = 0;   ///< largest |strain|
  double mean_strain = 0;  ///< signed
  double rms_strain = 0;
  double max_depth = 0;  ///< m, deepest vertex below a collider
  double max_speed = 0;  ///< m/s
};
LiveFigures live_figures(const Scene&, const State&, double t);

/// Where camera, ground and the region of interest stand: the same for all runs and all moments of
/// a picture or video.
struct Placing {
  Vec3 up = Vec3::UnitY();
  Camera camera;                    ///< relative to the cloth's centroid if it follows
  bool follows = false;             ///< the camera moves with cloth that nothing holds
  Vec3 centre = Vec3::Zero();       ///< m, of what is seen, relative likewise
  double radius = 1;                ///< m, of what is seen
  double ground = 0;                ///< m, height along up
  double cell = 0.25;               ///< m between ground lines
  double inset = 0;                 ///< m, of colliders
  const Collider* floor = nullptr;  ///< a level plane at rest: it is the ground

  /// The ground below a point.
  Ground floor_below(const Vec3& point) const;
  /// Behind cloth that the camera follows: lines that stay where they are in the world, so that the
  /// motion is seen.
  Ground wall(const Vec3& point) const;
};

/// Mean position of all runs' vertices at time t [m].
Vec3 centroid(const std::vector<RecordedRun>&, double t);

/// Frames what happens at `times` in a picture of this width / height. Cloth that is held or has
/// something to land on is expected to stay near; what slips off or stretches away leaves the
/// picture rather than shrinking all the rest. `inset` [m] is that of colliders.
Placing place(const Scene&, const std::vector<RecordedRun>&, const std::vector<double>& times,
              const View&, const FitRegion&, double aspect, double inset);

/// Presets of cost and beauty.
struct RenderQuality {
  LightQuality light;
  int supersampling = 1;
  int finest_sheet = 64;  ///< quads along a side after refinement
  int segments = 72;      ///< of a circle of a collider; pins have a quarter of them

  static RenderQuality draft() { return {{9, 96, 64}, 1, 33, 40}; }
  static RenderQuality video() { return {{12, 128, 96}, 1, 66, 60}; }
  static RenderQuality still() { return {{96, 256, 224}, 2, 132, 72}; }
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
  /// Of a run that has ended it is drawn once.
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
  Image draw(const Frame&) const;
  /// Cloth, colliders, pins; in this order.
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
  mutable std::vector<Drawn> last_;  ///< of each run
};

}  // namespace taut
