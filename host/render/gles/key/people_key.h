// SPDX-License-Identifier: Apache-2.0
// Pass key from frame to frame: people's depth is brought to the time of the plate, and the matte
// of the frame before joins that of this one.
#pragma once

#include <memory>

#include "hal/base/parallel.h"
#include "host/render/frame/people_motion.h"
#include "host/render/gles/key/key_pass.h"

namespace mixrig::render::gles {

/// Memory of one compositor.
class PeopleKey {
 public:
  /// Borrows `setup`, and `tables` where the key follows people; they hold all images now. Errors:
  /// as KeyPass.
  static Result<PeopleKey> create(const CompositorSetup& setup, const Tables& tables,
                                  LearnedColor learned, const KeyPassParams& params);
  /// Another view of the same size.
  void set_view(const Tables& tables) { pass_.set_view(tables); }
  /// Takes how people moved since the frame before, whose `plate`, linear light in the view, is
  /// still there.
  void follow(const FrameInput& input, const Texture& plate);
  /// Draws the matte and people's depth. Shift and motion of `input` are set here;
  /// `depth_delay_s`: of the frame.
  void draw(const KeyPassParams& params, double depth_delay_s, KeyInput input);
  const KeyPass& pass() const { return pass_; }
  /// It looks at plates on the host.
  bool follows() const { return followed_ && (key_->motion || key_->steady); }

 private:
  /// Of a camera that stands still.
  struct Followed {
    explicit Followed(const Tables& tables) : motion(tables) {}
    Crew crew;
    PeopleMotion motion;
    Image<glm::vec2> depth_shift_px;  ///< of its cells
    Texture shift_px, motion_px;
  };
  explicit PeopleKey(const KeyParams& key) : key_(&key) {}

  const KeyParams* key_;
  KeyPass pass_;
  std::unique_ptr<Followed> followed_;
  bool has_now_ = false, has_before_ = false;  ///< a matte of this frame, and of that before
};

}  // namespace mixrig::render::gles
