// SPDX-License-Identifier: Apache-2.0
// The look that a compositor gives to virtual things. Shared by both back ends.
#pragma once

#include <cstdint>
#include <optional>

#include "host/render/frame/picture_look.h"

namespace mixrig::render {

/// Uses the look that frames bring, else that of the first plate. For one compositor; not
/// thread-safe.
class UsedLook {
 public:
  explicit UsedLook(const CompositorSetup& setup);
  /// The look to use from this frame on, restricted to what the setup wants; null: unchanged.
  const PictureLook* take(const FrameInput& input);
  /// Weight of each of the four pixels beside one in the filter that makes edges of virtual
  /// coverage as wide as those of the plate, by the first frame's look. 0 where the setup wants all
  /// of the objects blurred. Call it after take().
  float edge_tap() const { return edge_tap_; }

 private:
  LookSettings settings_;
  float edge_tap_ = 0;
  std::optional<LookMeter> meter_;  ///< until the first frame
  std::optional<PictureLook> used_;
};

}  // namespace mixrig::render
