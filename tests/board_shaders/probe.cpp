// SPDX-License-Identifier: Apache-2.0
// Compiles, links and draws programs in one OpenGL ES 3.1 context, so that a driver says what it
// made of them. Runs in an emulator, without a GPU: nothing is drawn that could be looked at.
//   usage: probe FOLDER < PROGRAMS    FOLDER: of expanded stages; a line of PROGRAMS as in
//                                     programs.txt
// Writes one line an event: `renderer NAME`, `program NAME`, `message TEXT` of the driver,
// `failed NAME TEXT`. Uses the C library alone, since the folder of the drivers has no C++ library.
#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLES2/gl2.h>  // what gl2ext.h needs before it
#include <GLES2/gl2ext.h>
#include <GLES3/gl31.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

namespace {

constexpr int kMostColors = 4;
constexpr int kMostWords = 8;
constexpr int kSidePx = 64;

struct Format {
  const char* name;
  GLenum value;
};
constexpr Format kFormats[] = {{"R8", GL_R8},           {"R16F", GL_R16F},
                               {"R32F", GL_R32F},       {"RG16F", GL_RG16F},
                               {"RG32F", GL_RG32F},     {"RGBA8", GL_RGBA8},
                               {"RGBA16F", GL_RGBA16F}, {"RGBA32F", GL_RGBA32F},
                               {"R16UI", GL_R16UI},     {"RGB10_A2", GL_RGB10_A2},
                               {"R8UI", GL_R8UI},       {"SRGB8_ALPHA8", GL_SRGB8_ALPHA8}};

struct Given {
  const char* vertex = nullptr;
  const char* fragment = nullptr;  // null: a compute program
  GLenum colors[kMostColors] = {};
  int count = 0;
  bool depth = false;
  const char* name() const { return fragment ? fragment : vertex; }
};

bool fail(const Given& program, const char* what, const char* detail = "") {
  printf("failed %s %s", program.name(), what);
  for (const char* c = detail; *c; ++c) putchar(*c == '\n' ? ' ' : *c);
  putchar('\n');
  return false;
}

// Splits a line in place. Returns false for one that names no program.
bool parse(char* line, Given& program) {
  program = {};
  char* words[kMostWords];
  int count = 0;
  for (char* word = strtok(line, " \n"); word && count < kMostWords; word = strtok(nullptr, " \n"))
    words[count++] = word;
  if (count == 0 || words[0][0] == '#') return false;
  program.vertex = words[0];
  program.fragment = count > 1 ? words[1] : nullptr;
  for (int i = 2; i < count; ++i) {
    if (strcmp(words[i], "depth") == 0) program.depth = true;
    for (const Format& format : kFormats)
      if (strcmp(words[i], format.name) == 0 && program.count < kMostColors)
        program.colors[program.count++] = format.value;
  }
  return true;
}

char* read_stage(const char* folder, const char* name, const char* kind) {
  char path[4096];
  snprintf(path, sizeof path, "%s/%s.%s", folder, name, kind);
  FILE* file = fopen(path, "rb");
  if (!file) return nullptr;
  fseek(file, 0, SEEK_END);
  const long size = ftell(file);
  rewind(file);
  char* text = static_cast<char*>(calloc(1, static_cast<size_t>(size) + 1));
  const size_t got = fread(text, 1, static_cast<size_t>(size), file);
  fclose(file);
  if (got == static_cast<size_t>(size)) return text;
  free(text);
  return nullptr;
}

bool attach(GLuint to, GLenum kind, const char* folder, const char* stage, const char* ending,
            const Given& program) {
  char* text = read_stage(folder, stage, ending);
  if (!text) return fail(program, "has no stage ", stage);
  const GLuint shader = glCreateShader(kind);
  const char* texts[] = {text};
  glShaderSource(shader, 1, texts, nullptr);
  glCompileShader(shader);
  free(text);
  GLint fine = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &fine);
  glAttachShader(to, shader);
  if (fine) return true;
  char log[4096] = "";
  glGetShaderInfoLog(shader, sizeof log, nullptr, log);
  return fail(program, "does not compile: ", log);
}

bool link(GLuint made, const Given& program) {
  glLinkProgram(made);
  GLint fine = 0;
  glGetProgramiv(made, GL_LINK_STATUS, &fine);
  if (fine) return true;
  char log[4096] = "";
  glGetProgramInfoLog(made, sizeof log, nullptr, log);
  return fail(program, "does not link: ", log);
}

GLuint make_texture(GLenum target, GLenum format) {
  GLuint name = 0;
  glGenTextures(1, &name);
  glBindTexture(target, name);
  if (target == GL_TEXTURE_2D)
    glTexStorage2D(target, 1, format, kSidePx, kSidePx);
  else
    glTexStorage3D(target, 1, format, kSidePx, kSidePx, 4);
  glTexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  return name;
}

