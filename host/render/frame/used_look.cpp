// SPDX-License-Identifier: Apache-2.0
#include "host/render/frame/used_look.h"

namespace mixrig::render {

UsedLook::UsedLook(const CompositorSetup& setup)
    : settings_(setup.look), measures_(setup.look.measures() && !setup.objects.empty()) {
  if (measures_) meter_.emplace(setup);
}

const PictureLook* UsedLook::take(const FrameInput& input) {
  if (!measures_) return nullptr;
  std::optional<PictureLook> look;
  if (input.look != nullptr)
    look = wanted_of(*input.look, settings_);
  else if (meter_)
    look = wanted_of(measured_first(*meter_, input.plate), settings_);
  meter_.reset();
  if (!look || used_ == look) return nullptr;
  used_ = look;
  return &*used_;
}

}  // namespace mixrig::render
