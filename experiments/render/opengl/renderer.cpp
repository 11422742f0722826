#include "experiments/render/opengl/renderer.hpp"

#include <algorithm>
#include <array>

#include "core/model/input_error.hpp"
#include "experiments/render/opengl/shaders.hpp"

namespace taut {

namespace {

/// A vertex as the surface shader reads it.
struct Vertex {
  float position[3], normal[3], uv[2], data[4];
};

GLuint compile(const GlContext& gl, const char* vertex, const char* fragment) {
  std::string log(2000, '\0');
  const auto length = static_cast<GLsizei>(log.size());
  const auto check = [&](GLint good) {
    if (!good) throw InputError(gl.description() + ": a shader is refused: " + log.c_str());
  };
  GLint good = 0;
  const GLuint program = gl->CreateProgram();
  for (const auto& [kind, body] : {std::pair{GLenum{GL_VERTEX_SHADER}, vertex},
                                   std::pair{GLenum{GL_FRAGMENT_SHADER}, fragment}}) {
    const GLuint shader = gl->CreateShader(kind);
    const char* parts[] = {
        kind == GL_FRAGMENT_SHADER ? shaders::kFragmentCommon : shaders::kVersion, body};
    gl->ShaderSource(shader, 2, parts, nullptr);
    gl->CompileShader(shader);
    gl->GetShaderiv(shader, GL_COMPILE_STATUS, &good);
    gl->GetShaderInfoLog(shader, length, nullptr, log.data());
    check(good);
    gl->AttachShader(program, shader);
    gl->DeleteShader(shader);
  }
  gl->LinkProgram(program);
  gl->GetProgramiv(program, GL_LINK_STATUS, &good);
  gl->GetProgramInfoLog(program, length, nullptr, log.data());
  check(good);
  return program;
}

void set(const GlContext& gl, GLuint program, const char* name, const Vec3f& v) {
  gl->Uniform3f(gl->GetUniformLocation(program, name), v.x(), v.y(), v.z());
}
void set(const GlContext& gl, GLuint program, const char* name, float value) {
  gl->Uniform1f(gl->GetUniformLocation(program, name), value);
}
void set(const GlContext& gl, GLuint program, const char* name, const Eigen::Matrix4f& m) {
  gl->UniformMatrix4fv(gl->GetUniformLocation(program, name), 1, GL_FALSE, m.data());
}

Vec3f as_vector(Rgb8 c) {
  return Vec3f(static_cast<float>(c.r), static_cast<float>(c.g), static_cast<float>(c.b)) / 255;
}
Vec3f as_linear(Rgb8 c) {
  return Eigen::Vector3d(linear_of(c.r), linear_of(c.g), linear_of(c.b)).cast<float>();
}

std::vector<Vertex> vertices_of(const RenderMesh& mesh) {
  std::vector<Vertex> vertices;
  vertices.reserve(mesh.position.size());
  for (std::size_t i = 0; i < mesh.position.size(); ++i) {
    const Vec3f &p = mesh.position[i], &n = mesh.normal[i];
    vertices.push_back({{p.x(), p.y(), p.z()},
                        {n.x(), n.y(), n.z()},
                        {mesh.uv[i].x(), mesh.uv[i].y()},
                        {mesh.front[i], mesh.back[i], mesh.value[i], mesh.hidden[i]}});
  }
  return vertices;
}

/// The triangles that are lower than a pixel where the picture is `width` x `height` pixels: none
/// of a pixel's samples may lie in them.
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

template <class T>
void upload(const GlContext& gl, GLenum target, GLuint buffer, const std::vector<T>& data) {
  gl->BindBuffer(target, buffer);
  gl->BufferData(target, static_cast<GLsizeiptr>(data.size() * sizeof(T)), data.data(),
                 GL_STREAM_DRAW);
}

}  // namespace

Theme Theme::paper() {
  return {rgb(0xEFF0F4), rgb(0xE9EBEE), rgb(0x6A707C), rgb(0x3C424E), 0.72f, -0.05f};
}

Theme Theme::dark() {
  return {rgb(0x242A34), rgb(0x242A34), rgb(0x7A8496), rgb(0xC9D1DE), 0.8f, 0.035f};
}

Renderer::Renderer(const GlContext& gl, int width, int height, int supersampling)
    : gl_(gl), width_(width), height_(height), supersampling_(supersampling) {
  background_ = compile(gl, shaders::kBackgroundVertex, shaders::kBackgroundFragment);
  ground_ = compile(gl, shaders::kGroundVertex, shaders::kGroundFragment);
  surface_ = compile(gl, shaders::kSurfaceVertex, shaders::kSurfaceFragment);
  make_targets();
  gl->GenVertexArrays(1, &layout_);
  gl->BindVertexArray(layout_);
  gl->GenBuffers(1, &vertices_);
  gl->GenBuffers(1, &indices_);
  gl->BindBuffer(GL_ARRAY_BUFFER, vertices_);
  gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  const auto attribute = [&](GLuint index, GLint size, std::size_t offset) {
    gl->EnableVertexAttribArray(index);
    gl->VertexAttribPointer(index, size, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                            reinterpret_cast<const void*>(offset));
  };
  attribute(0, 3, offsetof(Vertex, position));
  attribute(1, 3, offsetof(Vertex, normal));
  attribute(2, 2, offsetof(Vertex, uv));
  attribute(3, 4, offsetof(Vertex, data));
  gl->GenTextures(1, &texture_);
  gl->BindTexture(GL_TEXTURE_2D, texture_);
  gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl->PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

Renderer::~Renderer() {
  for (const GLuint program : {background_, ground_, surface_}) gl_->DeleteProgram(program);
  gl_->DeleteFramebuffers(1, &drawn_);
  gl_->DeleteFramebuffers(1, &resolved_);
  gl_->DeleteRenderbuffers(3, buffers_);
  gl_->DeleteBuffers(1, &vertices_);
  gl_->DeleteBuffers(1, &indices_);
  gl_->DeleteVertexArrays(1, &layout_);
  gl_->DeleteTextures(1, &texture_);
}

void Renderer::make_targets() {
  GLint samples = 0;
  gl_->GetIntegerv(GL_MAX_SAMPLES, &samples);
  samples = std::min(samples, 4);
  if (samples < 4) supersampling_ = std::max(supersampling_, 2);
  const GLsizei width = width_ * supersampling_, height = height_ * supersampling_;
  gl_->GenFramebuffers(1, &drawn_);
  gl_->GenFramebuffers(1, &resolved_);
  gl_->GenRenderbuffers(3, buffers_);
  const auto attach = [&](GLuint buffer, GLsizei count, GLenum format, GLenum where) {
    gl_->BindRenderbuffer(GL_RENDERBUFFER, buffer);
    gl_->RenderbufferStorageMultisample(GL_RENDERBUFFER, count, format, width, height);
    gl_->FramebufferRenderbuffer(GL_FRAMEBUFFER, where, GL_RENDERBUFFER, buffer);
  };
  gl_->BindFramebuffer(GL_FRAMEBUFFER, resolved_);
  attach(buffers_[2], 0, GL_RGBA8, GL_COLOR_ATTACHMENT0);
  gl_->BindFramebuffer(GL_FRAMEBUFFER, drawn_);
  attach(buffers_[0], samples, GL_RGBA8, GL_COLOR_ATTACHMENT0);
  attach(buffers_[1], samples, GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT);
  if (gl_->CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw InputError(gl_.description() + ": no framebuffer of " + std::to_string(width) + " x " +
                     std::to_string(height) + " pixels");
}

Image Renderer::draw(const Panel& panel) const {
  gl_->BindFramebuffer(GL_FRAMEBUFFER, drawn_);
  gl_->Viewport(0, 0, width_ * supersampling_, height_ * supersampling_);
  gl_->BindVertexArray(layout_);
  gl_->DepthMask(GL_TRUE);
  gl_->Clear(GL_DEPTH_BUFFER_BIT);
  const Eigen::Matrix4f world_to_clip =
      panel.camera.world_to_clip(static_cast<float>(width_) / static_cast<float>(height_));
  gl_->Disable(GL_DEPTH_TEST);
  draw_background(panel.theme);
  gl_->Enable(GL_DEPTH_TEST);
  if (panel.ground) draw_ground(panel, world_to_clip);
  for (const Painted& painted : panel.painted) draw_mesh(panel, painted, world_to_clip);
  return read();
}

void Renderer::draw_background(const Theme& theme) const {
  gl_->UseProgram(background_);
  set(gl_, background_, "top", as_vector(theme.top));
  set(gl_, background_, "bottom", as_vector(theme.bottom));
  gl_->DrawArrays(GL_TRIANGLES, 0, 3);
}

void Renderer::draw_ground(const Panel& panel, const Eigen::Matrix4f& world_to_clip) const {
  const GroundLight& ground = *panel.ground;
  gl_->TexImage2D(GL_TEXTURE_2D, 0, GL_R32F, ground.size, ground.size, 0, GL_RED, GL_FLOAT,
                  ground.light.data());
  gl_->UseProgram(ground_);
  set(gl_, ground_, "world_to_clip", world_to_clip);
  set(gl_, ground_, "origin", ground.origin);
  set(gl_, ground_, "u", ground.u);
  set(gl_, ground_, "v", ground.v);
  set(gl_, ground_, "reach", 3 * ground.half_side);
  set(gl_, ground_, "half_side", ground.half_side);
  set(gl_, ground_, "shadow", panel.theme.shadow);
  set(gl_, ground_, "line", panel.theme.line);
  set(gl_, ground_, "cell", panel.ground_cell);
  set(gl_, ground_, "line_width", 1.4f * static_cast<float>(supersampling_));
  gl_->Enable(GL_BLEND);
  gl_->BlendFunc(GL_ONE, GL_SRC_ALPHA);
  gl_->DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  gl_->Disable(GL_BLEND);
}

void Renderer::draw_mesh(const Panel& panel, const Painted& painted,
                         const Eigen::Matrix4f& world_to_clip) const {
  const std::vector<Rgb8>& table = panel.scale.map().table();
  gl_->TexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, static_cast<GLsizei>(table.size()), 1, 0, GL_RGB,
                  GL_UNSIGNED_BYTE, table.data());
  upload(gl_, GL_ARRAY_BUFFER, vertices_, vertices_of(*painted.mesh));
  upload(gl_, GL_ELEMENT_ARRAY_BUFFER, indices_, painted.mesh->triangles);
  gl_->UseProgram(surface_);
  set(gl_, surface_, "world_to_clip", world_to_clip);
  set(gl_, surface_, "eye", panel.camera.eye);
  set(gl_, surface_, "up", panel.ground ? panel.ground->up : Vec3f::UnitY());
  gl_->Uniform2f(gl_->GetUniformLocation(surface_, "range"), static_cast<float>(panel.scale.low()),
                 static_cast<float>(panel.scale.high));
  const Vec3f colour = as_linear(painted.colour.value_or(Rgb8{}));
  gl_->Uniform4f(gl_->GetUniformLocation(surface_, "colour"), colour.x(), colour.y(), colour.z(),
                 painted.colour ? 1.0f : 0.0f);
  set(gl_, surface_, "spacing", static_cast<float>(painted.grid_spacing));
  set(gl_, surface_, "hatch_depth", panel.hatch_depth);
  set(gl_, surface_, "line_width", 1.3f * static_cast<float>(supersampling_));
  gl_->DrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * painted.mesh->triangles.size()),
                    GL_UNSIGNED_INT, nullptr);
  if (painted.colour) return;
  // Cloth never vanishes: what is too thin to be filled is drawn by its edges, a pixel wide.
  const auto thin = thinner_than_a_pixel(*painted.mesh, world_to_clip, static_cast<float>(width_),
                                         static_cast<float>(height_));
  if (thin.empty()) return;
  upload(gl_, GL_ELEMENT_ARRAY_BUFFER, indices_, thin);
  gl_->PolygonMode(GL_FRONT_AND_BACK, GL_LINE);
  gl_->LineWidth(static_cast<float>(supersampling_));
  gl_->DrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * thin.size()), GL_UNSIGNED_INT, nullptr);
  gl_->PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

Image Renderer::read() const {
  const GLsizei width = width_ * supersampling_, height = height_ * supersampling_;
  gl_->BindFramebuffer(GL_READ_FRAMEBUFFER, drawn_);
  gl_->BindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_);
  gl_->BlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  gl_->BindFramebuffer(GL_READ_FRAMEBUFFER, resolved_);
  std::vector<Rgb8> pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  gl_->ReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, pixels.data());
  Image image(width, height);
  for (int y = 0; y < height; ++y)  // OpenGL's rows start at the bottom
    std::copy_n(pixels.begin() + std::ptrdiff_t{y} * width, width, &image.at(0, height - 1 - y));
  return shrunk(image, supersampling_);
}

}  // namespace taut
