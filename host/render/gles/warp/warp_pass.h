// SPDX-License-Identifier: Apache-2.0
// Pass warp: draws triangles of the ToF grid into the view and keeps the nearest surface.
#pragma once

#include "host/render/gles/gl/gl_step.h"

namespace mixrig::render::gles {

class WarpPass {
 public:
  static Result<WarpPass> create(const Tables& tables);
  /// Makes a pass without a target, only for add() into the target of another pass.
  static Result<WarpPass> create_without_view(const Tables& tables);
  /// Sets the pose, in place of Tables::warp's, for later draws.
  void set_pose(const glm::mat4& camera_from_tof);
  /// Sets view and pose from `tables` for later draws.
  void set_view(const Tables& tables);
  /// Draws a grid. `vertices`, `tof_ray`, `raw_z_m`: from CorrectPass.
  void draw(const Texture& vertices, const Texture& tof_ray, const Texture& raw_z_m) const {
    clear();
    add(vertices, tof_ray, raw_z_m, target_);
  }
  void clear() const;
  /// Drops the depth of the target. Called after the last draw or add() of a frame.
  void finish() const;
  /// Draws into `target` without clearing it; nearer surfaces win.
  void add(const Texture& vertices, const Texture& tof_ray, const Texture& raw_z_m,
           const Target& target) const;
  /// Inverse depth, GL_R32F, 1/m: 0 unknown, negative where a cut cell was drawn.
  const Texture& w() const { return w_; }
  const Target& target() const { return target_; }

 private:
  void find_triangles(const Texture& vertices) const;

  Size tof_size_;
  int group_cells_ = 1;  ///< cells a work group of cells.comp
  Texture w_, depth_, reaches_;
  Target target_;
  BufferHandle arguments_, indices_;
  VertexArrayHandle vertex_array_;
  Program cells_, warp_;
  Step reach_;
};

}  // namespace mixrig::render::gles
