// SPDX-License-Identifier: Apache-2.0
// The devices of a rig as a source of captures: each read gives the next one.
#pragma once

#include <atomic>
#include <memory>

#include "hal/base/clock.h"
#include "host/capture/capture/capture_source.h"
#include "host/capture/live/rig/camera_settings.h"
#include "host/capture/live/rig/devices.h"
#include "host/capture/live/rig/rig_config.h"
#include "host/capture/live/session/running_rig.h"

namespace mixrig::live {

/// What read() does when a camera stops delivering.
enum class WhenLost {
  kEnd,   ///< an error after five seconds without colour and depth: it names the camera
  kGoOn,  ///< after the first set with both: captures without depth are given, and colour is waited
          ///< for until it is back; an error only where its camera has failed for good or has ended
};

/// Takes ownership of open devices. They start with the first read() and stop with the source.
/// read() gives the next frame set that has colour and depth (kGoOn: or colour alone, once both
/// have come); false after `stop` was set or when all cameras have ended. Errors of read(): kDevice
/// when a device does not start, or when no set came for five seconds, as `when_lost` says. `stop`
/// and `clock` must outlive the source. `settings` (may be null) follows the [[camera]]s, and
/// `running` (may be null) the rig, while they run. Errors: kUsage for a rig without a camera or a
/// depth camera.
Result<std::unique_ptr<capture::CaptureSource>> make_live_source(
    RigConfig config, Devices devices, const std::atomic<bool>& stop, Clock& clock,
    WhenLost when_lost = WhenLost::kEnd, std::shared_ptr<CameraSettings> settings = nullptr,
    std::shared_ptr<RunningRig> running = nullptr);

}  // namespace mixrig::live
