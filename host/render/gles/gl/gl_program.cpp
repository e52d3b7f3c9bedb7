// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/gl/gl_program.h"

#include <array>
#include <cstdio>
#include <initializer_list>
#include <optional>
#include <vector>

#include "hal/base/log.h"
#include "hal/base/partial_path.h"
#include "host/render/gles/gl/program_file.h"
#include "shaders/shaders.h"

namespace mixrig::render::gles {
namespace {

using Files = std::vector<std::string_view>;

/// Puts the driver's log on one line.
std::string one_line(std::string log) {
  while (!log.empty() && (log.back() == '\n' || log.back() == '\0')) log.pop_back();
  for (char& c : log)
    if (c == '\n') c = ' ';
  return log;
}

/// A stage of a program, named as in shaders/.
struct NamedStage {
  GLenum kind;
  std::string_view name;
};
using NamedStages = std::initializer_list<NamedStage>;

Result<const shaders::Stage*> find(std::string_view name) {
  if (const shaders::Stage* stage = shaders::find_stage(name)) return stage;
  return Error{ErrorCode::kDevice, "no shader " + std::string(name) + " in this build"};
}

bool is_linked(const ProgramHandle& program) {
  GLint fine = 0;
  glGetProgramiv(program.get(), GL_LINK_STATUS, &fine);
  return fine != 0;
}

std::string names_of(NamedStages stages) {
  std::string names;
  for (const NamedStage& stage : stages)
    names += (names.empty() ? "" : " and ") + std::string(stage.name);
  return names;
}

Result<ProgramHandle> build(NamedStages stages) {
  ProgramHandle program(glCreateProgram());
  std::vector<ShaderHandle> compiled;
  for (const auto& [kind, name] : stages) {
    MIXRIG_ASSIGN(const shaders::Stage* const stage, find(name));
    MIXRIG_ASSIGN(ShaderHandle shader, compile(kind, stage->text, stage->name, stage->files));
    glAttachShader(program.get(), shader.get());
    compiled.push_back(std::move(shader));
  }
  glProgramParameteri(program.get(), GL_PROGRAM_BINARY_RETRIEVABLE_HINT, GL_TRUE);
  glLinkProgram(program.get());
  if (is_linked(program)) return program;
  GLint log_size = 0;
  glGetProgramiv(program.get(), GL_INFO_LOG_LENGTH, &log_size);
  std::string log(static_cast<std::size_t>(log_size), '\0');
  glGetProgramInfoLog(program.get(), log_size, nullptr, log.data());
  return Error{ErrorCode::kDevice, "shader " + names_of(stages) + " does not link (" +
                                       one_line(log) + "): use --backend cpu"};
}

std::string driver_text(GLenum what) {
  const GLubyte* text = glGetString(what);
  return text == nullptr ? "" : reinterpret_cast<const char*>(text);
}

/// Path and key of a program's file for this driver and these stages; nullopt if the driver gives
/// no binaries or there is no folder.
std::optional<std::filesystem::path> path_of(NamedStages stages, std::uint64_t& key) {
  GLint formats = 0;
  glGetIntegerv(GL_NUM_PROGRAM_BINARY_FORMATS, &formats);
  const std::filesystem::path folder = program_folder();
  if (formats == 0 || folder.empty()) return std::nullopt;
  std::string texts;
  for (const NamedStage& stage : stages)
    if (const shaders::Stage* found = shaders::find_stage(stage.name))
      texts.append(found->name).append(found->text);
  key = program_key({driver_text(GL_VENDOR), driver_text(GL_RENDERER), driver_text(GL_VERSION),
                     driver_text(GL_SHADING_LANGUAGE_VERSION), texts});
  std::array<char, 24> name{};
  std::snprintf(name.data(), name.size(), "%016llx.bin", static_cast<unsigned long long>(key));
  return folder / name.data();
}

/// Loads a program kept by an earlier run; an empty handle if there is none that this driver
/// accepts.
ProgramHandle load(const std::filesystem::path& path, std::uint64_t key) {
  const std::string file = read_program_file(path);
  const std::optional<ProgramBinary> binary = from_program_file(key, file);
  if (!binary) return {};
  ProgramHandle program(glCreateProgram());
  glProgramBinary(program.get(), binary->format, binary->bytes.data(),
                  static_cast<GLsizei>(binary->bytes.size()));
  if (is_linked(program)) return program;
  (void)glGetError();  // clears the error of a format that the driver no longer has
  return {};
}

/// Writes a program's file; failing to write only makes the next start slower.
void keep(const ProgramHandle& program, const std::filesystem::path& path, std::uint64_t key) {
  GLint size = 0;
  glGetProgramiv(program.get(), GL_PROGRAM_BINARY_LENGTH, &size);
  if (size <= 0) return;
  std::string bytes(static_cast<std::size_t>(size), '\0');
  GLenum format = 0;
  GLsizei written = 0;
  glGetProgramBinary(program.get(), size, &written, &format, bytes.data());
  if (glGetError() != GL_NO_ERROR || written <= 0) return;
  bytes.resize(static_cast<std::size_t>(written));
  std::error_code ignored;
  std::filesystem::create_directories(path.parent_path(), ignored);
  if (const auto kept = write_file(path, to_program_file(key, {format, bytes})); !kept)
    log_info("gles", "shader is not kept: " + to_line(kept.error()));
}

Result<Program> make(NamedStages stages) {
  std::uint64_t key = 0;
  const auto path = path_of(stages, key);
  if (path)
    if (ProgramHandle kept = load(*path, key)) return Program(std::move(kept));
  MIXRIG_ASSIGN(ProgramHandle program, build(stages));
  if (path) keep(program, *path, key);
  return Program(std::move(program));
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
  return Error{ErrorCode::kDevice, "shader " + std::string(name) + " does not compile (" +
                                       one_line(shaders::name_files(log, files)) +
                                       "): use --backend cpu"};
}

Result<Program> make_program(std::string_view vertex_stage, std::string_view fragment_stage) {
  return make({{GL_VERTEX_SHADER, vertex_stage}, {GL_FRAGMENT_SHADER, fragment_stage}});
}

Result<Program> make_program(std::string_view compute_stage) {
  return make({{GL_COMPUTE_SHADER, compute_stage}});
}

}  // namespace mixrig::render::gles
