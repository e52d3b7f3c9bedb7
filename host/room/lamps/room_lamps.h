// SPDX-License-Identifier: Apache-2.0
// Lamps in a scanned room's own picture.
#pragma once

#include "host/room/lamps/lamp_tracks.h"

namespace mixrig::lights {

/// Finds the saturated regions of the panorama's colour, as one view from the origin of the scan.
/// If the panorama has light (color.exr), that is used at a lower exposure: what is half as bright
/// as the brightest 2e-4 sr saturates, or a quarter as bright if half is above 1.5 times white.
/// White things that are saturated in the plates are then not found.
LampView view_of_room(const RoomSurfaces& room, const RegionOptions& options = {});

}  // namespace mixrig::lights
