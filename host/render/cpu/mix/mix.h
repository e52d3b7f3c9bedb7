// SPDX-License-Identifier: Apache-2.0
// Pass mix: colour, mixed depth, segmented depth and matte of the composite.
#pragma once

#include "hal/base/parallel.h"
#include "host/render/contract/tone_curve.h"
#include "host/render/cpu/key/key.h"
#include "host/render/cpu/light/light.h"
#include "host/render/cpu/mix/look.h"
#include "host/render/cpu/virtual/virtual.h"

namespace mixrig::render::cpu {

/// Inputs of the pass; a pointer is null where the scene has none.
struct MixInput {
  const BackgroundView& background;
  ImageView<const float> room_m;  ///< depth of the background, 0 unknown; may be empty
  const Image<Rgbx16>& plate;
  const Image<float>& view_w;  ///< visible real surface, 0 unknown
  const VirtualLayer* objects;
  const LightLayer* light;
  ToneCurve tone{};  ///< of the plate over the learned background; virtual objects follow it
  const KeyScratch* key = nullptr;  ///< colours of the room beside people
  const GrainOf* grain = nullptr;   ///< of virtual things
  bool open_walls = false;
  bool replaced = false;           ///< the real background is not shown...
  ImageView<const Rgb8> backdrop;  ///< ...but this picture, where there is one
};

/// Writes the wanted ones of colour, mixed depth, segmented depth, layer and alpha; reads the
/// matte. Colour is drawn over the plate in sRGB, which it holds before unless the real background
/// is replaced (draw_plate).
void mix(Crew& crew, const MixInput& input, FrameOutput& output);

}  // namespace mixrig::render::cpu
