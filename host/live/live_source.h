// SPDX-License-Identifier: Apache-2.0
// The devices of a rig as a source of captures: each read gives the next one.
#pragma once

#include <atomic>
#include <memory>

#include "hal/base/clock.h"
#include "host/capture/capture_source.h"
#include "host/live/devices.h"
#include "host/live/rig_config.h"

namespace mixrig::live {

/// Takes ownership of open devices. They start with the first read() and stop with the source.
/// read() gives the next frame set that has colour and depth; false after `stop` was set or when
/// all cameras have ended. Errors of read(): kDevice when a device does not start, or when no set
/// with colour and depth came for five seconds: it names the camera that is lost. `stop` and
/// `clock` must outlive the source. Errors: kUsage for a rig without a camera or a depth camera.
Result<std::unique_ptr<capture::CaptureSource>> make_live_source(RigConfig config, Devices devices,
                                                                 const std::atomic<bool>& stop,
                                                                 Clock& clock);

}  // namespace mixrig::live
