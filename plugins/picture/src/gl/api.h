#pragma once

#include <GL/glcorearb.h>

#include "gl/context.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// Every OpenGL function the renderer calls: SOFTPOINT_GL(type of the pointer, name without "gl").
#define SOFTPOINT_GL_FUNCTIONS(SOFTPOINT_GL)                                            \
  SOFTPOINT_GL(PFNGLACTIVETEXTUREPROC, ActiveTexture)                                   \
  SOFTPOINT_GL(PFNGLATTACHSHADERPROC, AttachShader)                                     \
  SOFTPOINT_GL(PFNGLBINDBUFFERPROC, BindBuffer)                                         \
  SOFTPOINT_GL(PFNGLBINDBUFFERBASEPROC, BindBufferBase)                                 \
  SOFTPOINT_GL(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)                               \
  SOFTPOINT_GL(PFNGLBINDRENDERBUFFERPROC, BindRenderbuffer)                             \
  SOFTPOINT_GL(PFNGLBINDTEXTUREPROC, BindTexture)                                       \
  SOFTPOINT_GL(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)                               \
  SOFTPOINT_GL(PFNGLBLENDFUNCPROC, BlendFunc)                                           \
  SOFTPOINT_GL(PFNGLBLITFRAMEBUFFERPROC, BlitFramebuffer)                               \
  SOFTPOINT_GL(PFNGLBUFFERDATAPROC, BufferData)                                         \
  SOFTPOINT_GL(PFNGLBUFFERSUBDATAPROC, BufferSubData)                                   \
  SOFTPOINT_GL(PFNGLCHECKFRAMEBUFFERSTATUSPROC, CheckFramebufferStatus)                 \
  SOFTPOINT_GL(PFNGLCLEARPROC, Clear)                                                   \
  SOFTPOINT_GL(PFNGLCLEARCOLORPROC, ClearColor)                                         \
  SOFTPOINT_GL(PFNGLCOLORMASKPROC, ColorMask)                                           \
  SOFTPOINT_GL(PFNGLCOMPILESHADERPROC, CompileShader)                                   \
  SOFTPOINT_GL(PFNGLCREATEPROGRAMPROC, CreateProgram)                                   \
  SOFTPOINT_GL(PFNGLCREATESHADERPROC, CreateShader)                                     \
  SOFTPOINT_GL(PFNGLCULLFACEPROC, CullFace)                                             \
  SOFTPOINT_GL(PFNGLDELETEBUFFERSPROC, DeleteBuffers)                                   \
  SOFTPOINT_GL(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers)                         \
  SOFTPOINT_GL(PFNGLDELETEPROGRAMPROC, DeleteProgram)                                   \
  SOFTPOINT_GL(PFNGLDELETERENDERBUFFERSPROC, DeleteRenderbuffers)                       \
  SOFTPOINT_GL(PFNGLDELETESHADERPROC, DeleteShader)                                     \
  SOFTPOINT_GL(PFNGLDELETETEXTURESPROC, DeleteTextures)                                 \
  SOFTPOINT_GL(PFNGLDELETEVERTEXARRAYSPROC, DeleteVertexArrays)                         \
  SOFTPOINT_GL(PFNGLDEPTHFUNCPROC, DepthFunc)                                           \
  SOFTPOINT_GL(PFNGLDEPTHMASKPROC, DepthMask)                                           \
  SOFTPOINT_GL(PFNGLDISABLEPROC, Disable)                                               \
  SOFTPOINT_GL(PFNGLDRAWARRAYSPROC, DrawArrays)                                         \
  SOFTPOINT_GL(PFNGLDRAWARRAYSINSTANCEDPROC, DrawArraysInstanced)                       \
  SOFTPOINT_GL(PFNGLDRAWBUFFERPROC, DrawBuffer)                                         \
  SOFTPOINT_GL(PFNGLDRAWELEMENTSINSTANCEDPROC, DrawElementsInstanced)                   \
  SOFTPOINT_GL(PFNGLENABLEPROC, Enable)                                                 \
  SOFTPOINT_GL(PFNGLENABLEVERTEXATTRIBARRAYPROC, EnableVertexAttribArray)               \
  SOFTPOINT_GL(PFNGLFRAMEBUFFERRENDERBUFFERPROC, FramebufferRenderbuffer)               \
  SOFTPOINT_GL(PFNGLFRAMEBUFFERTEXTURE2DPROC, FramebufferTexture2D)                     \
  SOFTPOINT_GL(PFNGLGENBUFFERSPROC, GenBuffers)                                         \
  SOFTPOINT_GL(PFNGLGENFRAMEBUFFERSPROC, GenFramebuffers)                               \
  SOFTPOINT_GL(PFNGLGENRENDERBUFFERSPROC, GenRenderbuffers)                             \
  SOFTPOINT_GL(PFNGLGENTEXTURESPROC, GenTextures)                                       \
  SOFTPOINT_GL(PFNGLGENVERTEXARRAYSPROC, GenVertexArrays)                               \
  SOFTPOINT_GL(PFNGLGETERRORPROC, GetError)                                             \
  SOFTPOINT_GL(PFNGLGETINTEGERVPROC, GetIntegerv)                                       \
  SOFTPOINT_GL(PFNGLGETPROGRAMINFOLOGPROC, GetProgramInfoLog)                           \
  SOFTPOINT_GL(PFNGLGETPROGRAMIVPROC, GetProgramiv)                                     \
  SOFTPOINT_GL(PFNGLGETSHADERINFOLOGPROC, GetShaderInfoLog)                             \
  SOFTPOINT_GL(PFNGLGETSHADERIVPROC, GetShaderiv)                                       \
  SOFTPOINT_GL(PFNGLGETSTRINGPROC, GetString)                                           \
  SOFTPOINT_GL(PFNGLGETUNIFORMBLOCKINDEXPROC, GetUniformBlockIndex)                     \
  SOFTPOINT_GL(PFNGLGETUNIFORMLOCATIONPROC, GetUniformLocation)                         \
  SOFTPOINT_GL(PFNGLLINKPROGRAMPROC, LinkProgram)                                       \
  SOFTPOINT_GL(PFNGLPIXELSTOREIPROC, PixelStorei)                                       \
  SOFTPOINT_GL(PFNGLPOLYGONOFFSETPROC, PolygonOffset)                                   \
  SOFTPOINT_GL(PFNGLREADBUFFERPROC, ReadBuffer)                                         \
  SOFTPOINT_GL(PFNGLREADPIXELSPROC, ReadPixels)                                         \
  SOFTPOINT_GL(PFNGLRENDERBUFFERSTORAGEPROC, RenderbufferStorage)                       \
  SOFTPOINT_GL(PFNGLRENDERBUFFERSTORAGEMULTISAMPLEPROC, RenderbufferStorageMultisample) \
  SOFTPOINT_GL(PFNGLSHADERSOURCEPROC, ShaderSource)                                     \
  SOFTPOINT_GL(PFNGLTEXIMAGE2DPROC, TexImage2D)                                         \
  SOFTPOINT_GL(PFNGLTEXPARAMETERIPROC, TexParameteri)                                   \
  SOFTPOINT_GL(PFNGLUNIFORM1IPROC, Uniform1i)                                           \
  SOFTPOINT_GL(PFNGLUNIFORM4FVPROC, Uniform4fv)                                         \
  SOFTPOINT_GL(PFNGLUNIFORMBLOCKBINDINGPROC, UniformBlockBinding)                       \
  SOFTPOINT_GL(PFNGLUSEPROGRAMPROC, UseProgram)                                         \
  SOFTPOINT_GL(PFNGLVERTEXATTRIBDIVISORPROC, VertexAttribDivisor)                       \
  SOFTPOINT_GL(PFNGLVERTEXATTRIBPOINTERPROC, VertexAttribPointer)                       \
  SOFTPOINT_GL(PFNGLVIEWPORTPROC, Viewport)

// One table per context; throws Error naming the first function the driver lacks.
struct GlApi {
  explicit GlApi(const GlContext& context);

#define SOFTPOINT_GL_MEMBER(type, name) type name = nullptr;
  SOFTPOINT_GL_FUNCTIONS(SOFTPOINT_GL_MEMBER)
#undef SOFTPOINT_GL_MEMBER
};

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
