// SPDX-License-Identifier: Apache-2.0
// Pass mix: writes colour, mixed depth, segmented depth and layer of the composite.
#pragma once

#include "hal/base/parallel.h"
#include "host/render/contract/tone_curve.h"
#include "host/render/cpu/key/key.h"
#include "host/render/cpu/light/light.h"
#include "host/render/cpu/mix/look.h"
#include "host/render/cpu/virtual/virtual.h"

namespace mixrig::render::cpu {

/// Inputs of the pass; a pointer is null if the scene has none.
struct MixInput {
  const BackgroundView& background;
  ImageView<const float> room_m;  ///< depth of the background, 0 unknown; may be empty
  const Image<Rgbx16>& plate;
  const Image<float>& view_w;  ///< inverse depth of the visible real surface, 0 unknown
  const VirtualLayer* objects;
  const LightLayer* light;
  ToneCurve tone{};  ///< plate relative to the learned background; applied to virtual objects too
  const KeyScratch* key = nullptr;  ///< for colours of the background beside people
  const GrainOf* grain = nullptr;   ///< of virtual things
  bool open_walls = false;
  bool replaced = false;           ///< the real background is not shown
  ImageView<const Rgb8> backdrop;  ///< shown instead of the real background; may be empty
};

/// Writes those of colour, mixed depth, segmented depth, layer and alpha that are wanted; reads the
/// matte. The colour must already hold the plate in sRGB (draw_plate()), unless the real background
/// is replaced.
void mix(Crew& crew, const MixInput& input, FrameOutput& output);

}  // namespace mixrig::render::cpu
