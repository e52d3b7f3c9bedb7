// SPDX-License-Identifier: Apache-2.0
// Pass correct: turns ToF depth into a grid of vertices with links.
#pragma once

#include "host/render/gles/gl/gl_step.h"

namespace mixrig::render::gles {

class CorrectPass {
 public:
  static Result<CorrectPass> create(const Tables& tables);
  void upload_depth(ImageView<const float> depth_m) const { upload(depth_, depth_m); }
  void draw() const;
  /// Runs the pass with the vertices in another texture of their size and format.
  void draw_into(const Target& vertices) const;
  /// The pass in two halves: corrected depths, then links between depths z_m, which are z_m() or
  /// those of pass agree.
  void draw_depth() const;
  void link(const Texture& z_m) const { run_into(link_.target, link_.program, {&z_m, &step_}); }
  const Texture& tof_ray() const { return ray_; }
  /// z as measured, without stray pieces, GL_R32F, metres, 0 unknown.
  const Texture& raw_z_m() const { return raw_z_; }
  /// z without flying pixels; z_m() is that, smoothed. Same format.
  const Texture& clean_z_m() const { return clean_z_; }
  const Texture& z_m() const { return z_; }
  const Texture& step_m() const { return step_; }
  /// GL_RGBA32F: w, its two slopes, links (correct_links.frag).
  const Texture& vertices() const { return vertices_; }

 private:
  Texture depth_, ray_, raw_z_, bend_, clean_z_, step_, z_, vertices_;
  Step to_z_, drop_stray_, find_bend_, clean_, smooth_, link_;
};

}  // namespace mixrig::render::gles
