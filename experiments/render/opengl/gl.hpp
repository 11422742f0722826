#pragma once

#include <GL/glcorearb.h>

#include <memory>
#include <string>

namespace taut {

/// The functions of OpenGL 3.3 core that the renderer calls; X(NAME, Name) stands for glName.
/// Loaded here because libepoxy 1.5 knows GLX and EGL only: under OSMesa it finds no context and
/// aborts.
#define TAUT_GL_FUNCTIONS(X)                                        \
  X(ACTIVETEXTURE, ActiveTexture)                                   \
  X(ATTACHSHADER, AttachShader)                                     \
  X(BINDBUFFER, BindBuffer)                                         \
  X(BINDFRAMEBUFFER, BindFramebuffer)                               \
  X(BINDRENDERBUFFER, BindRenderbuffer)                             \
  X(BINDTEXTURE, BindTexture)                                       \
  X(BINDVERTEXARRAY, BindVertexArray)                               \
  X(BLENDFUNC, BlendFunc)                                           \
  X(BLITFRAMEBUFFER, BlitFramebuffer)                               \
  X(BUFFERDATA, BufferData)                                         \
  X(CHECKFRAMEBUFFERSTATUS, CheckFramebufferStatus)                 \
  X(CLEAR, Clear)                                                   \
  X(COMPILESHADER, CompileShader)                                   \
  X(CREATEPROGRAM, CreateProgram)                                   \
  X(CREATESHADER, CreateShader)                                     \
  X(DELETEBUFFERS, DeleteBuffers)                                   \
  X(DELETEFRAMEBUFFERS, DeleteFramebuffers)                         \
  X(DELETEPROGRAM, DeleteProgram)                                   \
  X(DELETERENDERBUFFERS, DeleteRenderbuffers)                       \
  X(DELETESHADER, DeleteShader)                                     \
  X(DELETETEXTURES, DeleteTextures)                                 \
  X(DELETEVERTEXARRAYS, DeleteVertexArrays)                         \
  X(DEPTHMASK, DepthMask)                                           \
  X(DISABLE, Disable)                                               \
  X(DRAWARRAYS, DrawArrays)                                         \
  X(DRAWELEMENTS, DrawElements)                                     \
  X(ENABLE, Enable)                                                 \
  X(ENABLEVERTEXATTRIBARRAY, EnableVertexAttribArray)               \
  X(FRAMEBUFFERRENDERBUFFER, FramebufferRenderbuffer)               \
  X(GENBUFFERS, GenBuffers)                                         \
  X(GENFRAMEBUFFERS, GenFramebuffers)                               \
  X(GENRENDERBUFFERS, GenRenderbuffers)                             \
  X(GENTEXTURES, GenTextures)                                       \
  X(GENVERTEXARRAYS, GenVertexArrays)                               \
  X(GETERROR, GetError)                                             \
  X(GETINTEGERV, GetIntegerv)                                       \
  X(GETPROGRAMINFOLOG, GetProgramInfoLog)                           \
  X(GETPROGRAMIV, GetProgramiv)                                     \
  X(GETSHADERINFOLOG, GetShaderInfoLog)                             \
  X(GETSHADERIV, GetShaderiv)                                       \
  X(GETSTRING, GetString)                                           \
  X(GETUNIFORMLOCATION, GetUniformLocation)                         \
  X(LINEWIDTH, LineWidth)                                           \
  X(LINKPROGRAM, LinkProgram)                                       \
  X(PIXELSTOREI, PixelStorei)                                       \
  X(POLYGONMODE, PolygonMode)                                       \
  X(READPIXELS, ReadPixels)                                         \
  X(RENDERBUFFERSTORAGEMULTISAMPLE, RenderbufferStorageMultisample) \
  X(SHADERSOURCE, ShaderSource)                                     \
  X(TEXIMAGE2D, TexImage2D)                                         \
  X(TEXPARAMETERI, TexParameteri)                                   \
  X(UNIFORM1F, Uniform1f)                                           \
  X(UNIFORM1I, Uniform1i)                                           \
  X(UNIFORM2F, Uniform2f)                                           \
  X(UNIFORM3F, Uniform3f)                                           \
  X(UNIFORM4F, Uniform4f)                                           \
  X(UNIFORMMATRIX4FV, UniformMatrix4fv)                             \
  X(USEPROGRAM, UseProgram)                                         \
  X(VERTEXATTRIBPOINTER, VertexAttribPointer)                       \
  X(VIEWPORT, Viewport)

struct GlFunctions {
#define TAUT_GL_MEMBER(UPPER, Function) PFNGL##UPPER##PROC Function = nullptr;
  TAUT_GL_FUNCTIONS(TAUT_GL_MEMBER)
#undef TAUT_GL_MEMBER
};

/// Which libraries to try, in this order; "" leaves one out.
struct GlLibraries {
  std::string osmesa;  ///< "": never tried
  std::string egl;
  /// libOSMesa.so.8 and libEGL.so.1, or what TAUT_OSMESA and TAUT_EGL name instead.
  static GlLibraries of_this_machine();
};

/// An off-screen OpenGL 3.3 core context of Mesa's software rasteriser: OSMesa if the machine has
/// it, else surfaceless EGL. Needs no display, no graphics card and no network, and links no GL:
/// the libraries are opened at run time, the functions belong to the context. Current on the thread
/// that made it; draw to framebuffer objects only. Pictures are the same bytes with either.
class GlContext {
 public:
  /// Throws InputError that lists what was tried.
  explicit GlContext(const GlLibraries& = GlLibraries::of_this_machine());
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  const GlFunctions* operator->() const { return &functions_; }
  /// "OSMesa, 4.5 (Core Profile) Mesa 22.3.6, llvmpipe (LLVM 15.0.6, 256 bits)"
  std::string description() const;

  /// A library and its context; each backend derives from it.
  class Backend {
   public:
    virtual ~Backend() = default;
    virtual const char* name() const = 0;
    virtual void* function(const char* gl_name) const = 0;
  };

 private:
  std::unique_ptr<Backend> backend_;
  GlFunctions functions_;
};

}  // namespace taut
