// SPDX-License-Identifier: Apache-2.0
// Lamps that a scene has found when it is opened.
#pragma once

#include "hal/base/result.h"
#include "host/scene/scene.h"

namespace mixrig::session {

/// Where light.lamps = "find", sets the scene's lamps by its scanned room, as `mixrig lights
/// --model` does: their intensity and the ambient light where its planes tell them. A room without
/// a lamp is a warning. Takes seconds. Errors: kFormat without a scanned room; those of reading it.
Result<void> find_scene_lamps(scene::Scene& scene);

}  // namespace mixrig::session
