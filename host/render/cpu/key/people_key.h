// SPDX-License-Identifier: Apache-2.0
// Pass key over time: the previous matte is blended in.
#pragma once

#include "hal/base/parallel.h"
#include "host/render/cpu/key/key.h"
#include "host/render/frame/frame_order.h"

namespace mixrig::render::cpu {

/// Used by one compositor; not thread-safe. Allocates when it is made only.
class PeopleKey {
 public:
  /// Borrows `tables`.
  PeopleKey(const CompositorSetup& setup, const Tables& tables, int threads);
  /// Takes a frame before its plate is drawn. `plate` holds the previous plate; if mattes are
  /// blended it is kept, and swapped for another image of its size.
  void follow(const FrameInput& input, Image<Rgbx16>& plate);
  /// Writes the matte; `view_w` becomes people's depth, as by key(). Sets `input.before`.
  void key(Crew& crew, KeyInput input, Image<float>& view_w, Image<std::uint8_t>& matte);
  const KeyScratch& scratch() const { return scratch_; }

 private:
  const Tables& tables_;
  KeyScratch scratch_;
  bool joins_;
  FrameOrder order_;
  Image<Rgbx16> plate_before_;                    ///< of the previous frame
  Image<std::uint8_t> matte_now_, matte_before_;  ///< of this and the previous frame
  bool has_now_ = false, has_before_ = false;
};

}  // namespace mixrig::render::cpu
