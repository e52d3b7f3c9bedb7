// SPDX-License-Identifier: Apache-2.0
#include "host/render/frame/used_look.h"

#include <algorithm>

namespace mixrig::render {
namespace {

/// Largest weight of a pixel beside one: wider edges than that need pixels farther away.
constexpr float kMostEdgeTap = 0.15F;

}  // namespace

UsedLook::UsedLook(const CompositorSetup& setup) : settings_(setup.look) {
  if (!setup.objects.empty()) meter_.emplace(setup);
}

const PictureLook* UsedLook::take(const FrameInput& input) {
  std::optional<PictureLook> look;
  if (input.look != nullptr)
    look = *input.look;
  else if (meter_)
    look = measured_first(*meter_, input.plate);
  if (meter_ && !settings_.blur)
    edge_tap_ = std::min(0.5F * look->blur_px * look->blur_px, kMostEdgeTap);
  meter_.reset();
  if (!look || !settings_.measures()) return nullptr;
  const PictureLook wanted = wanted_of(*look, settings_);
  if (used_ == wanted) return nullptr;
  used_ = wanted;
  return &*used_;
}

}  // namespace mixrig::render
