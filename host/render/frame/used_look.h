// SPDX-License-Identifier: Apache-2.0
// The look that virtual things have in a compositor. Shared by both back ends.
#pragma once

#include <cstdint>
#include <optional>

#include "host/render/frame/picture_look.h"

namespace mixrig::render {

/// As the frames say, else as the first plate shows. Memory of one compositor; not thread-safe.
class UsedLook {
 public:
  explicit UsedLook(const CompositorSetup& setup);
  /// What is to be used from this frame on, of what the setup wants; null where it stays as it is.
  const PictureLook* take(const FrameInput& input);
  bool measures() const { return measures_; }

 private:
  LookSettings settings_;
  bool measures_;
  std::optional<LookMeter> meter_;  ///< until the first frame
  std::optional<PictureLook> used_;
};

}  // namespace mixrig::render
