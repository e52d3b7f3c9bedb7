// SPDX-License-Identifier: Apache-2.0
// Lamps that a scanned room's own picture shows.
#pragma once

#include "host/lights/lamp_tracks.h"

namespace mixrig::lights {

/// The saturated regions of the panorama's colour, as one view from the origin of the scan.
LampView view_of_room(const RoomSurfaces& room, const RegionOptions& options = {});

}  // namespace mixrig::lights
