// SPDX-License-Identifier: Apache-2.0
// Opens sources of captures by URI.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/capture/capture/capture_source.h"
#include "host/capture/live/rig/camera_settings.h"
#include "host/capture/live/rig/devices.h"
#include "host/capture/live/session/running_rig.h"
#include "host/capture/open/source_kinds.h"
#include "host/scene/scene.h"

namespace mixrig::session {

/// Opens "take:DIR" or a source of `kinds`. Errors: kUsage for another URI; kUnsupported for that
/// of an extra that is left out; those of the take and of the kind.
Result<std::unique_ptr<capture::CaptureSource>> open_source(const std::string& uri,
                                                            const SourceKinds& kinds = {});

/// Options for recordings played as devices.
struct PlayOptions {
  bool preload = false;  ///< read them into memory first
  int frames = 0;        ///< repeat them up to this number of frames; 0: play once
};

/// Opens the recordings that devices of a rig play, take: and the sources of `kinds`, with the
/// options `play`. An entry that cannot be opened holds the error.
std::vector<live::Recording> open_recordings(const live::RigConfig& rig,
                                             const SourceKinds& kinds = {}, PlayOptions play = {});

/// Makes the opener of a rig's devices: devices of the core and of `kinds`, and the rig's
/// recordings.
live::DeviceOpener device_opener(const live::RigConfig& rig, const SourceKinds& kinds, Clock& clock,
                                 PlayOptions play = {});

/// Removes all cameras but the first and, if `keep_fisheye`, the one named "fisheye".
void leave_out_cameras(live::RigConfig& rig, bool keep_fisheye);

/// Returns the part of a rig that a scene uses: the first camera, the fisheye of pose = "tracker",
/// the depth cameras, the head unless the pose comes from elsewhere (with a fixed pose it is
/// watched for motion), and the trigger if it fires one of the cameras. Other cameras are not
/// opened.
live::RigConfig used_by(const scene::Scene& scene, live::RigConfig rig);

/// Returns `rig` without its trigger if that fires none of its cameras.
live::RigConfig without_idle_trigger(live::RigConfig rig);

/// Opens the devices of rig.toml that the scene uses; a lost camera does not end it
/// (live::WhenLost::kGoOn). `lends`: the first camera may lend its buffers
/// (device::StreamRequest::lends). For `settings` and `running` see live::make_live_source().
/// `stop` and `clock` must outlive the source. Errors: those of rig.toml and of the devices; kUsage
/// without a camera or a depth camera, kFormat without the head or the fisheye that the scene's
/// pose needs.
Result<std::unique_ptr<capture::CaptureSource>> open_rig(
    const std::filesystem::path& rig_toml, const scene::Scene& scene, const std::atomic<bool>& stop,
    Clock& clock, const SourceKinds& kinds = {}, PlayOptions play = {},
    std::shared_ptr<live::CameraSettings> settings = nullptr,
    std::shared_ptr<live::RunningRig> running = nullptr, bool lends = false);

}  // namespace mixrig::session
