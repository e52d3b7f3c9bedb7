// SPDX-License-Identifier: Apache-2.0
// Pose sources that an extra (MIXRIG_EXTRAS) brings.
#pragma once

#include <memory>
#include <string>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/capture/capture/pose_source.h"
#include "host/scene/scene.h"

namespace mixrig::session {

struct Session;

struct ExtraPoses {
  scene::PoseSource source = scene::PoseSource::kFreeD;
  /// Opens the source. With a null `clock` it only checks what can be known before the run, and
  /// returns null.
  Result<std::unique_ptr<capture::PoseSource>> (*open)(const Session& session,
                                                       const Clock* clock) = nullptr;
};

/// Error with the text "SCENE.toml: camera.KEY: WHAT".
Error at_camera(const Session& session, const char* key, ErrorCode code, const std::string& what);

}  // namespace mixrig::session
