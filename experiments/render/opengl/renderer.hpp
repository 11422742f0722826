#pragma once

#include <optional>
#include <vector>

#include "experiments/render/image/colour.hpp"
#include "experiments/render/opengl/camera.hpp"
#include "experiments/render/opengl/gl.hpp"
#include "experiments/render/opengl/light.hpp"
#include "experiments/render/opengl/render_mesh.hpp"

namespace taut {

/// The surroundings of the cloth.
struct Theme {
  Rgb8 top, bottom;     ///< background, a vertical gradient
  Rgb8 collider;        ///< lit fully
  Rgb8 pin;             ///< lit fully
  float shadow = 0.7f;  ///< how much of the missing light the ground shows
  float line = 0;  ///< of the ground: > 0 is added to the background, < 0 darkens it by this share

  static Theme paper();  ///< light, for papers
  static Theme dark();   ///< #242A34, for the report in both of its themes
};

/// A mesh and how to paint it: by its values, or in one colour.
struct Painted {
  const RenderMesh* mesh = nullptr;
  std::optional<Rgb8> colour;  ///< disengaged: by value
  int grid_spacing = 0;        ///< quads between material lines; 0: none
};

/// One panel to be drawn.
struct Panel {
  Camera camera;
  Theme theme;
  ColourScale scale;
  std::vector<Painted> painted;
  Ground ground;
  std::vector<Light> lights;
  Sphere casters;             ///< of shadows
  float ground_cell = 0.25f;  ///< m between lines of the ground
  float hatch_depth = 0;      ///< m: cloth hidden deeper than this is hatched
};

/// Draws panels of one size with OpenGL: for each light a depth map of all meshes, then the light
/// that reaches the ground and every vertex, then the picture with 4x multisampling where the
/// driver has it, times `supersampling` squared. Cloth that is open and faces the sky shows the
/// exact colour of its bar.
class Renderer {
 public:
  /// Throws InputError if the driver refuses. The context stays current and outlives the renderer.
  Renderer(const GlContext&, int width, int height, int supersampling, const LightQuality&);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;
  Image draw(const Panel&) const;

 private:
  /// Where a mesh lies among the vertices and indices of all.
  struct Range {
    std::size_t first_vertex = 0, first_index = 0;
    GLsizei indices = 0;
  };
  void make_targets();
  void make_light_maps();
  std::vector<Range> upload(const Panel&) const;
  void draw_light(const Panel&, const std::vector<Range>&) const;
  void set_lights(GLuint program, const Panel&) const;
  Eigen::Matrix4f to_map(const Light&, const Sphere& casters) const;
  void draw_background(const Theme&) const;
  void draw_ground(const Panel&, const Eigen::Matrix4f& world_to_clip) const;
  void draw_mesh(const Panel&, const Painted&, const Range&,
                 const Eigen::Matrix4f& world_to_clip) const;
  Image read() const;
  const GlContext& gl_;
  int width_, height_, supersampling_;  ///< of the picture, in pixels
  LightQuality quality_;
  GLuint background_ = 0, depth_ = 0, ground_light_ = 0, ground_ = 0, surface_ = 0;  ///< programs
  GLuint drawn_ = 0, resolved_ = 0, lit_ = 0;  ///< framebuffers
  GLuint buffers_[3] = {};                     ///< of the first two: colour, depth, colour
  GLuint vertices_ = 0, indices_ = 0, thin_ = 0, layout_ = 0;
  GLuint colours_ = 0, ground_map_ = 0, depth_maps_ = 0;  ///< textures
};

}  // namespace taut
