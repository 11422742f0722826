#include "experiments/render/opengl/gl.hpp"

#include <dlfcn.h>

#include <cstdlib>

#include "core/model/input_error.hpp"

namespace taut {

namespace {

/// Mesa's off-screen library, which Mesa dropped in 25.1. Names and values are those of
/// GL/osmesa.h. The library stays open until the process ends, because Mesa's threads and caches
/// outlive a context.
struct OsMesa {
  OsMesa() {
    // Mesa's rasteriser without threads of its own, unless the environment says otherwise. In Mesa
    // 22.3 its threads free the list of a scene's resources while the caller may still be walking
    // it, without the lock that later versions take.
    setenv("LP_NUM_THREADS", "0", 0);
    void* const library = dlopen("libOSMesa.so.8", RTLD_NOW | RTLD_LOCAL);
    if (!library)
      throw InputError("pictures need off-screen OpenGL: " + std::string(dlerror()) +
                       "\nInstall the package libosmesa6; everything but pictures works without");
    const auto get = [library]<class F>(F*& function, const char* name) {
      function = reinterpret_cast<F*>(dlsym(library, name));
      if (!function) throw InputError(std::string("libOSMesa.so.8 has no function ") + name);
    };
    get(create, "OSMesaCreateContextAttribs");
    get(make_current, "OSMesaMakeCurrent");
    get(destroy, "OSMesaDestroyContext");
#define TAUT_GL_LOAD(name) get(name, #name);
    TAUT_GL_FUNCTIONS(TAUT_GL_LOAD)
#undef TAUT_GL_LOAD
  }
  void* (*create)(const int* attributes, void* shared);
  unsigned char (*make_current)(void* context, void* buffer, unsigned type, int width, int height);
  void (*destroy)(void* context);
};

const OsMesa& osmesa() {
  static const OsMesa opened;
  return opened;
}

}  // namespace

GlContext::GlContext() {
  constexpr int kFormat = 0x22, kProfile = 0x33, kCore = 0x34, kMajor = 0x36, kMinor = 0x37;
  const int wanted[] = {kFormat, GL_RGBA, kProfile, kCore, kMajor, 3, kMinor, 3, 0};
  static unsigned char surface[4];  // one pixel, never drawn to
  context_ = osmesa().create(wanted, nullptr);
  if (!context_) throw InputError("libOSMesa.so.8 makes no OpenGL 3.3 core context");
  if (osmesa().make_current(context_, surface, GL_UNSIGNED_BYTE, 1, 1)) return;
  osmesa().destroy(context_);
  throw InputError("libOSMesa.so.8: the context cannot be made current");
}

GlContext::~GlContext() { osmesa().destroy(context_); }

std::string GlContext::description() const {
  const auto text = [](GLenum name) {
    const auto* value = reinterpret_cast<const char*>(glGetString(name));
    return std::string(value ? value : "unknown");
  };
  return text(GL_VERSION) + ", " + text(GL_RENDERER);
}

}  // namespace taut
