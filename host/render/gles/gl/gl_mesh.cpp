// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/gl/gl_mesh.h"

#include <span>

namespace mixrig::render::gles {
namespace {

template <typename T>
BufferHandle make_buffer(GLenum target, std::span<const T> values) {
  GLuint name = 0;
  glGenBuffers(1, &name);
  glBindBuffer(target, name);
  glBufferData(target, static_cast<GLsizeiptr>(values.size_bytes()), values.data(), GL_STATIC_DRAW);
  return BufferHandle(name);
}

/// Fills a buffer and makes it attribute `index` of the bound vertex array.
template <typename T>
BufferHandle make_attribute(GLuint index, std::span<const T> values) {
  BufferHandle buffer = make_buffer(GL_ARRAY_BUFFER, values);
  glEnableVertexAttribArray(index);
  glVertexAttribPointer(index, T::length(), GL_FLOAT, GL_FALSE, 0, nullptr);
  return buffer;
}

Texture texture_of(const MeshView& mesh, ImageView<const Rgb8> map, GLenum format) {
  static constexpr Rgb8 kWhite{255, 255, 255};
  if (map.empty() || mesh.uv.empty())
    return make_texture(ImageView<const Rgb8>{&kWhite, {1, 1}, 1}, format);
  return make_texture(map, format, Sampling::kRepeat);
}

}  // namespace

GpuMesh::GpuMesh(const MeshView& mesh)
    : texture_(texture_of(mesh, mesh.texture, GL_SRGB8)),
      gloss_map_(texture_of(mesh, mesh.gloss_map, GL_RGB8)),
      normal_map_(texture_of(mesh, mesh.normal_map, GL_RGB8)),
      emission_map_(texture_of(mesh, mesh.emission_map, GL_SRGB8)),
      index_count_(static_cast<GLsizei>(mesh.indices.size())) {
  GLuint name = 0;
  glGenVertexArrays(1, &name);
  vertex_array_ = VertexArrayHandle(name);
  glBindVertexArray(name);
  positions_ = make_attribute(0, mesh.positions_m);
  normals_ = make_attribute(1, mesh.normals);
  if (!mesh.uv.empty()) uv_ = make_attribute(2, mesh.uv);
  indices_ = make_buffer(GL_ELEMENT_ARRAY_BUFFER, mesh.indices);
  glBindVertexArray(0);
}

void GpuMesh::bind_maps() const {
  int unit = 0;
  for (const Texture* map : {&texture_, &gloss_map_, &normal_map_, &emission_map_})
    bind(unit++, *map);
}

void GpuMesh::draw() const {
  glBindVertexArray(vertex_array_.get());
  glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
  glBindVertexArray(0);
}

}  // namespace mixrig::render::gles
