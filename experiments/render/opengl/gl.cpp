#include "experiments/render/opengl/gl.hpp"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>

#include <cstdlib>
#include <vector>

#include "core/model/input_error.hpp"

namespace taut {

namespace {

/// Why a backend cannot be had.
struct Unavailable {
  std::string why;
};

/// Libraries stay open until the process ends: Mesa's threads and caches outlive a context.
void* open_library(const std::string& file) {
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) throw Unavailable{dlerror()};
  return library;
}

template <class Function>
Function symbol(void* library, const char* name) {
  const auto function = reinterpret_cast<Function>(dlsym(library, name));
  if (!function) throw Unavailable{std::string("no function ") + name};
  return function;
}

/// Mesa's off-screen library (dropped from Mesa in 25.1). Names and values: GL/osmesa.h.
class OsMesa final : public GlContext::Backend {
 public:
  explicit OsMesa(const std::string& file) {
    void* library = open_library(file);
    const auto create = symbol<void* (*)(const int*, void*)>(library, "OSMesaCreateContextAttribs");
    const auto make_current =
        symbol<unsigned char (*)(void*, void*, unsigned, int, int)>(library, "OSMesaMakeCurrent");
    get_ = symbol<void* (*)(const char*)>(library, "OSMesaGetProcAddress");
    destroy_ = symbol<void (*)(void*)>(library, "OSMesaDestroyContext");
    constexpr int kFormat = 0x22, kProfile = 0x33, kCore = 0x34, kMajor = 0x36, kMinor = 0x37;
    const int wanted[] = {kFormat, GL_RGBA, kProfile, kCore, kMajor, 3, kMinor, 3, 0};
    context_ = create(wanted, nullptr);
    if (!context_) throw Unavailable{"no OpenGL 3.3 core context"};
    buffer_.resize(kSide * kSide * 4);
    if (!make_current(context_, buffer_.data(), GL_UNSIGNED_BYTE, kSide, kSide)) {
      destroy_(context_);
      throw Unavailable{"the context cannot be made current"};
    }
  }
  ~OsMesa() override { destroy_(context_); }
  const char* name() const override { return "OSMesa"; }
  void* function(const char* gl_name) const override { return get_(gl_name); }

 private:
  static constexpr int kSide = 16;
  std::vector<unsigned char> buffer_;  ///< OSMesa writes to it until the context is gone
  void* context_ = nullptr;
  void* (*get_)(const char*) = nullptr;
  void (*destroy_)(void*) = nullptr;
};

/// EGL without a surface (EGL_MESA_platform_surfaceless).
class SurfacelessEgl final : public GlContext::Backend {
 public:
  explicit SurfacelessEgl(const std::string& file) {
    setenv("LIBGL_ALWAYS_SOFTWARE", "1", 0);
    void* library = open_library(file);
    get_ = symbol<decltype(get_)>(library, "eglGetProcAddress");
    make_current_ = symbol<decltype(make_current_)>(library, "eglMakeCurrent");
    destroy_ = symbol<decltype(destroy_)>(library, "eglDestroyContext");
    const auto platform_display =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(get_("eglGetPlatformDisplayEXT"));
    if (!platform_display) throw Unavailable{"no EGL_EXT_platform_base"};
    display_ = platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (!symbol<decltype(&eglInitialize)>(library, "eglInitialize")(display_, nullptr, nullptr))
      throw Unavailable{"no surfaceless display"};
    symbol<decltype(&eglBindAPI)>(library, "eglBindAPI")(EGL_OPENGL_API);
    const EGLint wanted[] = {EGL_CONTEXT_MAJOR_VERSION,
                             3,
                             EGL_CONTEXT_MINOR_VERSION,
                             3,
                             EGL_CONTEXT_OPENGL_PROFILE_MASK,
                             EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                             EGL_NONE};
    context_ = symbol<decltype(&eglCreateContext)>(library, "eglCreateContext")(
        display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted);
    if (context_ == EGL_NO_CONTEXT) throw Unavailable{"no OpenGL 3.3 core context"};
    if (!make_current_(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) {
      destroy_(display_, context_);
      throw Unavailable{"the context cannot be made current without a surface"};
    }
  }
  ~SurfacelessEgl() override {
    make_current_(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    destroy_(display_, context_);
  }
  const char* name() const override { return "EGL"; }
  void* function(const char* gl_name) const override {
    return reinterpret_cast<void*>(get_(gl_name));
  }

 private:
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  decltype(&eglGetProcAddress) get_ = nullptr;
  decltype(&eglMakeCurrent) make_current_ = nullptr;
  decltype(&eglDestroyContext) destroy_ = nullptr;
};

template <class Kind>
std::unique_ptr<GlContext::Backend> attempt(const char* what, const std::string& file,
                                            std::string& tried) {
  if (file.empty()) return nullptr;
  try {
    return std::make_unique<Kind>(file);
  } catch (const Unavailable& unavailable) {
    tried += std::string("\n  ") + what + ": " + unavailable.why;
    return nullptr;
  }
}

}  // namespace

GlLibraries GlLibraries::of_this_machine() {
  const auto named = [](const char* variable, const char* usual) {
    const char* own = std::getenv(variable);
    return std::string(own ? own : usual);
  };
  return {named("TAUT_OSMESA", "libOSMesa.so.8"), named("TAUT_EGL", "libEGL.so.1")};
}

GlContext::GlContext(const GlLibraries& libraries) {
  std::string tried;
  backend_ = attempt<OsMesa>("OSMesa (package libosmesa6)", libraries.osmesa, tried);
  if (!backend_)
    backend_ = attempt<SurfacelessEgl>("surfaceless EGL (packages libegl1, libgl1-mesa-dri)",
                                       libraries.egl, tried);
  if (!backend_)
    throw InputError("pictures need an off-screen OpenGL 3.3; tried" + tried +
                     "\nInstall one of them; everything but pictures works without");
#define TAUT_GL_LOAD(UPPER, Function)                                                             \
  functions_.Function = reinterpret_cast<PFNGL##UPPER##PROC>(backend_->function("gl" #Function)); \
  if (!functions_.Function)                                                                       \
    throw InputError(std::string(backend_->name()) + ": OpenGL has no function gl" #Function);
  TAUT_GL_FUNCTIONS(TAUT_GL_LOAD)
#undef TAUT_GL_LOAD
}

GlContext::~GlContext() = default;

std::string GlContext::description() const {
  const auto text = [&](GLenum name) {
    const auto* value = reinterpret_cast<const char*>(functions_.GetString(name));
    return std::string(value ? value : "unknown");
  };
  return std::string(backend_->name()) + ", " + text(GL_VERSION) + ", " + text(GL_RENDERER);
}

}  // namespace taut
