// SPDX-License-Identifier: Apache-2.0
// The fisheye picture: one ray per pixel; lamps saturate.
#pragma once

#include "host/studio/sensors/picture.h"

namespace mixrig::studio {

/// Renders the fisheye camera's picture, sRGB, black outside the image circle.
void draw_fisheye(const FisheyeOptics& camera, const geometry::Pose& world_from_fisheye,
                  const TraceScene& room, const ShadowCasters& casters, const Materials& materials,
                  const LampSet& lamps, const Light& light, Crew& crew, Image<Rgb8>& picture);

}  // namespace mixrig::studio
