// SPDX-License-Identifier: Apache-2.0
// Counts what the programs of the gles back end draw, read and write, for
// docs/results/gles_counts.py:
//   LD_PRELOAD=libgl_counts.so GL_COUNTS=FILE GL_COUNTS_SHADERS=FOLDER mixrig run ...
// writes a line a program to FILE at the end: name, draws, pixels, vertices, bytes read, bytes
// written. A draw reads each texture of its program once, in the share of the target's pixels that
// it draws, and writes its pixels once: what the memory must move if caches were perfect. FOLDER
// holds the expanded shaders, by whose text programs are named.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <EGL/egl.h>
#include <GLES3/gl31.h>
#include <dlfcn.h>

#include "host/render/contract/constants.h"

namespace {

struct Count {
  std::int64_t draws = 0, pixels = 0, vertices = 0;
  double bytes_in = 0, bytes_out = 0;
};

/// A level of a texture.
struct Level {
  std::array<GLint, 3> size{};
  double texel_bytes = 0;
  double bytes() const { return texel_bytes * size[0] * size[1] * std::max(size[2], 1); }
};

/// A shader or program of a context.
using Object = std::pair<EGLContext, GLuint>;
Object object(GLuint name) { return {eglGetCurrentContext(), name}; }

struct State {
  std::map<std::string, Count> counts;
  /// By context and name: contexts give the same names.
  std::map<Object, std::string> shader_names, program_names;
  std::map<std::string, std::string> name_of_text;
  State() {
    const char* folder = std::getenv("GL_COUNTS_SHADERS");
    if (folder == nullptr) return;
    for (const auto& file : std::filesystem::directory_iterator(folder)) {
      std::ifstream in(file.path());
      const std::string text{std::istreambuf_iterator<char>(in), {}};
      name_of_text[text] = file.path().filename().string();
    }
  }
  ~State() {
    const char* path = std::getenv("GL_COUNTS");
    if (path == nullptr) return;
    std::ofstream out(path);
    for (const auto& [name, c] : counts)
      out << name << '\t' << c.draws << '\t' << c.pixels << '\t' << c.vertices << '\t'
          << static_cast<std::int64_t>(c.bytes_in) << '\t' << static_cast<std::int64_t>(c.bytes_out)
          << '\n';
  }
};

State& state() {
  static State all;
  return all;
}

template <typename F>
F* real(const char* name) {
  return reinterpret_cast<F*>(dlsym(RTLD_NEXT, name));
}
#define GL_COUNTS_REAL(name) real<decltype(name)>(#name)

Level level_of(GLenum target) {
  constexpr std::array<GLenum, 7> kSizes{
      GL_TEXTURE_RED_SIZE,   GL_TEXTURE_GREEN_SIZE,   GL_TEXTURE_BLUE_SIZE,  GL_TEXTURE_ALPHA_SIZE,
      GL_TEXTURE_DEPTH_SIZE, GL_TEXTURE_STENCIL_SIZE, GL_TEXTURE_SHARED_SIZE};
  Level level;
  glGetTexLevelParameteriv(target, 0, GL_TEXTURE_WIDTH, &level.size[0]);
  glGetTexLevelParameteriv(target, 0, GL_TEXTURE_HEIGHT, &level.size[1]);
  glGetTexLevelParameteriv(target, 0, GL_TEXTURE_DEPTH, &level.size[2]);
  for (const GLenum what : kSizes) {
    GLint bits = 0;
    glGetTexLevelParameteriv(target, 0, what, &bits);
    level.texel_bytes += bits / 8.0;
  }
  return level;
}

/// Targets of samplers, and what is bound to them.
std::pair<GLenum, GLenum> target_of(GLenum sampler) {
  if (sampler == GL_SAMPLER_3D) return {GL_TEXTURE_3D, GL_TEXTURE_BINDING_3D};
  if (sampler == GL_SAMPLER_2D_ARRAY) return {GL_TEXTURE_2D_ARRAY, GL_TEXTURE_BINDING_2D_ARRAY};
  if (sampler == GL_SAMPLER_2D) return {GL_TEXTURE_2D, GL_TEXTURE_BINDING_2D};
  return {GL_NONE, GL_NONE};
}

/// Bytes of all textures of a program, each once.
double bytes_bound(GLuint program) {
  GLint uniforms = 0, active = 0;
  glGetIntegerv(GL_ACTIVE_TEXTURE, &active);
  glGetProgramiv(program, GL_ACTIVE_UNIFORMS, &uniforms);
  std::set<GLint> seen;
  double bytes = 0;
  for (GLint i = 0; i < uniforms; ++i) {
    std::array<char, 128> name{};
    GLint size = 0, unit = 0, texture = 0;
    GLenum type = GL_NONE;
    glGetActiveUniform(program, static_cast<GLuint>(i), name.size(), nullptr, &size, &type,
                       name.data());
    const auto [target, binding] = target_of(type);
    if (target == GL_NONE) continue;
    glGetUniformiv(program, glGetUniformLocation(program, name.data()), &unit);
    GL_COUNTS_REAL(glActiveTexture)(GL_TEXTURE0 + static_cast<GLenum>(unit));
    glGetIntegerv(binding, &texture);
    if (texture != 0 && seen.insert(texture).second) bytes += level_of(target).bytes();
  }
  GL_COUNTS_REAL(glActiveTexture)(static_cast<GLenum>(active));
  return bytes;
}

/// Bytes of a pixel of the target that is drawn to, over its colours and its depth.
double pixel_bytes() {
  constexpr std::array<GLenum, 6> kSizes{
      GL_FRAMEBUFFER_ATTACHMENT_RED_SIZE,   GL_FRAMEBUFFER_ATTACHMENT_GREEN_SIZE,
      GL_FRAMEBUFFER_ATTACHMENT_BLUE_SIZE,  GL_FRAMEBUFFER_ATTACHMENT_ALPHA_SIZE,
      GL_FRAMEBUFFER_ATTACHMENT_DEPTH_SIZE, GL_FRAMEBUFFER_ATTACHMENT_STENCIL_SIZE};
  double bits = 0;
  for (const GLenum at : {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2,
                          GL_COLOR_ATTACHMENT3, GL_DEPTH_ATTACHMENT}) {
    GLint kind = GL_NONE;
    glGetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, static_cast<GLenum>(at),
                                          GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE, &kind);
    if (kind == GL_NONE) continue;
    for (const GLenum what : kSizes) {
      GLint size = 0;
      glGetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, static_cast<GLenum>(at), what,
                                            &size);
      bits += size;
    }
  }
  return bits / 8;
}

