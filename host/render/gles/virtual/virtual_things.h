// SPDX-License-Identifier: Apache-2.0
// Virtual objects over time: their pixels, shadows of objects and people, shading, and the camera's
// look. Results that depend on the pose alone are kept while it stays.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host/render/frame/used_look.h"
#include "host/render/gles/background/room.h"
#include "host/render/gles/gl/gl_mesh.h"
#include "host/render/gles/gl/stage_timer.h"
#include "host/render/gles/key/key_pass.h"
#include "host/render/gles/light/light_pass.h"
#include "host/render/gles/light/people_shadow_pass.h"
#include "host/render/gles/light/shadow_pass.h"
#include "host/render/gles/mix/look_pass.h"
#include "host/render/gles/mix/mix_pass.h"
#include "host/render/gles/mix/motion_pass.h"
#include "host/render/gles/virtual/edge_pass.h"
#include "host/render/gles/virtual/virtual_pass.h"

namespace mixrig::render::gles {

/// Used by one compositor whose setup has objects.
class VirtualThings {
 public:
  /// Borrows `setup` and `frame`. Errors: those of the passes.
  static Result<VirtualThings> create(const CompositorSetup& setup, const Tables& tables,
                                      const FrameParams& frame);
  /// Sets another view of the same size.
  void set_view(const Tables& tables);
  /// Takes the look of this frame, even if the frame does not show the objects.
  void take_look(const FrameInput& input);
  /// Draws samples and shadow maps if the pose has changed; moves the grain in each frame.
  Result<void> draw(StageTimer& timer);
  /// Shades the objects and lights `room` if the pose has changed; people and their shadows, from
  /// `key`, are computed in each frame. `key`: null if nothing is keyed. `people`: the light map of
  /// this frame is wanted.
  Result<void> light(const Room& room, const KeyPass* key, bool people, StageTimer& timer);
  /// Blurs the objects by the lens, then by the camera's motion.
  void blur(const std::optional<CameraMotion>& motion);

  /// Null if no object takes light from other surfaces, or nothing is keyed. Call it after
  /// draw().
  const LightPass* light_map(const KeyPass* key) const {
    return has_shadows_ && key != nullptr ? &light_ : nullptr;
  }
  /// Sets the inputs of pass mix for this frame.
  void add_to(MixInput& input) const;

 private:
  VirtualThings(const CompositorSetup& setup, const FrameParams& frame);
  Result<void> create_passes(const Tables& tables);
  bool is_lit(const Room& room) const { return room.light_m() != nullptr && !setup_->backdrop; }
  void shade(GLuint people_maps);

  const CompositorSetup* setup_;
  const FrameParams* frame_;
  std::vector<GpuMesh> meshes_;  // in the order of FrameParams::draws
  VirtualPass virtual_;
  EdgePass edges_;
  ShadowPass shadow_;
  std::optional<PeopleShadowPass> people_shadow_;
  LightPass light_;
  UsedLook used_look_;
  std::optional<LookPass> look_;
  bool shaded_ = false;  ///< since they were last blurred
  std::optional<MotionPass> motion_;
  const Texture *mixed_color_ = nullptr, *mixed_w_ = nullptr;  ///< of this frame
  Rect mixed_rect_;                                            ///< pixels that they may touch
  std::uint32_t frames_ = 0;
  bool has_shadows_ = false;
};

}  // namespace mixrig::render::gles
