// SPDX-License-Identifier: Apache-2.0
// The rig of a run that goes on, for a sweep beside it.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>

#include "hal/base/image.h"
#include "host/capture/live/rig/devices.h"
#include "host/capture/live/rig/rig_config.h"
#include "host/capture/live/session/live_session.h"
#include "host/capture/live/sweep/sweep_rig.h"
#include "host/capture/take/take.h"

namespace mixrig::live {

/// What a sweep has to know of a rig's devices.
struct SweepFacts {
  Size color_px, depth_px;
  device::PanTiltInfo unit;
  take::TakeInfo take;
};
/// Precondition: the rig has a camera, a depth camera and a head. Errors: those of take_info().
Result<SweepFacts> sweep_facts(const RigConfig& config, const Devices& devices);

/// The run's source gives its captures between follow() and end(), as they were decoded, while
/// somebody listens; the head is moved by the thread of its session. A run that is slower than the
/// cameras gives fewer. follow(), give() and end() are of the source; the rest is for any one
/// thread.
class RunningRig final : public SweepRig {
 public:
  /// Does nothing where the rig has no head or no depth camera. All of them stay until end().
  void follow(const RigConfig& config, const Devices& devices, LiveSession& session);
  void end();
  void give(const LiveSet& set, const capture::Capture& capture);

  /// Whether a rig with a head runs.
  bool runs() const;
  /// Errors: kUsage where none runs; those of sweep_facts().
  Result<SweepFacts> facts() const;
  /// Captures are copied for next() from now on, or no longer.
  void listen(bool on) { listens_ = on; }

  device::PanTiltAngles step() const override;
  Result<void> move_to(device::PanTiltAngles target) override;
  Result<void> halt() override;
  /// The newest capture. Errors: kDevice where the rig runs no longer.
  Result<bool> next(Duration timeout, capture::Capture& frame, HostTime& exposed_from) override;

 private:
  std::atomic<bool> listens_ = false;
  mutable std::mutex rig_mutex_;  ///< guards what follows; held while the head is told
  const RigConfig* config_ = nullptr;
  const Devices* devices_ = nullptr;
  LiveSession* session_ = nullptr;  ///< null: none runs
  std::optional<ExposureBegin> begin_;
  std::mutex frame_mutex_;  ///< guards what follows
  std::condition_variable came_;
  bool there_ = false, ended_ = false;
  capture::Capture newest_;
  HostTime exposed_from_{};
};

}  // namespace mixrig::live