struct Area {
  double target_px = 0, drawn_px = 0;
};
Area area() {
  std::array<GLint, 4> view{}, box{};
  glGetIntegerv(GL_VIEWPORT, view.data());
  glGetIntegerv(GL_SCISSOR_BOX, box.data());
  const double all = static_cast<double>(view[2]) * view[3];
  return {all, glIsEnabled(GL_SCISSOR_TEST) ? static_cast<double>(box[2]) * box[3] : all};
}

/// Value of an integer uniform, of up to four numbers; 0 for an unknown one.
std::array<GLint, 4> integers(GLuint program, const char* name) {
  std::array<GLint, 4> values{};
  const GLint at = glGetUniformLocation(program, name);
  if (at >= 0) glGetUniformiv(program, at, values.data());
  return values;
}

/// Share of blocks that a block step draws (shaders/blocks.vert); 1 for other programs.
double share_of_blocks(GLuint program, GLsizei vertices) {
  if (glGetUniformLocation(program, "wanted_flags") < 0) return 1;
  const GLint wanted = integers(program, "wanted_flags")[0];
  const bool others = integers(program, "others")[0] != 0;
  const std::array<GLint, 4> rect = integers(program, "wanted_px");
  GLint active = 0, texture = 0, before = 0;
  glGetIntegerv(GL_ACTIVE_TEXTURE, &active);
  GL_COUNTS_REAL(glActiveTexture)(GL_TEXTURE13);
  glGetIntegerv(GL_TEXTURE_BINDING_2D, &texture);
  const Level level = level_of(GL_TEXTURE_2D);
  glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &before);
  GLuint target = 0;
  glGenFramebuffers(1, &target);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, target);
  glFramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D,
                         static_cast<GLuint>(texture), 0);
  std::string pixels(static_cast<std::size_t>(16 * level.size[0] * level.size[1]), '\0');
  GL_COUNTS_REAL(glReadPixels)
  (0, 0, level.size[0], level.size[1], GL_RGBA, GL_FLOAT, pixels.data());
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(before));
  glDeleteFramebuffers(1, &target);
  GL_COUNTS_REAL(glActiveTexture)(static_cast<GLenum>(active));
  int drawn = 0;
  for (std::size_t i = 0; i < pixels.size(); i += 16) {
    float flags = 0;
    std::copy_n(pixels.data() + i, sizeof flags, reinterpret_cast<char*>(&flags));
    constexpr int kPx = mixrig::render::kBlockPx;
    const int block = static_cast<int>(i / 16), x = block % level.size[0] * kPx,
              y = block / level.size[0] * kPx;
    const bool in_rect = x + kPx > rect[0] && y + kPx > rect[1] && x < rect[2] && y < rect[3];
    drawn += (in_rect || (static_cast<int>(flags) & wanted) != 0) != others;
  }
  return 6.0 * drawn / vertices;
}

