// SPDX-License-Identifier: Apache-2.0
// Compiled shaders and their uniforms.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "hal/base/result.h"
#include "host/render/contract/passes.h"
#include "host/render/gles/gl/gl_handles.h"

namespace mixrig::render::gles {

/// A linked program. Uniforms keep their values until they are set again.
class Program {
 public:
  Program() = default;
  explicit Program(ProgramHandle handle) : handle_(std::move(handle)) {}
  void use() const { glUseProgram(handle_.get()); }
  /// Location of a uniform, to be looked up once when a pass is made; -1, which GL ignores, for an
  /// unknown name.
  GLint location(const std::string& name) const {
    return glGetUniformLocation(handle_.get(), name.c_str());
  }
  /// Invocations along x of a work group of a compute program (its local_size_x).
  int work_group_size() const {
    std::array<GLint, 3> size{};
    glGetProgramiv(handle_.get(), GL_COMPUTE_WORK_GROUP_SIZE, size.data());
    return size[0];
  }
  /// Sets a uniform by name; binds the program. For values that hold for a take.
  template <typename T>
  void set(const std::string& name, const T& value) const;

 private:
  ProgramHandle handle_;
};

/// Compiles and links two stages of shaders/, or loads the program from program_folder() if an
/// earlier run kept it for the same driver and text; new programs are kept there. A damaged or
/// refused file is rebuilt. Errors: kDevice, with file, line and log.
Result<Program> make_program(std::string_view vertex_stage, std::string_view fragment_stage);
/// Builds or loads a compute program in the same way. Errors: kDevice, with file, line and log.
Result<Program> make_program(std::string_view compute_stage);
/// Compiles one stage from text. Errors: kDevice, with file, line and log.
Result<ShaderHandle> compile(GLenum kind, std::string_view text, std::string_view name,
                             const std::vector<std::string_view>& files);

/// These set a uniform of the program in use.
inline void set_uniform(GLint at, bool v) { glUniform1i(at, v ? 1 : 0); }
inline void set_uniform(GLint at, int v) { glUniform1i(at, v); }
inline void set_uniform(GLint at, float v) { glUniform1f(at, v); }
inline void set_uniform(GLint at, const glm::vec2& v) { glUniform2f(at, v.x, v.y); }
inline void set_uniform(GLint at, const glm::ivec2& v) { glUniform2i(at, v.x, v.y); }
inline void set_uniform(GLint at, const glm::ivec3& v) { glUniform3i(at, v.x, v.y, v.z); }
inline void set_uniform(GLint at, const glm::ivec4& v) { glUniform4i(at, v.x, v.y, v.z, v.w); }
inline void set_uniform(GLint at, const glm::vec3& v) { glUniform3f(at, v.x, v.y, v.z); }
inline void set_uniform(GLint at, const glm::vec4& v) { glUniform4f(at, v.x, v.y, v.z, v.w); }
inline void set_uniform(GLint at, const glm::mat3& v) {
  glUniformMatrix3fv(at, 1, GL_FALSE, &v[0][0]);
}
inline void set_uniform(GLint at, const glm::mat4& v) {
  glUniformMatrix4fv(at, 1, GL_FALSE, &v[0][0]);
}
inline void set_uniform(GLint at, std::span<const glm::vec3> v) {
  glUniform3fv(at, static_cast<GLsizei>(v.size()), &v[0].x);
}
inline void set_uniform(GLint at, std::span<const float> v) {
  glUniform1fv(at, static_cast<GLsizei>(v.size()), v.data());
}
inline void set_uniform(GLint at, std::span<const glm::mat4> v) {
  glUniformMatrix4fv(at, static_cast<GLsizei>(v.size()), GL_FALSE, &v[0][0][0]);
}

template <typename T>
void Program::set(const std::string& name, const T& value) const {
  use();
  set_uniform(location(name), value);
}

}  // namespace mixrig::render::gles
