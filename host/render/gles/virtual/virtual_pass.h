// SPDX-License-Identifier: Apache-2.0
// Pass virtual: draws objects with four samples a pixel, within the rectangle that they may touch.
// The samples lie on a rotated grid, so each is drawn as a picture of its own; the four pictures
// lie beside and below one another in one target.
#pragma once

#include <vector>

#include "host/render/gles/gl/gl_mesh.h"
#include "host/render/gles/gl/gl_program.h"

namespace mixrig::render::gles {

/// Checks that the samples of a view fit into a texture whose sides are at most `most_texels`.
/// Errors: kUnsupported.
Result<void> check_samples(Size view, int most_texels);

class VirtualPass {
 public:
  /// `glossy`: also draws gloss and emission.
  static Result<VirtualPass> create(bool glossy = false);
  /// Draws the samples; `meshes` in the order of params.draws. Allocates only if the rectangle is
  /// larger than ever before. Errors: kUnsupported without memory for it.
  Result<void> draw(const FrameParams& params, const std::vector<GpuMesh>& meshes);

  /// Samples of the rectangle as 2x2 pictures: linear albedo with alpha 1 where covered, normals
  /// mapped to 0..1, and window depth (gl_convention.h).
  const Texture& albedo() const { return albedo_; }
  const Texture& normal() const { return normal_; }
  const Texture& depth() const { return depth_; }
  /// (Metallic, roughness, specular), and emitted linear light. Null if they are not drawn.
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
