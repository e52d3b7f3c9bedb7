// SPDX-License-Identifier: Apache-2.0
// Meshes in GPU memory.
#pragma once

#include "host/render/gles/gl/gl_handles.h"
#include "host/render/gles/gl/gl_texture.h"

namespace mixrig::render::gles {

/// Vertices, triangles and maps of one MeshView. Attribute 0 is the position in metres, 1 the
/// normal, 2 the uv.
class GpuMesh {
 public:
  explicit GpuMesh(const MeshView& mesh);
  /// Binds texture, gloss, normal and emission map to units 0 to 3; missing maps are one white
  /// pixel.
  void bind_maps() const;
  void draw() const;

 private:
  BufferHandle positions_, normals_, uv_, indices_;
  VertexArrayHandle vertex_array_;
  Texture texture_, gloss_map_, normal_map_, emission_map_;
  GLsizei index_count_;
};

}  // namespace mixrig::render::gles
