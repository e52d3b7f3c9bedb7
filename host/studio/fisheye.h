// SPDX-License-Identifier: Apache-2.0
// The fisheye picture: one ray a pixel, lamps that saturate.
#pragma once

#include "host/studio/picture.h"

namespace mixrig::studio {

/// Renders the fisheye camera's picture, sRGB, black outside its circle. `exposure` is linear.
void draw_fisheye(const FisheyeInfo& camera, const geometry::Pose& world_from_fisheye,
                  const TraceScene& room, const Shadowers& shadowers, const Materials& materials,
                  const LampSet& lamps, const Light& light, Crew& crew, Image<Rgb8>& picture);

}  // namespace mixrig::studio
