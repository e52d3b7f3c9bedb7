// SPDX-License-Identifier: Apache-2.0
// Lamps that a scanned room's own picture shows.
#pragma once

#include "host/room/lamps/lamp_tracks.h"

namespace mixrig::lights {

/// The saturated regions of the panorama's colour, as one view from the origin of the scan. Where
/// the panorama has light (color.exr), of its light at a lower exposure, in which what is as bright
/// as half of the brightest 2e-4 sr saturates, a quarter where that is above 1.5 times white: white
/// things that the plates show saturated are none.
LampView view_of_room(const RoomSurfaces& room, const RegionOptions& options = {});

}  // namespace mixrig::lights
