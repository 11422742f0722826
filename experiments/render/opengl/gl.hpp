#pragma once

#define GL_GLEXT_PROTOTYPES  // declares the types of the functions below
#include <GL/glcorearb.h>

#include <string>

namespace taut {

/// The functions of OpenGL 3.3 core that the renderer calls. They are loaded when the first context
/// is made. If they were linked, the process of every case would load Mesa and its LLVM: 30 ms at
/// each start instead of 1 ms.
// clang-format off
#define TAUT_GL_FUNCTIONS(X)                                                                       \
  X(glActiveTexture) X(glAttachShader) X(glBindBuffer) X(glBindFramebuffer) X(glBindRenderbuffer)  \
  X(glBindTexture) X(glBindVertexArray) X(glBlendFunc) X(glBlitFramebuffer) X(glBufferData)        \
  X(glCheckFramebufferStatus) X(glClear) X(glCompileShader) X(glCreateProgram) X(glCreateShader)   \
  X(glDeleteBuffers) X(glDeleteFramebuffers) X(glDeleteProgram) X(glDeleteRenderbuffers)           \
  X(glDeleteShader) X(glDeleteTextures) X(glDeleteVertexArrays) X(glDisable)                       \
  X(glDrawArrays) X(glDrawBuffer) X(glDrawElements) X(glEnable) X(glEnableVertexAttribArray)       \
  X(glFramebufferRenderbuffer) X(glFramebufferTexture2D) X(glFramebufferTextureLayer)              \
  X(glGenBuffers) X(glGenFramebuffers) X(glGenRenderbuffers) X(glGenTextures)                      \
  X(glGenVertexArrays) X(glGetIntegerv) X(glGetProgramInfoLog) X(glGetProgramiv)                   \
  X(glGetShaderInfoLog) X(glGetShaderiv) X(glGetString) X(glGetUniformLocation) X(glLineWidth)     \
  X(glLinkProgram) X(glPixelStorei) X(glPolygonMode) X(glPolygonOffset) X(glReadPixels)            \
  X(glRenderbufferStorageMultisample) X(glShaderSource) X(glTexImage2D) X(glTexImage3D)            \
  X(glTexParameterfv) X(glTexParameteri) X(glUniform1f) X(glUniform1i) X(glUniform2f)              \
  X(glUniform3f) X(glUniform4f) X(glUniform4fv) X(glUniformMatrix4fv) X(glUseProgram)              \
  X(glVertexAttribPointer) X(glViewport)
// clang-format on
#define TAUT_GL_DECLARE(name) inline decltype(&::name) name = nullptr;
TAUT_GL_FUNCTIONS(TAUT_GL_DECLARE)
#undef TAUT_GL_DECLARE

/// An off-screen OpenGL 3.3 core context of Mesa's software rasteriser, OSMesa, which needs no
/// display, graphics card or network. It is current on the thread that made it. Draw only to
/// framebuffer objects.
class GlContext {
 public:
  GlContext();  ///< throws InputError with the reason if there is no usable OSMesa
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;
  /// "4.5 (Core Profile) Mesa 22.3.6, llvmpipe (LLVM 15.0.6, 256 bits)"
  std::string description() const;

 private:
  void* context_ = nullptr;
};

}  // namespace taut
