// SPDX-License-Identifier: Apache-2.0
// Learns what changed in a room into its background, from frames that see it.
#pragma once

#include <span>

#include "host/capture/capture/capture.h"
#include "host/room/changes/room_watch.h"
#include "host/run/session/kept_background.h"

namespace mixrig::session {

struct SeenFrame {
  capture::CapturePtr capture;
  geometry::Pose world_from_target;
};

/// Draws the frames from the place of each picture of the background and takes, pixel by pixel, the
/// median of what they saw where the watch has an open change: surfaces that appeared, and what is
/// seen behind those that are gone; what nothing was seen behind is unknown. Colours of surfaces
/// between them that are where they were are taken too, for shadows. Colours are those of the
/// model's light. `world_from_view`: as KeptBackground::models. Works on one thread for a second or
/// so. Errors: kData with fewer than 3 frames; those of composing.
Result<void> learn_changes(const model::RoomWatch& watch, std::span<const SeenFrame> frames,
                           const geometry::Pose& world_from_view, KeptBackground& background);

}  // namespace mixrig::session
