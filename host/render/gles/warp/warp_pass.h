// SPDX-License-Identifier: Apache-2.0
// Pass warp: triangles of the ToF grid, drawn into the view; the nearest surface is kept.
#pragma once

#include "host/render/gles/gl/gl_program.h"
#include "host/render/gles/gl/gl_texture.h"

namespace mixrig::render::gles {

class WarpPass {
 public:
  static Result<WarpPass> create(const Tables& tables);
  /// Without a view of its own: only for add() into the target of another one.
  static Result<WarpPass> create_without_view(const Tables& tables);
  /// In place of Tables::warp, from the next draw() on.
  void set_pose(const glm::mat4& camera_from_tof) { warp_.set("camera_from_tof", camera_from_tof); }
  /// View, and the pose that set_pose() sets, of `tables`; from the next draw() on.
  void set_view(const Tables& tables);
  /// `vertices`, `tof_ray`, `raw_z_m`: of CorrectPass. `plate`: of the view, linear light when
  /// sampled; null: it is not known.
  void draw(const Texture& vertices, const Texture& tof_ray, const Texture& raw_z_m,
            const Texture* plate = nullptr) const {
    clear();
    add(vertices, tof_ray, raw_z_m, target_, plate);
  }
  void clear() const;
  /// Draws before or behind what was drawn.
  void add(const Texture& vertices, const Texture& tof_ray, const Texture& raw_z_m,
           const Target& target, const Texture* plate = nullptr) const;
  /// GL_R32F, 1/m: 0 unknown, negative where a cut cell drew.
  const Texture& w() const { return w_; }
  const Target& target() const { return target_; }

 private:
  void find_triangles(const Texture& vertices) const;

  Size tof_size_;
  int group_cells_ = 1;  ///< of a work group of cells.comp
  Texture w_, depth_;
  Target target_;
  BufferHandle arguments_, indices_;
  VertexArrayHandle vertex_array_;
  Program cells_, warp_;
};

}  // namespace mixrig::render::gles
