// SPDX-License-Identifier: Apache-2.0
// Sends the pose and lens of each composited picture to other programs.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "extras/broadcast/packets/opentrackio.h"
#include "hal/base/clock_sync.h"
#include "host/output/datagrams/datagram_sender.h"
#include "host/output/sink/composite_sink.h"
#include "host/scene/scene.h"

namespace mixrig::session {

/// Counts of what was sent to one receiver.
struct PoseOutReport {
  std::string protocol, udp;
  std::uint64_t frames = 0, lost_frames = 0;  ///< with a pose, and without
  std::uint64_t datagrams = 0, dropped = 0;   ///< accepted, and not accepted, by the system
};
nlohmann::json to_json(const std::vector<PoseOutReport>& reports);

/// Sends the pose and lens at the plate's mid-exposure; the lens is the composite's, whose picture
/// has no distortion. A frame without a pose is a sample without transforms (OpenTrackIO), or not
/// sent (FreeD).
class PoseSink final : public output::CompositeSink {
 public:
  /// `epoch`: the system time. `begin`: host time that the first frame of a recording
  /// gets. `reports` is complete after finish(), and must outlive the sink. `is_locked`: whether
  /// the system clock is synchronized; called every two seconds. Errors: kUsage, kDevice.
  static Result<std::unique_ptr<PoseSink>> create(const std::vector<scene::PoseOut>& outs,
                                                  EpochReader epoch, std::optional<HostTime> begin,
                                                  std::vector<PoseOutReport>& reports,
                                                  bool (*is_locked)() = host_clock_is_synchronized);
  std::string_view name() const override { return "poses"; }
  render::OutputMask wanted(int) const override { return render::kMatte; }
  Result<void> write(const output::CompositePtr& composite) override;
  Result<void> finish() override;

 private:
  struct Receiver {
    scene::PoseOut out;
    stream::DatagramSender sender;
    stream::Uuid source{};
    std::uint64_t samples = 0;
    std::int64_t sensor_sent_ns = 0;
    bool locked = false;  ///< the clock was synchronized when the sensor was last sent
  };
  PoseSink(EpochReader epoch, std::optional<HostTime> begin, std::vector<PoseOutReport>& reports,
           bool (*is_locked)())
      : epoch_(std::move(epoch)), begin_(begin), reports_(reports), is_locked_(is_locked) {}
  void send_freed(const output::Composite& composite, Receiver& to);
  void send_opentrack(const output::Composite& composite, Receiver& to);

  HeldEpoch epoch_;
  std::int64_t epoch_ns_ = 0;      ///< Unix time at time 0 of the captures
  Duration shift_{};               ///< host time minus time of the captures
  std::optional<HostTime> begin_;  ///< host time for a recording's first frame; empty after it
  std::vector<Receiver> receivers_;
  std::vector<PoseOutReport>& reports_;
  bool (*is_locked_)();
  const Duration tai_minus_utc_ = tai_minus_utc();
};

}  // namespace mixrig::session
