// SPDX-License-Identifier: Apache-2.0
// Pass key over time: people's depth is moved to the time of the plate, and the previous matte is
// blended in.
#pragma once

#include <optional>

#include "hal/base/parallel.h"
#include "host/render/cpu/key/key.h"
#include "host/render/frame/people_motion.h"

namespace mixrig::render::cpu {

/// Used by one compositor; not thread-safe. Allocates in the first frames only.
class PeopleKey {
 public:
  /// Borrows `setup` and `tables`. `tables` must still hold plate_px.
  PeopleKey(const CompositorSetup& setup, const Tables& tables, int threads);
  /// Estimates how people moved since the previous frame; call it before the plate is drawn.
  /// `plate` holds the previous plate; if mattes are blended it is kept, and swapped for another
  /// image of its size.
  void follow(Crew& crew, const FrameInput& input, Image<Rgbx16>& plate);
  /// Writes the matte; `view_w` becomes people's depth, as by key(). Sets `input.before`.
  /// `depth_delay_s`: delay of the frame's depth.
  void key(Crew& crew, double depth_delay_s, KeyInput input, Image<float>& view_w,
           Image<std::uint8_t>& matte);
  const KeyScratch& scratch() const { return scratch_; }

 private:
  std::optional<FrameBefore> before() const;

  const CompositorSetup& setup_;
  const Tables& tables_;
  KeyScratch scratch_;
  std::optional<PeopleMotion> motion_;  ///< for a camera that stands still
  Image<glm::vec2> depth_shift_px_;     ///< one for each cell of motion_
  Image<float> unmoved_w_;              ///< used when people's depth moves
  Image<Rgbx16> plate_before_;          ///< of the previous frame, if its matte is blended in
  Image<std::uint8_t> matte_now_, matte_before_;  ///< of this and the previous frame
  bool has_now_ = false, has_before_ = false;
};

}  // namespace mixrig::render::cpu
