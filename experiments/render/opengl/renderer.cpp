#include "experiments/render/opengl/renderer.hpp"

#include <algorithm>
#include <array>

#include "core/model/input_error.hpp"
#include "experiments/render/opengl/shaders.hpp"

namespace taut {

namespace {

/// A vertex as the surface shader reads it.
struct Vertex {
  float position[3], normal[3], uv[2], data[2];
};

/// `lit` is the type of the shader (vertex or fragment) that sums up the lights, 0 if neither does.
GLuint compile(const GlContext& gl, const char* vertex, const char* fragment, GLenum lit = 0) {
  std::string log(2000, '\0');
  const auto length = static_cast<GLsizei>(log.size());
  const auto check = [&](GLint good) {
    if (!good) throw InputError(gl.description() + ": a shader is refused: " + log.c_str());
  };
  GLint good = 0;
  const GLuint program = glCreateProgram();
  for (const auto& [kind, body] : {std::pair{GLenum{GL_VERTEX_SHADER}, vertex},
                                   std::pair{GLenum{GL_FRAGMENT_SHADER}, fragment}}) {
    const GLuint shader = glCreateShader(kind);
    const char* parts[] = {kind == lit                  ? shaders::kLightCommon
                           : kind == GL_FRAGMENT_SHADER ? shaders::kFragmentCommon
                                                        : shaders::kVersion,
                           body};
    glShaderSource(shader, 2, parts, nullptr);
    glCompileShader(shader);
    glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
    glGetShaderInfoLog(shader, length, nullptr, log.data());
    check(good);
    glAttachShader(program, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program);
  glGetProgramiv(program, GL_LINK_STATUS, &good);
  glGetProgramInfoLog(program, length, nullptr, log.data());
  check(good);
  return program;
}

void set(GLuint program, const char* name, const Vec3f& v) {
  glUniform3f(glGetUniformLocation(program, name), v.x(), v.y(), v.z());
}
void set(GLuint program, const char* name, float value) {
  glUniform1f(glGetUniformLocation(program, name), value);
}
void set(GLuint program, const char* name, const Eigen::Matrix4f& m) {
  glUniformMatrix4fv(glGetUniformLocation(program, name), 1, GL_FALSE, m.data());
}

Vec3f as_vector(Rgb8 c) {
  return Vec3f(static_cast<float>(c.r), static_cast<float>(c.g), static_cast<float>(c.b)) / 255;
}
Vec3f as_linear(Rgb8 c) {
  return Eigen::Vector3d(linear_of(c.r), linear_of(c.g), linear_of(c.b)).cast<float>();
}

void append(std::vector<Vertex>& vertices, const RenderMesh& mesh) {
  for (std::size_t i = 0; i < mesh.position.size(); ++i) {
    const Vec3f &p = mesh.position[i], &n = mesh.normal[i];
    Vertex& v = vertices.emplace_back(
        Vertex{{p.x(), p.y(), p.z()}, {n.x(), n.y(), n.z()}, {}, {mesh.value[i], 0}});
    if (mesh.uv.empty()) continue;
    v.uv[0] = mesh.uv[i].x();
    v.uv[1] = mesh.uv[i].y();
    v.data[1] = mesh.hidden[i];
  }
}

/// Triangles lower than a pixel in a picture of `width` x `height` pixels: they may miss all
/// samples of a pixel.
std::vector<std::array<std::uint32_t, 3>> thinner_than_a_pixel(const RenderMesh& mesh,
                                                               const Eigen::Matrix4f& world_to_clip,
                                                               float width, float height) {
  std::vector<Eigen::Vector3f> seen;  // x, y in pixels, w
  for (const Vec3f& p : mesh.position) {
    const Eigen::Vector4f clip = world_to_clip * p.homogeneous();
    seen.emplace_back(0.5f * width * clip.x() / clip.w(), 0.5f * height * clip.y() / clip.w(),
                      clip.w());
  }
  std::vector<std::array<std::uint32_t, 3>> thin;
  for (const auto& triangle : mesh.triangles) {
    const auto &a = seen[triangle[0]], &b = seen[triangle[1]], &c = seen[triangle[2]];
    if (std::min({a.z(), b.z(), c.z()}) <= 0) continue;
    const Eigen::Vector2f ab = (b - a).head<2>(), ac = (c - a).head<2>(), bc = (c - b).head<2>();
    const float longest = std::max({ab.norm(), ac.norm(), bc.norm()});
    if (std::abs(ab.x() * ac.y() - ab.y() * ac.x()) < longest) thin.push_back(triangle);
  }
  return thin;
}

/// A texture with linear interpolation between texels; it stays bound.
GLuint make_texture(GLenum kind, GLint beyond) {
  GLuint texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(kind, texture);
  glTexParameteri(kind, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(kind, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(kind, GL_TEXTURE_WRAP_S, beyond);
  glTexParameteri(kind, GL_TEXTURE_WRAP_T, beyond);
  return texture;
}

template <class T>
void upload(GLenum target, GLuint buffer, const std::vector<T>& data) {
  glBindBuffer(target, buffer);
  glBufferData(target, static_cast<GLsizeiptr>(data.size() * sizeof(T)), data.data(),
               GL_STREAM_DRAW);
}

}  // namespace

Theme Theme::paper() {
  return {rgb(0xEFF0F4), rgb(0xE9EBEE), rgb(0x6A707C), rgb(0x3C424E), 0.72f, -0.05f};
}

Theme Theme::dark() {
  return {rgb(0x242A34), rgb(0x242A34), rgb(0x7A8496), rgb(0xC9D1DE), 0.8f, 0.035f};
}

Renderer::Renderer(const GlContext& gl, int width, int height, int supersampling,
                   const LightQuality& quality)
    : gl_(gl), width_(width), height_(height), supersampling_(supersampling), quality_(quality) {
  background_ = compile(gl, shaders::kBackgroundVertex, shaders::kBackgroundFragment);
  depth_ = compile(gl, shaders::kDepthVertex, shaders::kDepthFragment);
  ground_light_ =
      compile(gl, shaders::kBackgroundVertex, shaders::kGroundLightFragment, GL_FRAGMENT_SHADER);
  ground_ = compile(gl, shaders::kGroundVertex, shaders::kGroundFragment);
  surface_ = compile(gl, shaders::kSurfaceVertex, shaders::kSurfaceFragment, GL_VERTEX_SHADER);
  make_targets();
  make_light_maps();
  glGenVertexArrays(1, &layout_);
  glBindVertexArray(layout_);
  glGenBuffers(1, &vertices_);
  glGenBuffers(1, &indices_);
  glGenBuffers(1, &thin_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  const auto attribute = [&](GLuint index, GLint size, std::size_t offset) {
    glEnableVertexAttribArray(index);
    glVertexAttribPointer(index, size, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                          reinterpret_cast<const void*>(offset));
  };
  attribute(0, 3, offsetof(Vertex, position));
  attribute(1, 3, offsetof(Vertex, normal));
  attribute(2, 2, offsetof(Vertex, uv));
  attribute(3, 2, offsetof(Vertex, data));
  colours_ = make_texture(GL_TEXTURE_2D, GL_CLAMP_TO_EDGE);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
}

Renderer::~Renderer() {
  for (const GLuint program : {background_, depth_, ground_light_, ground_, surface_})
    glDeleteProgram(program);
  for (const GLuint framebuffer : {drawn_, resolved_, lit_}) glDeleteFramebuffers(1, &framebuffer);
  glDeleteRenderbuffers(3, buffers_);
  for (const GLuint buffer : {vertices_, indices_, thin_}) glDeleteBuffers(1, &buffer);
  glDeleteVertexArrays(1, &layout_);
  for (const GLuint texture : {colours_, ground_map_, depth_maps_}) glDeleteTextures(1, &texture);
}

void Renderer::make_targets() {
  GLint samples = 0;
  glGetIntegerv(GL_MAX_SAMPLES, &samples);
  samples = std::min(samples, 4);
  if (samples < 4) supersampling_ = std::max(supersampling_, 2);
  const GLsizei width = width_ * supersampling_, height = height_ * supersampling_;
  glGenFramebuffers(1, &drawn_);
  glGenFramebuffers(1, &resolved_);
  glGenRenderbuffers(3, buffers_);
  const auto attach = [&](GLuint buffer, GLsizei count, GLenum format, GLenum where) {
    glBindRenderbuffer(GL_RENDERBUFFER, buffer);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, count, format, width, height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, where, GL_RENDERBUFFER, buffer);
  };
  glBindFramebuffer(GL_FRAMEBUFFER, resolved_);
  attach(buffers_[2], 0, GL_RGBA8, GL_COLOR_ATTACHMENT0);
  glBindFramebuffer(GL_FRAMEBUFFER, drawn_);
  attach(buffers_[0], samples, GL_RGBA8, GL_COLOR_ATTACHMENT0);
  attach(buffers_[1], samples, GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw InputError(gl_.description() + ": no framebuffer of " + std::to_string(width) + " x " +
                     std::to_string(height) + " pixels");
}

/// The border of a depth map has the largest depth, so that nothing beyond the map casts a shadow.
void Renderer::make_light_maps() {
  const GLsizei side = quality_.depth_map, ground = quality_.ground_map;
  depth_maps_ = make_texture(GL_TEXTURE_2D_ARRAY, GL_CLAMP_TO_BORDER);
  glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_DEPTH_COMPONENT32F, side, side, quality_.lights, 0,
               GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
  const float farthest[] = {1, 1, 1, 1};
  glTexParameterfv(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_BORDER_COLOR, farthest);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  ground_map_ = make_texture(GL_TEXTURE_2D, GL_CLAMP_TO_EDGE);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_R32F, ground, ground, 0, GL_RED, GL_FLOAT, nullptr);
  glGenFramebuffers(1, &lit_);
}

Image Renderer::draw(const Panel& panel) const {
  glBindVertexArray(layout_);
  const std::vector<Range> ranges = upload(panel);
  draw_light(panel, ranges);
  glBindFramebuffer(GL_FRAMEBUFFER, drawn_);
  glViewport(0, 0, width_ * supersampling_, height_ * supersampling_);
  glClear(GL_DEPTH_BUFFER_BIT);
  const Eigen::Matrix4f world_to_clip =
      panel.camera.world_to_clip(static_cast<float>(width_) / static_cast<float>(height_));
  glDisable(GL_DEPTH_TEST);
  draw_background(panel.theme);
  glEnable(GL_DEPTH_TEST);
  draw_ground(panel, world_to_clip);
  for (std::size_t i = 0; i < ranges.size(); ++i)
    draw_mesh(panel, panel.painted[i], ranges[i], world_to_clip);
  return read();
}

std::vector<Renderer::Range> Renderer::upload(const Panel& panel) const {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<Range> ranges;
  for (const Painted& painted : panel.painted) {
    const RenderMesh& mesh = *painted.mesh;
    ranges.push_back(
        {vertices.size(), indices.size(), static_cast<GLsizei>(3 * mesh.triangles.size())});
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t corner : triangle)
        indices.push_back(static_cast<std::uint32_t>(vertices.size()) + corner);
    append(vertices, mesh);
  }
  taut::upload(GL_ARRAY_BUFFER, vertices_, vertices);
  taut::upload(GL_ELEMENT_ARRAY_BUFFER, indices_, indices);
  return ranges;
}

/// Transform from the world to a light's map: x and y are texture coordinates, z is depth, 0
/// nearest to the light.
Eigen::Matrix4f Renderer::to_map(const Light& light, const Sphere& casters) const {
  const Vec3f u = light.direction.unitOrthogonal(), v = light.direction.cross(u);
  const float across = static_cast<float>(quality_.depth_map - 4) /
                       static_cast<float>(quality_.depth_map) / (2 * casters.radius);
  Eigen::Matrix4f m = Eigen::Matrix4f::Identity();
  m.block<1, 3>(0, 0) = across * u.transpose();
  m.block<1, 3>(1, 0) = across * v.transpose();
  m.block<1, 3>(2, 0) = -1 / (2 * casters.radius) * light.direction.transpose();
  m.block<3, 1>(0, 3) = Vec3f::Constant(0.5f) - m.block<3, 3>(0, 0) * casters.centre;
  return m;
}

/// Each light's share is relative to the light that open, level ground receives.
void Renderer::set_lights(GLuint program, const Panel& panel) const {
  float open = 0;
  for (const Light& light : panel.lights)
    open += light.weight * std::max(0.0f, panel.ground.up.dot(light.direction));
  std::vector<Eigen::Vector4f> lights;
  std::vector<Eigen::Matrix4f> maps;
  for (const Light& light : panel.lights) {
    lights.emplace_back();
    lights.back() << light.direction, light.weight / open;
    maps.push_back(to_map(light, panel.casters));
  }
  const auto count = static_cast<GLsizei>(lights.size());
  const auto texels = static_cast<float>(quality_.depth_map - 4);
  glUseProgram(program);
  glUniform1i(glGetUniformLocation(program, "lights"), count);
  glUniform4fv(glGetUniformLocation(program, "light"), count, lights.front().data());
  glUniformMatrix4fv(glGetUniformLocation(program, "to_map"), count, GL_FALSE, maps.front().data());
  set(program, "texel", 2 * panel.casters.radius / texels);
  set(program, "bias", 1 / texels);
  glUniform1i(glGetUniformLocation(program, "depth_maps"), 1);
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D_ARRAY, depth_maps_);
  glActiveTexture(GL_TEXTURE0);
}

/// Draws the depth map of each light, then the light on the ground.
void Renderer::draw_light(const Panel& panel, const std::vector<Range>& ranges) const {
  glBindFramebuffer(GL_FRAMEBUFFER, lit_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, 0, 0);
  glDrawBuffer(GL_NONE);
  glViewport(0, 0, quality_.depth_map, quality_.depth_map);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_DEPTH_CLAMP);
  glEnable(GL_POLYGON_OFFSET_FILL);  // keeps surfaces at a grazing angle from shading themselves
  glPolygonOffset(1.5f, 0);
  glUseProgram(depth_);
  const GLsizei indices = static_cast<GLsizei>(ranges.back().first_index) + ranges.back().indices;
  for (std::size_t k = 0; k < panel.lights.size(); ++k) {
    glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, depth_maps_, 0,
                              static_cast<GLint>(k));
    glClear(GL_DEPTH_BUFFER_BIT);
    set(depth_, "to_map", to_map(panel.lights[k], panel.casters));
    glDrawElements(GL_TRIANGLES, indices, GL_UNSIGNED_INT, nullptr);
  }
  glDisable(GL_POLYGON_OFFSET_FILL);
  glDisable(GL_DEPTH_CLAMP);
  glDisable(GL_DEPTH_TEST);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, 0, 0);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, ground_map_, 0);
  glDrawBuffer(GL_COLOR_ATTACHMENT0);
  glViewport(0, 0, quality_.ground_map, quality_.ground_map);
  set_lights(ground_light_, panel);
  set(ground_light_, "origin", panel.ground.origin);
  set(ground_light_, "u", panel.ground.u);
  set(ground_light_, "v", panel.ground.v);
  set(ground_light_, "up", panel.ground.up);
  set(ground_light_, "half_side", panel.ground.half_side);
  set(ground_light_, "size", static_cast<float>(quality_.ground_map));
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void Renderer::draw_background(const Theme& theme) const {
  glUseProgram(background_);
  set(background_, "top", as_vector(theme.top));
  set(background_, "bottom", as_vector(theme.bottom));
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void Renderer::draw_ground(const Panel& panel, const Eigen::Matrix4f& world_to_clip) const {
  const Ground& ground = panel.ground;
  glBindTexture(GL_TEXTURE_2D, ground_map_);
  glUseProgram(ground_);
  set(ground_, "world_to_clip", world_to_clip);
  set(ground_, "origin", ground.origin);
  set(ground_, "u", ground.u);
  set(ground_, "v", ground.v);
  set(ground_, "reach", 3 * ground.half_side);
  set(ground_, "half_side", ground.half_side);
  set(ground_, "shadow", panel.theme.shadow);
  set(ground_, "line", panel.theme.line);
  set(ground_, "cell", panel.ground_cell);
  set(ground_, "line_width", 1.4f * static_cast<float>(supersampling_));
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_SRC_ALPHA);
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  glDisable(GL_BLEND);
}

