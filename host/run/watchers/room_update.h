// SPDX-License-Identifier: Apache-2.0
// Learns changes of a room into its background, from frames that see them.
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

/// Draws the frames from the place of each picture of the background and takes, for each pixel
/// where the watch has an open change, the median of what they saw: surfaces that appeared, and
/// what lies behind those that are gone; without any sight behind, the pixel becomes unknown. For
/// shadows, colours of unchanged surfaces between them are taken too. Colours are converted to the
/// model's light. `world_from_view`: as for KeptBackground::models(). Runs in the calling thread
/// for about a second. Errors: kData with less than 3 frames; those of composing.
Result<void> learn_changes(const model::RoomWatch& watch, std::span<const SeenFrame> frames,
                           const geometry::Pose& world_from_view, KeptBackground& background);

}  // namespace mixrig::session
