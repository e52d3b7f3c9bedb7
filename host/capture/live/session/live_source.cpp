// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/session/live_source.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hal/base/log.h"
#include "host/capture/live/session/lens_stream.h"
#include "host/capture/live/session/live_capture.h"
#include "host/capture/live/session/lost_camera.h"

namespace mixrig::live {
namespace {

constexpr Duration kSetWait = std::chrono::milliseconds(100);
constexpr Duration kPatience = std::chrono::seconds(5);

class LiveSource final : public capture::CaptureSource {
 public:
  LiveSource(RigConfig config, Devices devices, capture::SourceInfo info,
             std::unique_ptr<LensStream> lens, const std::atomic<bool>& stop, Clock& clock,
             WhenLost when_lost, std::shared_ptr<CameraSettings> settings,
             std::shared_ptr<RunningRig> running)
      : config_(std::move(config)),
        devices_(std::move(devices)),
        info_(std::move(info)),
        cameras_(std::make_shared<capture::RigCameras>(info_)),
        lens_(std::move(lens)),
        stop_(stop),
        clock_(clock),
        when_lost_(when_lost),
        decoder_(config_, devices_,
                 when_lost == WhenLost::kGoOn ? WithoutDepth::kHold : WithoutDepth::kSkip),
        session_(config_, devices_, clock),
        settings_(std::move(settings)),
        running_(std::move(running)) {
    info_.frames = capture::kEndless;
  }

  ~LiveSource() override {
    // Ends the use of the rig before the devices stop.
    if (running_) running_->end();
    if (settings_) settings_->end();
  }

  const capture::SourceInfo& info() const override { return info_; }
  Result<bool> read(int number, capture::Capture& capture) override;
  Result<void> read_truth(int, capture::Truth&) override {
    return Error{ErrorCode::kData, "devices have no ground truth: use a take of mixrig studio"};
  }
  void share_plates(capture::PlateForms forms) override { decoder_.share_plates(forms); }
  std::optional<capture::SourceReport> report() const override {
    capture::SourceReport report = session_.report();
    report.left_out = left_out_;
    report.without_depth = without_depth_;
    report.held_depth = held_depth_;
    report.longest_gap_s = longest_gap_s_;
    return report;
  }

 private:
  Result<void> start();
  Error silence() const;
  bool waits_on();
  void count(const capture::Capture& capture);

  RigConfig config_;
  Devices devices_;
  capture::SourceInfo info_;
  std::shared_ptr<const capture::RigCameras> cameras_;
  std::unique_ptr<LensStream> lens_;  ///< null for a rig without [lens]
  const std::atomic<bool>& stop_;
  Clock& clock_;
  const WhenLost when_lost_;
  SetDecoder decoder_;
  LiveSession session_;
  std::shared_ptr<CameraSettings> settings_;  ///< null: no settings are changed
  std::shared_ptr<RunningRig> running_;       ///< null: the head is not moved
  bool started_ = false;
  std::atomic<std::uint64_t> left_out_ = 0;  ///< sets without colour or depth
  std::atomic<std::uint64_t> without_depth_ = 0, held_depth_ = 0;
  std::atomic<double> longest_gap_s_ = 0;
  std::optional<HostTime> first_, last_;  ///< mid-exposures of captures
  bool silent_ = false;                   ///< the wait for colour was logged
  bool depth_gone_ = false;               ///< the loss of depth was logged
};

Result<void> LiveSource::start() {
  MIXRIG_TRY(session_.start());
  if (running_) running_->follow(config_, devices_, session_);
  if (!settings_) return {};
  std::vector<CameraSettings::Named> cameras;
  for (std::size_t i = 0; i < devices_.cameras.size(); ++i)
    cameras.push_back({config_.cameras[i].name, devices_.cameras[i].get()});
  settings_->follow(std::move(cameras));
  return {};
}

/// Returns the error that says why no set came.
Error LiveSource::silence() const {
  if (auto lost = lost_camera(session_.report())) return *std::move(lost);
  return {ErrorCode::kDevice,
          "no frames that could be paired came from the cameras for five seconds: run mixrig diag"};
}

/// Whether colour may return by itself. Logs once that it is awaited.
bool LiveSource::waits_on() {
  const device::DeviceState color = devices_.cameras.front()->health().state;
  const bool returns =
      color == device::DeviceState::kStreaming || color == device::DeviceState::kLost;
  if (when_lost_ == WhenLost::kEnd || !first_ || !returns) return false;
  if (!std::exchange(silent_, true))
    log_warning("live", silence().context + "; waiting for it; Ctrl-C ends the run");
  return true;
}

/// Counts a capture that is given out. Logs once when a stream is lost, or back.
void LiveSource::count(const capture::Capture& capture) {
  using capture::Stream;
  using capture::StreamStatus;
  if (!first_) first_ = capture.mid_exposure;
  if (last_)
    longest_gap_s_ = std::max<double>(longest_gap_s_, seconds(capture.mid_exposure - *last_));
  last_ = capture.mid_exposure;
  if (std::exchange(silent_, false)) log_info("live", "pictures come again");
  const bool gone = capture.status_of(Stream::kDepth) == StreamStatus::kMissing;
  if (gone) ++without_depth_;
  if (capture.status_of(Stream::kDepth) == StreamStatus::kRepeated) ++held_depth_;
  if (gone == std::exchange(depth_gone_, gone)) return;
  if (!gone) return log_info("live", "depth comes again");
  const auto lost = lost_camera(session_.report());
  log_warning("live", (lost ? lost->context : "the depth camera sends nothing") +
                          ": frames are composited without depth, people are not keyed");
}

Result<bool> LiveSource::read(int number, capture::Capture& capture) {
  if (!std::exchange(started_, true)) MIXRIG_TRY(start());
  const HostTime begin = std::max(clock_.now(), config_.play_at.value_or(HostTime()));
  HostTime give_up = begin + kPatience;
  while (!stop_) {
    // Read before the queue: sets that were made before the cameras ended are still delivered.
    const bool ended = session_.ended();
    const auto set = session_.next(ended ? Duration(0) : kSetWait);
    if (!set) {
      if (ended) MIXRIG_TRY(session_.fault());
      if (ended) return false;
      if (clock_.now() < give_up) continue;
      if (!waits_on()) return silence();
      give_up = clock_.now() + kPatience;
      continue;
    }
    if (!decoder_.decode(*set, capture)) {
      ++left_out_;
      if (clock_.now() < give_up) continue;
      return silence();
    }
    if (running_) running_->give(*set, capture);
    count(capture);
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

Result<std::unique_ptr<capture::CaptureSource>> make_live_source(
    RigConfig config, Devices devices, const std::atomic<bool>& stop, Clock& clock,
    WhenLost when_lost, std::shared_ptr<CameraSettings> settings,
    std::shared_ptr<RunningRig> running) {
  MIXRIG_ASSIGN(capture::SourceInfo info, take_info(config, devices));
  MIXRIG_ASSIGN(auto lens, LensStream::open(config, devices, clock));
  return std::unique_ptr<capture::CaptureSource>(std::make_unique<LiveSource>(
      std::move(config), std::move(devices), std::move(info), std::move(lens), stop, clock,
      when_lost, std::move(settings), std::move(running)));
}

}  // namespace mixrig::live
