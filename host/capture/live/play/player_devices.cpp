// SPDX-License-Identifier: Apache-2.0
// The devices of a Player.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "host/capture/live/play/player.h"

namespace mixrig::live {
namespace {

constexpr int kFisheyeBuffers = 8;
constexpr double kFisheyeWithin_s = 2;  ///< time from the first frame to the first fisheye picture

}  // namespace

/// One camera of a Player.
class PlayedCamera final : public device::Camera {
 public:
  PlayedCamera(std::shared_ptr<Player> player, Player::Channel& channel)
      : player_(std::move(player)), channel_(channel) {}
  ~PlayedCamera() override { stop(); }
  const device::CameraInfo& info() const override { return channel_.info; }
  Result<void> start(device::FrameSink sink) override {
    return player_->start(channel_, std::move(sink));
  }
  void stop() override { player_->stop(channel_); }
  Result<void> set(device::CameraControl control, double value) override {
    if (!offers(control)) return unsupported(control);
    const device::ControlRange& range = channel_.info.controls.front();
    if (!(value >= range.minimum && value <= range.maximum))
      return Error{ErrorCode::kUsage,
                   fmt::format("{}: exposure {} s is not within {} to {} s", channel_.info.uri,
                               value, range.minimum, range.maximum)};
    player_->exposure_s_ = value;
    return {};
  }
  Result<double> get(device::CameraControl control) override {
    if (!offers(control)) return unsupported(control);
    return player_->exposure_s_.load();
  }
  device::StreamHealth health() const override { return player_->health(channel_); }

 private:
  bool offers(device::CameraControl control) const {
    return control == device::CameraControl::kExposure && !channel_.info.controls.empty();
  }
  Error unsupported(device::CameraControl control) const {
    return Error{ErrorCode::kUnsupported, channel_.info.uri + ": " +
                                              std::string(device::name(control)) +
                                              " cannot be set on a recording"};
  }
  std::shared_ptr<Player> player_;
  Player::Channel& channel_;
};

/// Finds size and rate of the fisheye; then reads the first frame again.
Result<void> Player::find_fisheye() {
  const capture::SourceInfo& info = source_->info();
  const auto last = std::min(info.frames, 1 + static_cast<int>(kFisheyeWithin_s * info.rate_hz));
  for (int number = 1; capture_.fisheye.empty() && number <= last; ++number)
    MIXRIG_TRY(read(number));
  if (capture_.fisheye.empty())
    return Error{ErrorCode::kData,
                 uri_ +
                     ": has no pictures of a fisheye: record it with the fisheye in rig.toml; "
                     "mixrig studio needs --fisheye, studio: devices the fisheye's WxH as the "
                     "last of SCENARIO,SEED,RIG,FRAMES,WxH,WxH"};
  const Size size = capture_.fisheye.size();
  fisheye_.info = color_.info;
  fisheye_.info.uri = uri_ + "/fisheye";
  fisheye_.info.size = size;
  fisheye_.info.rate_hz = info.fisheye_rate_hz;
  fisheye_.pool.emplace(
      kFisheyeBuffers,
      device::image_bytes(device::PixelFormat::kRgb8, size,
                          device::row_bytes(device::PixelFormat::kRgb8, size.width)),
      std::size_t{0});
  return read(1);
}

std::unique_ptr<device::Camera> Player::camera() {
  const std::lock_guard lock(mutex_);
  color_.taken = true;
  return std::make_unique<PlayedCamera>(shared_from_this(), color_);
}

std::unique_ptr<device::DepthCamera> Player::depth() {
  std::unique_lock lock(mutex_);
  depth_.taken = true;
  lock.unlock();  // a camera that finds no memory is destroyed, which locks
  return device::as_depth_camera(std::make_unique<PlayedCamera>(shared_from_this(), depth_),
                                 depth_info_);
}

Result<std::unique_ptr<device::DepthCamera>> Player::depth2() {
  std::unique_lock lock(mutex_);
  if (!depth2_.pool)
    return Error{ErrorCode::kData,
                 uri_ +
                     ": has no second depth camera: record it with two [[depth]] in rig.toml; "
                     "studio: needs RIG+RIG in SCENARIO,SEED,RIG"};
  depth2_.taken = true;
  lock.unlock();  // a camera that finds no memory is destroyed, which locks
  return device::as_depth_camera(std::make_unique<PlayedCamera>(shared_from_this(), depth2_),
                                 depth2_info_);
}

Result<std::unique_ptr<device::Camera>> Player::fisheye() {
  const std::lock_guard lock(mutex_);
  if (!fisheye_.pool) MIXRIG_TRY(find_fisheye());
  fisheye_.taken = true;
  return std::unique_ptr<device::Camera>(
      std::make_unique<PlayedCamera>(shared_from_this(), fisheye_));
}

Result<std::unique_ptr<device::PanTilt>> Player::pan_tilt() {
  if (motion_) return make_steered_head(motion_, clock_);
  if (!angles_)
    return Error{ErrorCode::kData, uri_ + ": the recording has no angles of the head: record it " +
                                       "with the head in rig.toml (pan_tilt.csv)"};
  return make_played_head(angles_, {uri_ + "/head", info().name, {}, {}, {}}, clock_);
}

}  // namespace mixrig::live
