// SPDX-License-Identifier: Apache-2.0
// Pass key over time: the previous matte is blended in.
#pragma once

#include "host/render/frame/frame_order.h"
#include "host/render/gles/key/key_pass.h"
#include "host/render/gles/plate/plate_pass.h"

namespace mixrig::render::gles {

/// Used by one compositor.
class PeopleKey {
 public:
  /// Errors: those of KeyPass.
  static Result<PeopleKey> create(const CompositorSetup& setup, const Tables& tables,
                                  LearnedColor learned, const KeyPassParams& params);
  /// Sets another view of the same size.
  void set_view(const Tables& tables) { pass_.set_view(tables); }
  /// Takes a frame, before its plate is taken; where mattes are blended it keeps the plate before.
  void follow(const FrameInput& input, PlatePass& plate);
  /// Draws the matte and people's depth; sets `input.plate_before`.
  void draw(const KeyPassParams& params, const PlatePass& plate, KeyInput input);
  const KeyPass& pass() const { return pass_; }

 private:
  KeyPass pass_;
  bool joins_ = false;
  FrameOrder order_;
  /// A matte of this frame, and of the previous frame, exists.
  bool has_now_ = false, has_before_ = false;
};

}  // namespace mixrig::render::gles
