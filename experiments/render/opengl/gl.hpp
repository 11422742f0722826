#pragma once

#include <epoxy/gl.h>

#include <string>

namespace taut {

/// An off-screen OpenGL 3.3 core context of Mesa's software rasteriser: EGL without a surface.
/// Needs no display, no graphics card and no network; libepoxy opens EGL and OpenGL when they are
/// first called, so that everything else works without them. Current on the thread that made it;
/// draw to framebuffer objects only.
class GlContext {
 public:
  GlContext();  ///< throws InputError that says what is missing
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;
  /// "4.5 (Core Profile) Mesa 22.3.6, llvmpipe (LLVM 15.0.6, 256 bits)"
  std::string description() const;

 private:
  void* display_ = nullptr;  ///< EGLDisplay
  void* context_ = nullptr;  ///< EGLContext
};

}  // namespace taut
