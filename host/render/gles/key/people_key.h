// SPDX-License-Identifier: Apache-2.0
// Pass key over time: people's depth is moved to the time of the plate, and the previous matte is
// blended in.
#pragma once

#include <memory>

#include "hal/base/parallel.h"
#include "host/render/frame/people_motion.h"
#include "host/render/gles/key/key_pass.h"

namespace mixrig::render::gles {

/// Used by one compositor.
class PeopleKey {
 public:
  /// Borrows `setup`, and, if the key follows people, `tables`, which must still hold all images.
  /// Errors: those of KeyPass.
  static Result<PeopleKey> create(const CompositorSetup& setup, const Tables& tables,
                                  LearnedColor learned, const KeyPassParams& params);
  /// Sets another view of the same size.
  void set_view(const Tables& tables) { pass_.set_view(tables); }
  /// Estimates how people moved since the previous frame. `plate` must still hold the previous
  /// frame's plate, linear light in the view.
  void follow(const FrameInput& input, const Texture& plate);
  /// Draws the matte and people's depth, and sets shift and motion in `input`. `depth_delay_s`:
  /// delay of the frame's depth.
  void draw(const KeyPassParams& params, double depth_delay_s, KeyInput input);
  const KeyPass& pass() const { return pass_; }
  /// Whether it needs plates on the host.
  bool follows() const { return followed_ && (key_->motion || key_->steady); }

 private:
  /// State for a camera that stands still.
  struct Followed {
    explicit Followed(const Tables& tables) : motion(tables) {}
    Crew crew;
    PeopleMotion motion;
    Image<glm::vec2> depth_shift_px;  ///< one for each cell of `motion`
    Texture shift_px, motion_px;
  };
  explicit PeopleKey(const KeyParams& key) : key_(&key) {}

  const KeyParams* key_;
  KeyPass pass_;
  std::unique_ptr<Followed> followed_;
  /// A matte of this frame, and of the previous frame, exists.
  bool has_now_ = false, has_before_ = false;
};

}  // namespace mixrig::render::gles
