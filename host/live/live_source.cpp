// SPDX-License-Identifier: Apache-2.0
#include "host/live/live_source.h"

#include <algorithm>
#include <utility>

#include "host/live/lens_stream.h"
#include "host/live/live_capture.h"
#include "host/live/lost_camera.h"

namespace mixrig::live {
namespace {

constexpr Duration kSetWait = std::chrono::milliseconds(100);
constexpr Duration kPatience = std::chrono::seconds(5);

class LiveSource final : public capture::CaptureSource {
 public:
  LiveSource(RigConfig config, Devices devices, capture::SourceInfo info,
             std::unique_ptr<LensStream> lens, const std::atomic<bool>& stop, Clock& clock)
      : config_(std::move(config)),
        devices_(std::move(devices)),
        info_(std::move(info)),
        cameras_(std::make_shared<capture::RigCameras>(info_)),
        lens_(std::move(lens)),
        stop_(stop),
        clock_(clock),
        decoder_(config_, devices_),
        session_(config_, devices_, clock) {
    info_.frames = capture::kEndless;
  }

  const capture::SourceInfo& info() const override { return info_; }
  Result<bool> read(int number, capture::Capture& capture) override;
  Result<void> read_truth(int, capture::Truth&) override {
    return Error{ErrorCode::kData, "live devices have no truth"};
  }
  std::optional<capture::SourceReport> report() const override {
    capture::SourceReport report = session_.report();
    report.left_out = left_out_;
    return report;
  }

 private:
  Error silence() const;

  RigConfig config_;
  Devices devices_;
  capture::SourceInfo info_;
  std::shared_ptr<const capture::RigCameras> cameras_;
  std::unique_ptr<LensStream> lens_;  ///< null for a rig without
  const std::atomic<bool>& stop_;
  Clock& clock_;
  SetDecoder decoder_;
  LiveSession session_;
  bool started_ = false;
  std::atomic<std::uint64_t> left_out_ = 0;  ///< sets without colour or depth
  std::optional<HostTime> first_;
};

/// Why nothing came.
Error LiveSource::silence() const {
  if (auto lost = lost_camera(session_.report())) return *std::move(lost);
  return {ErrorCode::kDevice,
          "no frames that could be paired came from the cameras for five seconds: run mixrig diag"};
}

Result<bool> LiveSource::read(int number, capture::Capture& capture) {
  if (!std::exchange(started_, true)) MIXRIG_TRY(session_.start());
  const HostTime begin = std::max(clock_.now(), config_.play_at.value_or(HostTime()));
  const HostTime give_up = begin + kPatience;
  while (!stop_) {
    // Read before the queue: sets that were made before the cameras ended are still delivered.
    const bool ended = session_.ended();
    const auto set = session_.next(ended ? Duration(0) : kSetWait);
    if (!set) {
      if (ended) return false;
      if (clock_.now() < give_up) continue;
      return silence();
    }
    if (!decoder_.decode(*set, capture)) {
      ++left_out_;
      if (clock_.now() < give_up) continue;
      return silence();
    }
    if (!first_) first_ = capture.mid_exposure;
    capture.number = number;
    capture.time_s = seconds(capture.mid_exposure - *first_);
    capture.cameras = cameras_;
    capture.lens.reset();
    capture.encoders = lens_ ? lens_->at(capture.mid_exposure) : std::nullopt;
    set_pose(config_, devices_, *set, capture);
    return true;
  }
  return false;
}

}  // namespace

Result<std::unique_ptr<capture::CaptureSource>> make_live_source(RigConfig config, Devices devices,
                                                                 const std::atomic<bool>& stop,
                                                                 Clock& clock) {
  MIXRIG_ASSIGN(capture::SourceInfo info, take_info(config, devices));
  MIXRIG_ASSIGN(auto lens, LensStream::open(config, clock));
  return std::unique_ptr<capture::CaptureSource>(std::make_unique<LiveSource>(
      std::move(config), std::move(devices), std::move(info), std::move(lens), stop, clock));
}

}  // namespace mixrig::live
