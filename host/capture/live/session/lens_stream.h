// SPDX-License-Identifier: Apache-2.0
// Encoder values of a rig's lens, received from the network.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/capture/capture/lens_track.h"
#include "host/capture/live/rig/devices.h"
#include "host/capture/live/rig/rig_config.h"

namespace mixrig::live {

/// Listens in its own thread from open() on, and keeps the last values. The destructor warns of
/// packets that could not be read. Nothing allocates in between.
class LensStream {
 public:
  /// Opens the stream; null for a rig without [lens]. `devices`: those of the rig. `clock` must
  /// outlive it. Errors: those of LensProtocol::open().
  static Result<std::unique_ptr<LensStream>> open(const RigConfig& config, const Devices& devices,
                                                  const Clock& clock);
  LensStream(std::unique_ptr<LensReceiver> receiver, Duration delay, const Clock& clock);
  ~LensStream();
  LensStream(const LensStream&) = delete;
  LensStream& operator=(const LensStream&) = delete;

  /// Returns capture::lens_at() of the received values; a packet's time is its arrival minus the
  /// delay. Any thread.
  std::optional<geometry::LensEncoders> at(HostTime mid_exposure) const;

 private:
  Result<void> listen();
  void keep(const geometry::LensEncoders& encoders);

  static constexpr std::size_t kKept = 128;  ///< half a second at 240 Hz
  const std::unique_ptr<LensReceiver> receiver_;
  const Duration delay_;
  const Clock& clock_;
  mutable std::mutex mutex_;
  std::array<capture::LensSample, kKept> samples_;  ///< the first count_ are used, ordered by time
  std::size_t count_ = 0;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace mixrig::live