void count_draw(GLsizei vertices, bool mesh) {
  GLint program = 0;
  glGetIntegerv(GL_CURRENT_PROGRAM, &program);
  const auto found = state().program_names.find(object(static_cast<GLuint>(program)));
  Count& count = state().counts[found == state().program_names.end() ? "?" : found->second];
  const Area at = area();
  const double share = share_of_blocks(static_cast<GLuint>(program), vertices);
  const double part = at.target_px > 0 ? share * at.drawn_px / at.target_px : 0;
  ++count.draws;
  count.vertices += vertices;
  if (!mesh) count.pixels += static_cast<std::int64_t>(share * at.drawn_px);
  count.bytes_in += (mesh ? 1 : part) * bytes_bound(static_cast<GLuint>(program));
  count.bytes_out += share * at.drawn_px * pixel_bytes();
}

}  // namespace

extern "C" {

void glShaderSource(GLuint shader, GLsizei count, const GLchar* const* text, const GLint* length) {
  std::string all;
  for (GLsizei i = 0; i < count; ++i)
    all += length != nullptr && length[i] >= 0
               ? std::string(text[i], static_cast<std::size_t>(length[i]))
               : std::string(text[i]);
  const auto found = state().name_of_text.find(all);
  if (found != state().name_of_text.end()) state().shader_names[object(shader)] = found->second;
  GL_COUNTS_REAL(glShaderSource)(shader, count, text, length);
}

void glAttachShader(GLuint program, GLuint shader) {
  const std::string name = state().shader_names[object(shader)];
  std::string& own = state().program_names[object(program)];
  if (own.empty() || name.ends_with(".frag")) own = name.substr(0, name.rfind('.'));
  GL_COUNTS_REAL(glAttachShader)(program, shader);
}

/// Hides the formats of program binaries, so that no program comes without its text from a cache.
void glGetIntegerv(GLenum what, GLint* value) {
  GL_COUNTS_REAL(glGetIntegerv)(what, value);
  if (what == GL_NUM_PROGRAM_BINARY_FORMATS) *value = 0;
}

void glDrawArrays(GLenum mode, GLint first, GLsizei count) {
  count_draw(count, false);
  GL_COUNTS_REAL(glDrawArrays)(mode, first, count);
}

void glDrawElements(GLenum mode, GLsizei count, GLenum type, const void* indices) {
  count_draw(count, true);
  GL_COUNTS_REAL(glDrawElements)(mode, count, type, indices);
}

void glDrawElementsIndirect(GLenum mode, GLenum type, const void* indirect) {
  count_draw(0, true);
  GL_COUNTS_REAL(glDrawElementsIndirect)(mode, type, indirect);
}

void glTexSubImage2D(GLenum target, GLint level, GLint x, GLint y, GLsizei width, GLsizei height,
                     GLenum format, GLenum type, const void* pixels) {
  Count& count = state().counts["upload"];
  ++count.draws;
  count.bytes_out += level_of(target).texel_bytes * width * height;
  GL_COUNTS_REAL(glTexSubImage2D)(target, level, x, y, width, height, format, type, pixels);
}

void glReadPixels(GLint x, GLint y, GLsizei width, GLsizei height, GLenum format, GLenum type,
                  void* pixels) {
  Count& count = state().counts["read-back"];
  ++count.draws;
  count.bytes_in += 4.0 * width * height;
  GL_COUNTS_REAL(glReadPixels)(x, y, width, height, format, type, pixels);
}

void glBlitFramebuffer(GLint x0, GLint y0, GLint x1, GLint y1, GLint u0, GLint v0, GLint u1,
                       GLint v1, GLbitfield mask, GLenum filter) {
  Count& count = state().counts["blit"];
  const double bytes = pixel_bytes() * std::abs(x1 - x0) * std::abs(y1 - y0);
  ++count.draws;
  count.bytes_in += bytes, count.bytes_out += bytes;
  GL_COUNTS_REAL(glBlitFramebuffer)(x0, y0, x1, y1, u0, v0, u1, v1, mask, filter);
}
}
