// SPDX-License-Identifier: Apache-2.0
// Lets a sweep use the rig of a run while the run continues.
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

/// Facts about a rig's devices that a sweep needs.
struct SweepFacts {
  Size color_px, depth_px;
  device::PanTiltInfo unit;
  take::TakeInfo take;
};
/// Collects these facts. Precondition: the rig has a camera, a depth camera and a head. Errors:
/// those of take_info().
Result<SweepFacts> sweep_facts(const RigConfig& config, const Devices& devices);

/// A SweepRig on a running rig. The run's source passes its decoded captures between follow() and
/// end(), while listening is on; the thread of its session moves the head. A run that is slower
/// than the cameras passes fewer. The source calls follow(), give() and end(); any one thread calls
/// the rest.
class RunningRig final : public SweepRig {
 public:
  /// Begins to follow a rig; does nothing if it has no head or no depth camera. The arguments must
  /// live until end().
  void follow(const RigConfig& config, const Devices& devices, LiveSession& session);
  void end();
  void give(const LiveSet& set, const capture::Capture& capture);

  /// Whether a rig with a head runs.
  bool runs() const;
  /// Returns the facts. Errors: kUsage if no rig runs; those of sweep_facts().
  Result<SweepFacts> facts() const;
  /// Starts or stops copying captures for next().
  void listen(bool on) { listens_ = on; }

  device::PanTiltAngles step() const override;
  Result<void> move_to(device::PanTiltAngles target) override;
  Result<void> halt() override;
  /// Returns the newest capture. Errors: kDevice if the rig no longer runs.
  Result<bool> next(Duration timeout, capture::Capture& frame, HostTime& exposed_from) override;

 private:
  std::atomic<bool> listens_ = false;
  mutable std::mutex rig_mutex_;  ///< guards the members below; held during a command to the head
  const RigConfig* config_ = nullptr;
  const Devices* devices_ = nullptr;
  LiveSession* session_ = nullptr;  ///< null: no rig runs
  std::optional<ExposureBegin> begin_;
  std::mutex frame_mutex_;  ///< guards the members below
  std::condition_variable came_;
  bool there_ = false, ended_ = false;
  capture::Capture newest_;
  HostTime exposed_from_{};
};

}  // namespace mixrig::live
