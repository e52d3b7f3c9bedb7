// SPDX-License-Identifier: Apache-2.0
#include "host/app/live_source.h"

#include <utility>

#include "host/app/rig_json.h"
#include "host/rig/live_frame.h"
#include "host/rig/rig_config.h"

namespace mixrig::app {
namespace {

constexpr Duration kWait = std::chrono::milliseconds(100);
constexpr Duration kPatience = std::chrono::seconds(5);

class LiveSource final : public FrameSource {
 public:
  LiveSource(rig::RigConfig config, rig::Devices devices, take::TakeInfo info,
             const std::atomic<bool>& stop, Clock& clock)
      : config_(std::move(config)),
        devices_(std::move(devices)),
        info_(std::move(info)),
        stop_(stop),
        clock_(clock),
        world_from_target_(rig::world_from_target(config_, devices_)),
        session_(config_, devices_, clock) {
    info_.frames = kEndless;
  }

  const take::TakeInfo& info() const override { return info_; }
  Result<bool> read(int number, take::TakeFrame& frame) override;
  Result<void> read_truth(int, take::TruthFrame&) override {
    return Error{ErrorCode::kData, "live devices know no truth"};
  }
  nlohmann::json report() const override {
    nlohmann::json report = to_json(session_.report());
    report["left_out"] = left_out_;
    return report;
  }

 private:
  rig::RigConfig config_;
  rig::Devices devices_;
  take::TakeInfo info_;
  const std::atomic<bool>& stop_;
  Clock& clock_;
  geometry::Pose world_from_target_;
  rig::LiveSession session_;
  bool started_ = false;
  std::uint64_t left_out_ = 0;  ///< moments without colour or depth
  std::optional<HostTime> first_;
};

Result<bool> LiveSource::read(int number, take::TakeFrame& frame) {
  if (!std::exchange(started_, true)) MIXRIG_TRY(session_.start());
  HostTime patience_ends = clock_.now() + kPatience;
  while (!stop_) {
    // Asked before the queue: what the cameras sent before they ended is still read.
    const bool ended = session_.ended();
    const auto set = session_.next(ended ? Duration(0) : kWait);
    if (!set) {
      if (ended) return false;
      if (clock_.now() < patience_ends) continue;
      return Error{ErrorCode::kDevice,
                   "no frames that could be paired came from the cameras for five seconds: run "
                   "mixrig diag"};
    }
    if (!rig::to_take_frame(*set, devices_, frame)) {
      ++left_out_;
      continue;
    }
    const HostTime at = set->frames.frames[0].mid_exposure;
    if (!first_) first_ = at;
    frame.number = number;
    frame.time_s = seconds(at - *first_);
    frame.world_from_target = world_from_target_;
    return true;
  }
  return false;
}

}  // namespace

Result<rig::Playable> open_playable(const std::string& uri) {
  MIXRIG_ASSIGN(std::shared_ptr<FrameSource> source, open_source(uri));
  return rig::Playable{source->info(),
                       [source](int number, take::TakeFrame& frame) -> Result<void> {
                         MIXRIG_ASSIGN(const bool there, source->read(number, frame));
                         if (there) return {};
                         return Error{ErrorCode::kData, "the recording has ended"};
                       }};
}

Result<std::unique_ptr<FrameSource>> make_live_source(rig::RigConfig config, rig::Devices devices,
                                                      const std::atomic<bool>& stop, Clock& clock) {
  MIXRIG_ASSIGN(take::TakeInfo info, rig::take_info(config, devices));
  return std::unique_ptr<FrameSource>(std::make_unique<LiveSource>(
      std::move(config), std::move(devices), std::move(info), stop, clock));
}

Result<std::unique_ptr<FrameSource>> open_live_source(const std::filesystem::path& rig_toml,
                                                      const std::atomic<bool>& stop, Clock& clock) {
  MIXRIG_ASSIGN(rig::RigConfig config, rig::read_rig(rig_toml));
  MIXRIG_ASSIGN(rig::Devices devices,
                rig::open_devices(config, rig::DeviceOpener(clock, open_playable)));
  return make_live_source(std::move(config), std::move(devices), stop, clock);
}

}  // namespace mixrig::app
