#pragma once

#include <optional>
#include <vector>

#include "experiments/render/image/colour.hpp"
#include "experiments/render/opengl/camera.hpp"
#include "experiments/render/opengl/gl.hpp"
#include "experiments/render/opengl/light.hpp"
#include "experiments/render/opengl/render_mesh.hpp"

namespace taut {

/// Appearance of everything but the cloth.
struct Theme {
  Rgb8 top, bottom;     ///< ends of a vertical gradient behind the scene
  Rgb8 collider;        ///< when fully lit
  Rgb8 pin;             ///< when fully lit
  float shadow = 0.7f;  ///< share of the missing light by which the ground darkens in shadow
  /// Ground lines: > 0 is added to the background, < 0 darkens it by this share.
  float line = 0;

  static Theme paper();  ///< light, for papers
  static Theme dark();   ///< #242A34, for the report in both its light and its dark theme
};

/// A mesh and its paint: its values or one colour.
struct Painted {
  const RenderMesh* mesh = nullptr;
  std::optional<Rgb8> colour;  ///< empty: coloured by value
  int grid_spacing = 0;        ///< quads between material lines; 0: none
};

/// Everything that one panel shows.
struct Panel {
  Camera camera;
  Theme theme;
  ColourScale scale;
  std::vector<Painted> painted;
  Ground ground;
  std::vector<Light> lights;
  Sphere casters;             ///< contains all that casts shadows
  float ground_cell = 0.25f;  ///< m between lines of the ground
  float hatch_depth = 0;      ///< m: cloth hidden deeper than this is hatched
};

/// Draws panels of one size with OpenGL: first a depth map of all meshes for each light, then the
/// light that reaches the ground and every vertex, then the picture. The picture has 4x
/// multisampling where the driver supports it, times `supersampling` squared. Open cloth that faces
/// the sky shows exactly the colour of the colour bar.
class Renderer {
 public:
  /// Throws InputError if the driver refuses. The context has to stay current and outlive the
  /// renderer.
  Renderer(const GlContext&, int width, int height, int supersampling, const LightQuality&);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;
  Image draw(const Panel&) const;

 private:
  /// Place of one mesh in the shared vertex and index buffers.
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
  int width_, height_, supersampling_;  ///< width and height of the picture in pixels
  LightQuality quality_;
  GLuint background_ = 0, depth_ = 0, ground_light_ = 0, ground_ = 0, surface_ = 0;  ///< programs
  GLuint drawn_ = 0, resolved_ = 0, lit_ = 0;  ///< framebuffers
  GLuint buffers_[3] = {};  ///< renderbuffers of drawn_ (colour, depth) and resolved_ (colour)
  GLuint vertices_ = 0, indices_ = 0, thin_ = 0, layout_ = 0;
  GLuint colours_ = 0, ground_map_ = 0, depth_maps_ = 0;  ///< textures
};

}  // namespace taut