void Renderer::draw_mesh(const Panel& panel, const Painted& painted, const Range& range,
                         const Eigen::Matrix4f& world_to_clip) const {
  const std::vector<Rgb8>& table = panel.scale.map().table();
  glBindTexture(GL_TEXTURE_2D, colours_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, static_cast<GLsizei>(table.size()), 1, 0, GL_RGB,
               GL_UNSIGNED_BYTE, table.data());
  set_lights(surface_, panel);
  set(surface_, "world_to_clip", world_to_clip);
  set(surface_, "eye", panel.camera.eye);
  set(surface_, "up", panel.ground.up);
  glUniform2f(glGetUniformLocation(surface_, "range"), static_cast<float>(panel.scale.low()),
              static_cast<float>(panel.scale.high));
  const Vec3f colour = as_linear(painted.colour.value_or(Rgb8{}));
  glUniform4f(glGetUniformLocation(surface_, "colour"), colour.x(), colour.y(), colour.z(),
              painted.colour ? 1.0f : 0.0f);
  set(surface_, "spacing", static_cast<float>(painted.grid_spacing));
  set(surface_, "hatch_depth", panel.hatch_depth);
  set(surface_, "line_width", 1.3f * static_cast<float>(supersampling_));
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  glDrawElements(GL_TRIANGLES, range.indices, GL_UNSIGNED_INT,
                 reinterpret_cast<const void*>(range.first_index * sizeof(std::uint32_t)));
  if (painted.colour) return;
  // Triangles too thin to be filled are drawn by their edges, a pixel wide, so that cloth never
  // vanishes.
  auto thin = thinner_than_a_pixel(*painted.mesh, world_to_clip, static_cast<float>(width_),
                                   static_cast<float>(height_));
  if (thin.empty()) return;
  for (auto& triangle : thin)
    for (std::uint32_t& corner : triangle) corner += static_cast<std::uint32_t>(range.first_vertex);
  taut::upload(GL_ELEMENT_ARRAY_BUFFER, thin_, thin);
  glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
  glLineWidth(static_cast<float>(supersampling_));
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * thin.size()), GL_UNSIGNED_INT, nullptr);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

Image Renderer::read() const {
  const GLsizei width = width_ * supersampling_, height = height_ * supersampling_;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, drawn_);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_);
  glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, resolved_);
  std::vector<Rgb8> pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, pixels.data());
  Image image(width, height);
  for (int y = 0; y < height; ++y)  // rows of OpenGL start at the bottom
    std::copy_n(pixels.begin() + std::ptrdiff_t{y} * width, width, &image.at(0, height - 1 - y));
  return shrunk(image, supersampling_);
}

}  // namespace taut
