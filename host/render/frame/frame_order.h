// SPDX-License-Identifier: Apache-2.0
// Whether what one frame showed says something of the next. Shared by both back ends.
#pragma once

#include "host/render/contract/compositor.h"

namespace mixrig::render {

/// Whether the key of this setup blends in the previous matte: it needs a background that stands
/// still.
inline bool joins_mattes(const CompositorSetup& setup) {
  return setup.key.steady && !setup.background.depth_m.empty() && setup.background_models.empty() &&
         !setup.lens_moves;
}

/// Compares times and poses of successive frames. Not thread-safe.
class FrameOrder {
 public:
  /// Longest time between two frames whose mattes are blended.
  static constexpr double kPause_s = 0.25;
  /// Takes a frame; returns false for the last frame once more.
  bool see(const FrameInput& input) {
    const double interval_s = input.time_s - time_s_;
    const bool same_pose = any_ && input.world_from_target == pose_;
    if (same_pose && interval_s == 0) return false;
    follows_ = same_pose && interval_s > 0 && interval_s <= kPause_s;
    any_ = true, time_s_ = input.time_s, pose_ = input.world_from_target;
    return true;
  }
  /// Whether the last frame is of the same pose and soon after the one before.
  bool follows() const { return follows_; }

 private:
  bool any_ = false, follows_ = false;
  double time_s_ = 0;
  geometry::Pose pose_;
};

}  // namespace mixrig::render
