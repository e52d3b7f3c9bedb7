// SPDX-License-Identifier: Apache-2.0
#include "host/rig/player.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "hal/base/log.h"

namespace mixrig::rig {
namespace {

constexpr int kBuffers = 8;
constexpr Duration kLongestSleep = std::chrono::milliseconds(50);

void put_u16(std::uint8_t* out, long value) {
  out[0] = static_cast<std::uint8_t>(value);
  out[1] = static_cast<std::uint8_t>(value >> 8);
}

/// Rows of 16-bit samples, packed. What does not fit becomes 0, which is "unknown".
void fill_u16(const Image<float>& in, double scale, std::span<std::uint8_t> out) {
  std::uint8_t* at = out.data();
  for (int y = 0; y < in.height(); ++y)
    for (int x = 0; x < in.width(); ++x, at += 2) {
      const long value = std::lround(static_cast<double>(in.row(y)[x]) * scale);
      put_u16(at, value < 0 || value > 65535 ? 0 : value);
    }
}

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
  Result<void> set(device::CameraControl control, double) override { return unsupported(control); }
  Result<double> get(device::CameraControl control) override { return unsupported(control); }
  device::StreamHealth health() const override { return player_->health(channel_); }

 private:
  Error unsupported(device::CameraControl control) const {
    return Error{ErrorCode::kUnsupported, channel_.info.uri + ": " +
                                              std::string(device::name(control)) +
                                              " cannot be set on a recording"};
  }
  std::shared_ptr<Player> player_;
  Player::Channel& channel_;
};

Result<std::shared_ptr<Player>> Player::create(Playable playable, const std::string& uri,
                                               Clock& clock) {
  std::shared_ptr<Player> player(new Player(std::move(playable), clock));
  const take::TakeInfo& info = player->playable_.info;
  if (info.frames < 1 || !(info.color.rate_hz > 0))
    return Error{ErrorCode::kData, uri + ": has no frames, or tells no rate_hz: nothing to play"};
  MIXRIG_TRY(player->playable_.read(1, player->frame_));
  player->describe(uri);
  return player;
}

Player::Player(Playable playable, Clock& clock) : playable_(std::move(playable)), clock_(clock) {}

Player::~Player() {
  stop(color_);
  stop(depth_);
}

void Player::describe(const std::string& uri) {
  const take::TakeInfo& info = playable_.info;
  world_from_target_ = frame_.world_from_target;
  const auto describe_one = [&](Channel& channel, const char* view, Size size,
                                device::PixelFormat format) {
    channel.info = {.uri = uri + "/" + view,
                    .model = info.name,
                    .size = size,
                    .format = format,
                    .rate_hz = info.color.rate_hz,
                    .stamp_clock = device::StampClock::kHost};
    const std::size_t bytes =
        device::image_bytes(format, size, device::row_bytes(format, size.width));
    const bool amplitude = format == device::PixelFormat::kDepth16 && !frame_.amplitude.empty();
    channel.pool.emplace(kBuffers, bytes, amplitude ? bytes : 0);
  };
  describe_one(color_, "color", frame_.color.size(), device::PixelFormat::kRgb8);
  describe_one(depth_, "depth", frame_.depth_m.size(), device::PixelFormat::kDepth16);
  const bool along_ray = info.depth_kind == take::DepthKind::kDistance;
  depth_info_ = {.metres_per_step = info.depth_unit_m,
                 .meaning = along_ray ? device::DepthMeaning::kDistance : device::DepthMeaning::kZ,
                 .intrinsics = device::DeviceIntrinsics{
                     info.tof.pinhole.fx_px, info.tof.pinhole.cx_px, info.tof.pinhole.cy_px}};
}

std::unique_ptr<device::Camera> Player::camera() {
  const std::lock_guard lock(mutex_);
  color_.taken = true;
  return std::make_unique<PlayedCamera>(shared_from_this(), color_);
}

std::unique_ptr<device::DepthCamera> Player::depth() {
  const std::lock_guard lock(mutex_);
  depth_.taken = true;
  return device::as_depth_camera(std::make_unique<PlayedCamera>(shared_from_this(), depth_),
                                 depth_info_);
}

Result<void> Player::start(Channel& channel, device::FrameSink sink) {
  const std::lock_guard lock(mutex_);
  if (channel.sink) return Error{ErrorCode::kUsage, channel.info.uri + ": plays already"};
  channel.sink = std::move(sink);
  channel.health.state = device::DeviceState::kStreaming;
  const auto ready = [](const Channel& c) { return !c.taken || c.sink; };
  if (!ready(color_) || !ready(depth_)) return {};
  // One that stopped and starts again finds the player at work: it goes on with the next frame.
  if (!std::exchange(stop_, false)) return {};
  begin_ = clock_.now();
  thread_ = std::thread([this] { work(); });
  return {};
}

void Player::stop(Channel& channel) {
  std::thread done;
  {
    const std::lock_guard lock(mutex_);
    channel.sink = nullptr;
    channel.health.state = device::DeviceState::kStopped;
    if (color_.sink || depth_.sink) return;
    stop_ = true;
    done = std::move(thread_);
  }
  if (done.joinable()) done.join();
}

device::StreamHealth Player::health(const Channel& channel) const {
  const std::lock_guard lock(mutex_);
  return channel.health;
}

void Player::work() {
  const auto period = Duration(std::llround(1e9 / playable_.info.color.rate_hz));
  for (int number = 1; number <= playable_.info.frames; ++number) {
    if (const auto read = read_next(number); !read) {
      log_warning("rig", to_line(read.error()));
      return end(device::DeviceState::kFailed);
    }
    const HostTime due = begin_ + (number - 1) * period;
    wait_until(due);
    const std::lock_guard lock(mutex_);
    if (stop_) return;
    for (Channel* channel : {&color_, &depth_})
      if (channel->sink) publish(*channel, due);
  }
  end(device::DeviceState::kStopped);
}

Result<void> Player::read_next(int number) {
  MIXRIG_TRY(playable_.read(number, frame_));
  frame_.number = number;
  if (frame_.color.size() == color_.info.size && frame_.depth_m.size() == depth_.info.size)
    return {};
  return Error{ErrorCode::kData, color_.info.uri + ": frame " + std::to_string(number) +
                                     " is of another size than the first: playing ends"};
}

void Player::wait_until(HostTime due) {
  while (clock_.now() < due) {
    {
      const std::lock_guard lock(mutex_);
      if (stop_) return;
    }
    clock_.sleep_until(std::min(due, clock_.now() + kLongestSleep));
  }
}

void Player::publish(Channel& channel, HostTime at) {
  auto draft = channel.pool->take();
  if (!draft) {
    ++channel.health.overrun;
    return;
  }
  fill(channel, draft);
  const device::Frame frame{
      .format = channel.info.format,
      .size = channel.info.size,
      .stride_bytes = device::row_bytes(channel.info.format, channel.info.size.width),
      .sequence = static_cast<std::uint64_t>(frame_.number),
      .device_time = DeviceTime(at.time_since_epoch()),
      .received = clock_.now()};
  ++channel.health.frames;
  const std::size_t used = draft.bytes().size(), amplitude = draft.amplitude().size();
  channel.sink(std::move(draft).publish(frame, used, amplitude));
}

void Player::fill(const Channel& channel, device::FramePool::Draft& draft) const {
  if (&channel == &depth_) {
    fill_u16(frame_.depth_m, 1 / depth_info_.metres_per_step, draft.bytes());
    if (!draft.amplitude().empty() && !frame_.amplitude.empty())
      fill_u16(frame_.amplitude, 1, draft.amplitude());
    return;
  }
  const std::size_t row = device::row_bytes(channel.info.format, channel.info.size.width);
  std::uint8_t* at = draft.bytes().data();
  for (int y = 0; y < frame_.color.height(); ++y, at += row)
    std::memcpy(at, frame_.color.row(y), row);
}

void Player::end(device::DeviceState state) {
  const std::lock_guard lock(mutex_);
  for (Channel* channel : {&color_, &depth_})
    if (channel->sink) channel->health.state = state;
}

}  // namespace mixrig::rig
