// SPDX-License-Identifier: Apache-2.0
// Pass virtual: the objects at 2x2 samples a pixel, in the rectangle that they may touch. Each of
// the four is drawn as a picture of its own, beside and below the first: they lie on a turned grid.
#pragma once

#include <vector>

#include "host/render/gles/gl/gl_mesh.h"
#include "host/render/gles/gl/gl_program.h"

namespace mixrig::render::gles {

class VirtualPass {
 public:
  /// `glossy`: draws gloss and emission too.
  static Result<VirtualPass> create(bool glossy = false);
  /// `meshes` as params.draws. Errors: kUnsupported where there is no memory for a larger window.
  /// Allocates only where the rectangle is larger than all before.
  Result<void> draw(const FrameParams& params, const std::vector<GpuMesh>& meshes);

  /// Of the rectangle, a picture for each sample, 2x2 pictures: linear albedo with alpha 1 where
  /// covered, normals in 0..1, window depth (gl_convention.h).
  const Texture& albedo() const { return albedo_; }
  const Texture& normal() const { return normal_; }
  const Texture& depth() const { return depth_; }
  /// Metallic, roughness, specular; linear light of its own. Null where they are not drawn.
  const Texture* gloss() const { return glossy_ ? &gloss_ : nullptr; }
  const Texture* emission() const { return glossy_ ? &emission_ : nullptr; }

 private:
  Result<void> grow(Size samples);
  void draw_sample(const FrameParams& params, const std::vector<GpuMesh>& meshes,
                   glm::ivec2 sample);

  Texture albedo_, normal_, depth_, gloss_, emission_;
  bool glossy_ = false;
  Target target_;
  Program program_;
  struct {
    GLint camera_from_object, camera_from_object_normal, clip_from_camera, base_color, double_sided;
    GLint gloss, emission, has_normal_map, normal_scale;
  } at_{};
};

}  // namespace mixrig::render::gles
