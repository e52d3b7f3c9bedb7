// SPDX-License-Identifier: Apache-2.0
// Records live devices into a take.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "hal/base/result.h"
#include "host/capture/live/session/live_session.h"
#include "host/capture/take/take.h"

namespace mixrig::live {

struct RecordOptions {
  std::filesystem::path out;
  Duration duration = std::chrono::seconds(10);
  take::StreamFormat format = take::StreamFormat::kMatroska;
  std::uint64_t least_free_bytes = 512ULL << 20;  ///< recording ends, complete, before less is free
  /// Free bytes where `out` lies; std::filesystem::space by default.
  std::function<std::uint64_t(const std::filesystem::path&)> free_bytes;
  std::function<void(double share)> progress;
};

struct RecordReport {
  int frames = 0;
  std::uint64_t left_out = 0;  ///< sets without a depth frame, or with one that could not be read
  std::string ended;           ///< "duration", "stopped", "disk almost full", "end of the cameras"
  SessionReport session;
};

/// Starts the session, records until the time is over or `stop` is set, stops it, and finishes the
/// take: colour and depth as docs/reference/take.md says, further cameras as pictures in folders of
/// their names, ticks.csv with tick and times of every frame, poses of the head in pan_tilt.csv,
/// what the encoders of the lens say at mid-exposure in lens.csv. Errors: kUsage for a rig without
/// a camera or depth camera, kDevice when no frame ever came, kData for pictures of another size
/// than the calibration, kIo; those of the devices. After an error in mid-take, a full disk among
/// them, the take holds what came before it.
Result<RecordReport> record(LiveSession& session, const RigConfig& config, const Devices& devices,
                            const RecordOptions& options, const std::atomic<bool>& stop,
                            Clock& clock);

}  // namespace mixrig::live
