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

/// Takes that follow each other in the folder RecordOptions::out (take/segments/segments.h). Without
/// `length` and `bytes` a recording is one take.
struct Segments {
  Duration length{};             ///< of a take; 0: any
  std::uint64_t bytes = 0;       ///< of a take; 0: any
  std::uint64_t most_bytes = 0;  ///< of the whole takes in the folder and the running one; 0: any
  bool drop_oldest = false;  ///< delete the oldest take where space is short; else recording ends
  bool any() const { return length > Duration::zero() || bytes > 0; }
};

struct RecordOptions {
  std::filesystem::path out;
  Duration duration = std::chrono::seconds(10);  ///< 0: until `stop`
  take::StreamFormat format = take::StreamFormat::kMatroska;
  /// Recording ends, complete, before fewer bytes are free.
  std::uint64_t least_free_bytes = 512ULL << 20;
  /// Returns the free bytes of the disk of `out`; empty: std::filesystem::space.
  std::function<std::uint64_t(const std::filesystem::path&)> free_bytes;
  std::function<void(double share)> progress;  ///< share 0 where `duration` is 0
  Segments segments;
};

struct RecordReport {
  int frames = 0;
  std::uint64_t left_out = 0;  ///< sets without a depth frame, or with one that could not be read
  std::string ended;  ///< "duration", "stopped", "disk almost full", "end of the cameras", "the
                      ///< folder has its share of the disk"
  int takes = 0, deleted = 0;  ///< segments written, and deleted to make space
  SessionReport session;
};

/// Starts the session, records until the time is over or `stop` is set, stops it, and finishes the
/// take: colour and depth as docs/reference/take.md says, further cameras as pictures in folders of
/// their names, ticks.csv with tick and times of every frame, poses of the head in pan_tilt.csv,
/// encoder values of the lens at mid-exposure in lens.csv. Errors: kUsage for a rig without a
/// camera or depth camera, kDevice when no frame ever came, kData for pictures of another size than
/// the calibration, kIo, also for a disk that is almost full at the start; those of the devices.
/// After an error during the take, such as a full disk, the take holds all earlier frames.
Result<RecordReport> record(LiveSession& session, const RigConfig& config, const Devices& devices,
                            const RecordOptions& options, const std::atomic<bool>& stop,
                            Clock& clock);

}  // namespace mixrig::live
