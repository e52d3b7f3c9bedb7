// SPDX-License-Identifier: Apache-2.0
// Joins bright regions of successive pictures that show the same thing.
#pragma once

#include <span>
#include <vector>

#include "host/room/lamps/lamp_tracks.h"

namespace mixrig::lights {

/// Joins each region of a view to the track with the nearest last direction, if each is the other's
/// best, within what the camera's movement explains for a thing 1 m away, and within a factor of
/// four in size.
std::vector<std::vector<Sighting>> track_regions(std::span<const LampView> views);

}  // namespace mixrig::lights
