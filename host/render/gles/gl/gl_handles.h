// SPDX-License-Identifier: Apache-2.0
// Owning wrappers of GL names. They must be destroyed while their context is current.
#pragma once

#include <utility>

#include <GLES3/gl31.h>

namespace mixrig::render::gles {

/// Owns one GL name and deletes it; 0 owns nothing.
template <void (*kDelete)(GLuint)>
class Handle {
 public:
  Handle() = default;
  explicit Handle(GLuint name) : name_(name) {}
  Handle(Handle&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~Handle() {
    if (name_ != 0) kDelete(name_);
  }
  GLuint get() const { return name_; }
  explicit operator bool() const { return name_ != 0; }

 private:
  GLuint name_ = 0;
};

namespace detail {
inline void delete_texture(GLuint name) { glDeleteTextures(1, &name); }
inline void delete_framebuffer(GLuint name) { glDeleteFramebuffers(1, &name); }
inline void delete_buffer(GLuint name) { glDeleteBuffers(1, &name); }
inline void delete_vertex_array(GLuint name) { glDeleteVertexArrays(1, &name); }
inline void delete_shader(GLuint name) { glDeleteShader(name); }
inline void delete_program(GLuint name) { glDeleteProgram(name); }
}  // namespace detail

using TextureHandle = Handle<detail::delete_texture>;
using FramebufferHandle = Handle<detail::delete_framebuffer>;
using BufferHandle = Handle<detail::delete_buffer>;
using VertexArrayHandle = Handle<detail::delete_vertex_array>;
using ShaderHandle = Handle<detail::delete_shader>;
using ProgramHandle = Handle<detail::delete_program>;

}  // namespace mixrig::render::gles
