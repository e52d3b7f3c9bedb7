// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/gl_program.h"

#include <initializer_list>
#include <vector>

#include "shaders/shaders.h"

namespace mixrig::render::gles {
namespace {

using Files = std::vector<std::string_view>;

/// The driver's log, on one line.
std::string one_line(std::string log) {
  while (!log.empty() && (log.back() == '\n' || log.back() == '\0')) log.pop_back();
  for (char& c : log)
    if (c == '\n') c = ' ';
  return log;
}

Result<ShaderHandle> compile_stage(GLenum kind, std::string_view name) {
  const shaders::Stage* stage = shaders::find_stage(name);
  if (!stage) return Error{ErrorCode::kDevice, "no shader " + std::string(name) + " in this build"};
  return compile(kind, stage->text, stage->name, stage->files);
}

Result<Program> link(std::initializer_list<GLuint> stages, const std::string& names) {
  ProgramHandle program(glCreateProgram());
  for (const GLuint stage : stages) glAttachShader(program.get(), stage);
  glLinkProgram(program.get());
  GLint fine = 0, log_size = 0;
  glGetProgramiv(program.get(), GL_LINK_STATUS, &fine);
  if (fine) return Program(std::move(program));
  glGetProgramiv(program.get(), GL_INFO_LOG_LENGTH, &log_size);
  std::string log(static_cast<std::size_t>(log_size), '\0');
  glGetProgramInfoLog(program.get(), log_size, nullptr, log.data());
  return Error{ErrorCode::kDevice, "shader " + names + " does not link: " + one_line(log)};
}

}  // namespace

Result<ShaderHandle> compile(GLenum kind, std::string_view text, std::string_view name,
                             const Files& files) {
  ShaderHandle shader(glCreateShader(kind));
  const char* data = text.data();
  const auto length = static_cast<GLint>(text.size());
  glShaderSource(shader.get(), 1, &data, &length);
  glCompileShader(shader.get());
  GLint fine = 0, log_size = 0;
  glGetShaderiv(shader.get(), GL_COMPILE_STATUS, &fine);
  if (fine) return shader;
  glGetShaderiv(shader.get(), GL_INFO_LOG_LENGTH, &log_size);
  std::string log(static_cast<std::size_t>(log_size), '\0');
  glGetShaderInfoLog(shader.get(), log_size, nullptr, log.data());
  return Error{ErrorCode::kDevice, "shader " + std::string(name) + " does not compile: " +
                                       one_line(shaders::name_files(log, files))};
}

Result<Program> make_program(std::string_view vertex_stage, std::string_view fragment_stage) {
  MIXRIG_ASSIGN(const ShaderHandle vertex, compile_stage(GL_VERTEX_SHADER, vertex_stage));
  MIXRIG_ASSIGN(const ShaderHandle fragment, compile_stage(GL_FRAGMENT_SHADER, fragment_stage));
  return link({vertex.get(), fragment.get()},
              std::string(vertex_stage) + " and " + std::string(fragment_stage));
}

Result<Program> make_program(std::string_view compute_stage) {
  MIXRIG_ASSIGN(const ShaderHandle shader, compile_stage(GL_COMPUTE_SHADER, compute_stage));
  return link({shader.get()}, std::string(compute_stage));
}

}  // namespace mixrig::render::gles
