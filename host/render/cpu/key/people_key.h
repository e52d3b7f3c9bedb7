// SPDX-License-Identifier: Apache-2.0
// Pass key from frame to frame: people's depth is brought to the time of the plate, and the matte
// of the frame before joins that of this one.
#pragma once

#include <optional>

#include "hal/base/parallel.h"
#include "host/render/cpu/key/key.h"
#include "host/render/frame/people_motion.h"

namespace mixrig::render::cpu {

/// Memory of one compositor; not thread-safe. Allocates in the first frames only.
class PeopleKey {
 public:
  /// Borrows both. `tables` still hold plate_px now.
  PeopleKey(const CompositorSetup& setup, const Tables& tables, int threads);
  /// Takes how people moved since the frame before. `plate`: of that frame; it is kept where the
  /// mattes join, and another image of its size is given for it. Before the plate is drawn.
  void follow(Crew& crew, const FrameInput& input, Image<Rgbx16>& plate);
  /// Writes the matte; `view_w` becomes people's depth, as of key(). `input.before` is set here.
  /// `depth_delay_s`: of the frame.
  void key(Crew& crew, double depth_delay_s, KeyInput input, Image<float>& view_w,
           Image<std::uint8_t>& matte);
  const KeyScratch& scratch() const { return scratch_; }

 private:
  std::optional<FrameBefore> before() const;

  const CompositorSetup& setup_;
  const Tables& tables_;
  KeyScratch scratch_;
  std::optional<PeopleMotion> motion_;            ///< of a camera that stands still
  Image<glm::vec2> depth_shift_px_;               ///< of its cells
  Image<float> unmoved_w_;                        ///< once people's depth has moved
  Image<Rgbx16> plate_before_;                    ///< of the frame before, where its matte joins
  Image<std::uint8_t> matte_now_, matte_before_;  ///< the same
  bool has_now_ = false, has_before_ = false;
};

}  // namespace mixrig::render::cpu
