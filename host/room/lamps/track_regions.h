// SPDX-License-Identifier: Apache-2.0
// Bright regions of successive pictures that are the same thing.
#pragma once

#include <span>
#include <vector>

#include "host/room/lamps/lamp_tracks.h"

namespace mixrig::lights {

/// Each region of a view goes on with the track whose last direction is nearest, both being each
/// other's best, within what the camera's movement explains for a thing 1 m away, and a size
/// within a factor of four.
std::vector<std::vector<Sighting>> track_regions(std::span<const LampView> views);

}  // namespace mixrig::lights
