// SPDX-License-Identifier: Apache-2.0
// The devices of a rig as a source of frames: whatever comes next is the next frame.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>

#include "host/app/source.h"
#include "host/rig/devices.h"
#include "host/rig/live_session.h"

namespace mixrig::app {

/// take: and studio: recordings as devices. Errors: those of open_source.
Result<rig::Playable> open_playable(const std::string& uri);

/// Opens every device of rig.toml. They start with the first read() and stop with the source.
/// read() gives the next moment that has colour and depth, whatever its number says; false after
/// `stop` was set or when all cameras have ended. Errors of read(): kDevice when a device does not
/// start, or when nothing came for five seconds.
/// Errors: those of rig.toml and of the devices; kUsage without a camera or a depth camera.
Result<std::unique_ptr<FrameSource>> open_live_source(const std::filesystem::path& rig_toml,
                                                      const std::atomic<bool>& stop, Clock& clock);
/// The same on devices that are open.
Result<std::unique_ptr<FrameSource>> make_live_source(rig::RigConfig config, rig::Devices devices,
                                                      const std::atomic<bool>& stop, Clock& clock);

}  // namespace mixrig::app
