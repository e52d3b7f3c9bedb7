// SPDX-License-Identifier: Apache-2.0
// Finds the lamps of a scene when it is opened.
#pragma once

#include "hal/base/result.h"
#include "host/scene/scene.h"

namespace mixrig::session {

/// If light.lamps = "find", sets the scene's lamps by its scanned room, as `mixrig lights --model`
/// does, with intensity and ambient light where the room's planes show them. Warns if the room has
/// no lamp. Takes seconds. Errors: kFormat without a scanned room; those of reading it.
Result<void> find_scene_lamps(scene::Scene& scene);

}  // namespace mixrig::session
