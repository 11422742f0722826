#include "experiments/render/opengl/gl.hpp"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>

#include <cstdlib>
#include <mutex>
#include <utility>

#include "core/model/input_error.hpp"

namespace taut {

namespace {

/// Why a context cannot be had.
struct Unavailable {
  std::string why;
};

void require(bool good, const std::string& why) {
  if (!good) throw Unavailable{why};
}

/// Stays open until the process ends: Mesa's threads and caches outlive a context.
class Library {
 public:
  Library(const char* variable, const char* usual) {
    const char* own = std::getenv(variable);
    handle_ = dlopen(own ? own : usual, RTLD_NOW | RTLD_LOCAL);
    if (!handle_) throw Unavailable{dlerror()};
  }
  template <class Function>
  Function get(const char* name) const {
    const auto function = reinterpret_cast<Function>(dlsym(handle_, name));
    require(function, std::string("no function ") + name);
    return function;
  }

 private:
  void* handle_;
};

/// A context that is current, who ends it, and where its functions are asked for.
struct Created {
  void* context;
  void (*destroy)(void*);
  void* (*function)(const char*);
};

/// Mesa's off-screen library (dropped from Mesa in 25.1). Names and values: GL/osmesa.h.
Created make_osmesa() {
  const Library library("TAUT_OSMESA", "libOSMesa.so.8");
  constexpr int kFormat = 0x22, kProfile = 0x33, kCore = 0x34, kMajor = 0x36, kMinor = 0x37;
  const int wanted[] = {kFormat, GL_RGBA, kProfile, kCore, kMajor, 3, kMinor, 3, 0};
  const auto destroy = library.get<void (*)(void*)>("OSMesaDestroyContext");
  void* context =
      library.get<void* (*)(const int*, void*)>("OSMesaCreateContextAttribs")(wanted, nullptr);
  require(context, "no OpenGL 3.3 core context");
  static unsigned char surface[4];  // a pixel that nobody draws to
  if (!library.get<unsigned char (*)(void*, void*, unsigned, int, int)>("OSMesaMakeCurrent")(
          context, surface, GL_UNSIGNED_BYTE, 1, 1)) {
    destroy(context);
    require(false, "the context cannot be made current");
  }
  return {context, destroy, library.get<void* (*)(const char*)>("OSMesaGetProcAddress")};
}

/// EGL without a surface (EGL_MESA_platform_surfaceless).
Created make_egl() {
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", 0);
  static const Library library("TAUT_EGL", "libEGL.so.1");
  static const auto get = library.get<decltype(&eglGetProcAddress)>("eglGetProcAddress");
  static const auto make_current = library.get<decltype(&eglMakeCurrent)>("eglMakeCurrent");
  const auto platform_display =
      reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(get("eglGetPlatformDisplayEXT"));
  require(platform_display, "no EGL_EXT_platform_base");
  static const EGLDisplay display =
      platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  require(library.get<decltype(&eglInitialize)>("eglInitialize")(display, nullptr, nullptr),
          "no surfaceless display");
  library.get<decltype(&eglBindAPI)>("eglBindAPI")(EGL_OPENGL_API);
  const EGLint wanted[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3, EGL_NONE};
  const EGLContext context = library.get<decltype(&eglCreateContext)>("eglCreateContext")(
      display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted);
  require(context != EGL_NO_CONTEXT, "no OpenGL 3.3 core context");
  const auto destroy = [](void* made) {
    make_current(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    library.get<decltype(&eglDestroyContext)>("eglDestroyContext")(display, made);
  };
  if (!make_current(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
    destroy(context);
    require(false, "the context cannot be made current without a surface");
  }
  return {context, destroy, [](const char* name) { return reinterpret_cast<void*>(get(name)); }};
}

void load_functions(const Created& made) {
  static std::once_flag once;  // every context of a process is of the same library
  std::call_once(once, [&] {
#define TAUT_GL_LOAD(name)                                       \
  name = reinterpret_cast<decltype(name)>(made.function(#name)); \
  if (!name) throw InputError("OpenGL has no function " #name);
    TAUT_GL_FUNCTIONS(TAUT_GL_LOAD)
#undef TAUT_GL_LOAD
  });
}

}  // namespace

GlContext::GlContext() {
  std::string tried;
  const std::pair<Created (*)(), const char*> ways[] = {
      {make_osmesa, "OSMesa (package libosmesa6)"},
      {make_egl, "EGL (packages libegl1, libgl1-mesa-dri)"}};
  for (const auto& [make, what] : ways) try {
      const Created made = make();
      context_ = made.context, destroy_ = made.destroy;
      load_functions(made);
      return;
    } catch (const Unavailable& unavailable) {
      tried += std::string("\n  ") + what + ": " + unavailable.why;
    }
  throw InputError("pictures need an off-screen OpenGL 3.3; tried" + tried +
                   "\nInstall one of them; everything but pictures works without");
}

std::string GlContext::description() const {
  const auto text = [](GLenum name) {
    const auto* value = reinterpret_cast<const char*>(glGetString(name));
    return std::string(value ? value : "unknown");
  };
  return text(GL_VERSION) + ", " + text(GL_RENDERER);
}

}  // namespace taut
