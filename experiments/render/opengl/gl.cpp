#include "experiments/render/opengl/gl.hpp"

#include <dlfcn.h>
#include <epoxy/egl.h>

#include <cstdlib>

#include "core/model/input_error.hpp"

namespace taut {

GlContext::GlContext() {
  const auto require = [](bool good, const std::string& why) {
    if (!good)
      throw InputError(
          "pictures need an off-screen OpenGL 3.3 (packages libegl1, libgl1-mesa-dri): " + why +
          "; everything but pictures works without");
  };
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", 0);
  // libepoxy would end the program; once open, the library stays.
  for (const char* library : {"libEGL.so.1", "libGL.so.1"})
    require(dlopen(library, RTLD_LAZY), std::string(library) + " cannot be opened");
  display_ = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  require(eglInitialize(display_, nullptr, nullptr), "EGL has no surfaceless display");
  eglBindAPI(EGL_OPENGL_API);
  const EGLint wanted[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3, EGL_NONE};
  context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted);
  require(context_ != EGL_NO_CONTEXT, "EGL has no context of OpenGL 3.3");
  if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) return;
  eglDestroyContext(display_, context_);
  require(false, "the context cannot be made current without a surface");
}

GlContext::~GlContext() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
}

std::string GlContext::description() const {
  const auto text = [](GLenum name) {
    const auto* value = reinterpret_cast<const char*>(glGetString(name));
    return std::string(value ? value : "unknown");
  };
  return text(GL_VERSION) + ", " + text(GL_RENDERER);
}

}  // namespace taut