// Gives every sampler of the program in use a texture.
void bind_textures(GLuint made) {
  GLint count = 0;
  glGetProgramiv(made, GL_ACTIVE_UNIFORMS, &count);
  for (GLint i = 0; i < count; ++i) {
    char name[128];
    GLint size = 0, unit = 0;
    GLenum kind = 0;
    glGetActiveUniform(made, static_cast<GLuint>(i), sizeof name, nullptr, &size, &kind, name);
    const GLenum target = kind == GL_SAMPLER_2D         ? GL_TEXTURE_2D
                          : kind == GL_SAMPLER_3D       ? GL_TEXTURE_3D
                          : kind == GL_SAMPLER_2D_ARRAY ? GL_TEXTURE_2D_ARRAY
                                                        : 0;
    if (!target) continue;
    glGetUniformiv(made, glGetUniformLocation(made, name), &unit);
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
    make_texture(target, GL_RGBA16F);
  }
}

bool draw(const Given& program) {
  GLuint frame = 0;
  GLenum buffers[kMostColors] = {};
  glActiveTexture(GL_TEXTURE15);
  glGenFramebuffers(1, &frame);
  glBindFramebuffer(GL_FRAMEBUFFER, frame);
  for (int i = 0; i < program.count; ++i) {
    buffers[i] = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(i);
    glFramebufferTexture2D(GL_FRAMEBUFFER, buffers[i], GL_TEXTURE_2D,
                           make_texture(GL_TEXTURE_2D, program.colors[i]), 0);
  }
  if (program.depth)
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D,
                           make_texture(GL_TEXTURE_2D, GL_DEPTH_COMPONENT32F), 0);
  program.depth ? glEnable(GL_DEPTH_TEST) : glDisable(GL_DEPTH_TEST);
  glDrawBuffers(program.count, buffers);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    return fail(program, "has a target that the driver cannot draw into");
  glViewport(0, 0, kSidePx, kSidePx);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glFlush();
  return true;
}

void compute() {
  constexpr GLsizeiptr kBytes = 1 << 16;
  GLuint buffers[2];
  glGenBuffers(2, buffers);
  for (GLuint i = 0; i < 2; ++i) {
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, i, buffers[i]);
    glBufferData(GL_SHADER_STORAGE_BUFFER, kBytes, nullptr, GL_DYNAMIC_DRAW);
  }
  glDispatchCompute(1, 1, 1);
  glFlush();
}

// Gives the uniform blocks of a program room.
void bind_blocks() {
  constexpr GLsizeiptr kBytes = 1 << 14;
  for (GLuint i = 0; i < 2; ++i) {
    GLuint buffer = 0;
    glGenBuffers(1, &buffer);
    glBindBufferBase(GL_UNIFORM_BUFFER, i, buffer);
    glBufferData(GL_UNIFORM_BUFFER, kBytes, nullptr, GL_DYNAMIC_DRAW);
  }
}

bool probe(const char* folder, const Given& program) {
  printf("program %s\n", program.name());
  const GLuint made = glCreateProgram();
  const bool attached =
      program.fragment
          ? attach(made, GL_VERTEX_SHADER, folder, program.vertex, "vert", program) &&
                attach(made, GL_FRAGMENT_SHADER, folder, program.fragment, "frag", program)
          : attach(made, GL_COMPUTE_SHADER, folder, program.vertex, "comp", program);
  if (!attached || !link(made, program)) return false;
  glUseProgram(made);
  bind_textures(made);
  bind_blocks();
  if (!program.fragment)
    compute();
  else if (!draw(program))
    return false;
  const GLenum error = glGetError();
  return error == GL_NO_ERROR || fail(program, "ends in a GL error");
}

void GL_APIENTRY tell(GLenum, GLenum, GLuint, GLenum, GLsizei, const GLchar* text, const void*) {
  printf("message %s\n", text);
}

bool make_context() {
  const auto get = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
      eglGetProcAddress("eglGetPlatformDisplayEXT"));
  const EGLDisplay display = get(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (!eglInitialize(display, nullptr, nullptr)) return false;
  eglBindAPI(EGL_OPENGL_ES_API);
  constexpr EGLint kWanted[] = {EGL_CONTEXT_MAJOR_VERSION,
                                3,
                                EGL_CONTEXT_MINOR_VERSION,
                                1,
                                EGL_CONTEXT_OPENGL_DEBUG,
                                1,
                                EGL_NONE};
  const EGLContext context = eglCreateContext(display, nullptr, EGL_NO_CONTEXT, kWanted);
  return context && eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context);
}

}  // namespace

int main(int count, char** arguments) {
  setvbuf(stdout, nullptr, _IOLBF, 0);
  if (count != 2 || !make_context()) return 2;
  printf("renderer %s\n", reinterpret_cast<const char*>(glGetString(GL_RENDERER)));
  const auto set_callback = reinterpret_cast<PFNGLDEBUGMESSAGECALLBACKKHRPROC>(
      eglGetProcAddress("glDebugMessageCallbackKHR"));
  glEnable(GL_DEBUG_OUTPUT_KHR);
  glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS_KHR);
  set_callback(tell, nullptr);
  bool fine = true;
  char line[512];
  Given program;
  while (fgets(line, sizeof line, stdin))
    if (parse(line, program)) fine = probe(arguments[1], program) && fine;
  return fine ? 0 : 1;
}
