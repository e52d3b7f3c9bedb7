// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/play/player.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "hal/base/guarded.h"
#include "hal/base/log.h"

namespace mixrig::live {
namespace {

constexpr int kBuffers = 8;
constexpr Duration kLongestSleep = std::chrono::milliseconds(50);

void put_u16(std::uint8_t* out, long value) {
  out[0] = static_cast<std::uint8_t>(value);
  out[1] = static_cast<std::uint8_t>(value >> 8);
}

/// Writes rows of 16-bit samples, packed: (value - offset) * scale. Values out of range, and 0,
/// become 0, which is "unknown".
void fill_u16(const Image<float>& in, double offset, double scale, std::span<std::uint8_t> out) {
  std::uint8_t* at = out.data();
  for (int y = 0; y < in.height(); ++y)
    for (int x = 0; x < in.width(); ++x, at += 2) {
      const double from = static_cast<double>(in.row(y)[x]);
      const long value = std::lround((from - offset) * scale);
      put_u16(at, from <= 0 || value < 0 || value > 65535 ? 0 : value);
    }
}

}  // namespace

Result<std::shared_ptr<Player>> Player::create(std::unique_ptr<capture::CaptureSource> source,
                                               const std::string& uri, Clock& clock) {
  std::shared_ptr<Player> player(new Player(std::move(source), clock));
  const capture::SourceInfo& info = player->info();
  if (info.frames < 1 || !(info.rate_hz > 0))
    return Error{ErrorCode::kData, uri + ": has no frames or no rate_hz: it cannot be played"};
  if (capture::RenderedHead* head = player->source_->rendered().head) {
    head->turn({});
    device::PanTiltInfo unit = head->limits();
    unit.uri = uri + "/head";
    player->motion_ = std::make_shared<SteeredMotion>(std::move(unit));
  }
  MIXRIG_TRY(player->read(1));
  player->first_s_ = player->capture_.time_s;
  player->uri_ = uri;
  if (const auto& first = player->capture_.pan_tilt; first && !player->motion_)
    player->angles_ = std::make_shared<PlayedAngles>(*first);
  player->describe(uri);
  return player;
}

Player::Player(std::unique_ptr<capture::CaptureSource> source, Clock& clock)
    : source_(std::move(source)), clock_(clock) {}

Player::~Player() {
  for (Channel* channel : channels()) stop(*channel);
}

void Player::describe(const std::string& uri) {
  const capture::SourceInfo& info = source_->info();
  first_pose_ = {1, capture_.world_from_target, capture_.pose_origin};
  const auto describe_one = [&](Channel& channel, const char* view, Size size,
                                device::PixelFormat format) {
    channel.info = {.uri = uri + "/" + view,
                    .model = info.name,
                    .size = size,
                    .format = format,
                    .rate_hz = info.rate_hz,
                    .stamp_clock = device::StampClock::kHost};
    const std::size_t bytes =
        device::image_bytes(format, size, device::row_bytes(format, size.width));
    const capture::DepthPicture& second = capture_.depth2;
    const bool lit = !(&channel == &depth2_ ? second.amplitude : capture_.amplitude).empty();
    const bool amplitude = format == device::PixelFormat::kDepth16 && lit;
    channel.pool.emplace(kBuffers, bytes, amplitude ? bytes : 0);
  };
  describe_one(color_, "color", capture_.plate.size(), device::PixelFormat::kRgb8);
  describe_one(depth_, "depth", capture_.depth_m.size(), device::PixelFormat::kDepth16);
  if (info.tof2)
    describe_one(depth2_, "depth2", capture_.depth2.depth_m.size(), device::PixelFormat::kDepth16);
  if (const capture::RenderedExposure* exposure = source_->rendered().exposure) {
    const auto [least_s, most_s, step_s] = exposure->limits();
    color_.info.controls = {{device::CameraControl::kExposure, least_s, most_s, step_s}};
    exposure_s_ = exposure->rest_s();
  }
  const auto steps_of = [](const geometry::Pinhole& p, capture::DepthKind kind, double unit_m,
                           double offset_m, bool light) {
    return device::DepthInfo{.metres_per_step = unit_m,
                             .offset_m = offset_m,
                             .amplitude_is_light = light,
                             .meaning = kind == capture::DepthKind::kDistance
                                            ? device::DepthMeaning::kDistance
                                            : device::DepthMeaning::kZ,
                             .intrinsics = device::DeviceIntrinsics{p.fx_px, p.cx_px, p.cy_px}};
  };
  depth_info_ = steps_of(info.tof.pinhole, info.depth_kind, info.depth_unit_m, info.depth_offset_m,
                         info.amplitude_is_light);
  if (const auto& second = info.tof2)
    depth2_info_ = steps_of(second->model.pinhole, second->kind, second->unit_m, second->offset_m,
                            second->amplitude_is_light);
}

Result<void> Player::start(Channel& channel, device::FrameSink sink) {
  const std::lock_guard lock(mutex_);
  if (channel.sink)
    return Error{ErrorCode::kUsage, channel.info.uri + ": is already playing: stop it first"};
  if (stop_ && play_at_ && clock_.now() > *play_at_)
    return Error{ErrorCode::kUsage,
                 channel.info.uri + ": play_at_s in rig.toml has passed: give a later time"};
  channel.sink = std::move(sink);
  channel.health.state = device::DeviceState::kStreaming;
  for (const Channel* c : channels())
    if (c->taken && !c->sink) return {};
  // A camera that stopped and starts again while the player runs continues with the next frame.
  if (!std::exchange(stop_, false)) return {};
  begin_ = play_at_.value_or(clock_.now());
  if (angles_) angles_->restart();
  thread_ = guarded_thread(
      "playing", [this] { work(); },
      [this](const Error& error) {
        log_warning("rig", to_line(error));
        end(device::DeviceState::kFailed);
      });
  return {};
}

void Player::stop(Channel& channel) {
  std::thread done;
  {
    const std::lock_guard lock(mutex_);
    channel.sink = nullptr;
    channel.health.state = device::DeviceState::kStopped;
    for (const Channel* c : channels())
      if (c->sink) return;
    stop_ = true;
    done = std::move(thread_);
  }
  if (done.joinable()) done.join();
}

device::StreamHealth Player::health(const Channel& channel) const {
  const std::lock_guard lock(mutex_);
  return channel.health;
}

Player::PlayedPose Player::pose_of(std::uint64_t sequence) const {
  const std::lock_guard lock(mutex_);
  const PlayedPose& kept = poses_[sequence % poses_.size()];
  return kept.sequence == sequence ? kept : first_pose_;
}

/// False when playing ends.
bool Player::publish_both(int number, HostTime due) {
  const std::lock_guard lock(mutex_);
  if (stop_) return false;
  poses_[static_cast<std::size_t>(number) % poses_.size()] = {
      static_cast<std::uint64_t>(number), capture_.world_from_target, capture_.pose_origin};
  for (Channel* channel : {&color_, &depth_})
    if (channel->sink) publish(*channel, due, static_cast<std::uint64_t>(number));
  if (depth2_.sink)
    publish(depth2_, due + (capture_.depth2.mid_exposure - capture_.mid_exposure),
            static_cast<std::uint64_t>(number));
  return true;
}

/// False when playing ends.
bool Player::publish_fisheye(HostTime at) {
  const std::lock_guard lock(mutex_);
  if (stop_) return false;
  if (fisheye_.sink) publish(fisheye_, at, capture_.fisheye_counter);
  return true;
}

bool Player::has_new_fisheye() const {
  return fisheye_.taken &&
         capture_.status_of(capture::Stream::kFisheye) == capture::StreamStatus::kFresh &&
         capture_.fisheye.size() == fisheye_.info.size;
}

/// The fisheye's picture lies before or after its frame, by less than the time to the next one.
bool Player::publish_in_time(int number, HostTime due) {
  const bool has_picture = has_new_fisheye();
  const HostTime picture_due = due + (capture_.fisheye_mid_exposure - capture_.mid_exposure);
  const auto frame = [&] {
    wait_until(due);
    return publish_both(number, due);
  };
  const auto picture = [&] {
    if (!has_picture) return true;
    wait_until(picture_due);
    return publish_fisheye(picture_due);
  };
  return picture_due <= due ? picture() && frame() : frame() && picture();
}

void Player::work_steered() {
  const double rate_hz = source_->info().rate_hz;
  for (int number = 1; number <= source_->info().frames;) {
    const HostTime due = begin_ + Duration(std::llround((number - 1) / rate_hz * 1e9));
    wait_until(due);
    const capture::RenderedRig rig = source_->rendered();
    rig.head->turn(motion_->at(due));
    if (rig.exposure != nullptr) rig.exposure->set(exposure_s_);
    if (const auto read = read_next(number); !read) {
      log_warning("rig", to_line(read.error()));
      return end(device::DeviceState::kFailed);
    }
    if (!publish_both(number, due)) return;
    const double passed = seconds(clock_.now() - begin_) * rate_hz;
    number = std::max(number + 1, 1 + static_cast<int>(std::ceil(passed)));
  }
  end(device::DeviceState::kStopped);
}

void Player::work() {
  if (motion_) return work_steered();
  for (int number = 1; number <= source_->info().frames; ++number) {
    if (const auto read = read_next(number); !read) {
      log_warning("rig", to_line(read.error()));
      return end(device::DeviceState::kFailed);
    }
    const HostTime due = begin_ + Duration(std::llround((capture_.time_s - first_s_) * 1e9));
    if (angles_ && capture_.pan_tilt) angles_->add(due, *capture_.pan_tilt);
    if (!publish_in_time(number, due)) return;
  }
  end(device::DeviceState::kStopped);
}

Result<void> Player::read(int number) {
  MIXRIG_ASSIGN(const bool there, source_->read(number, capture_));
  if (there) return {};
  return Error{ErrorCode::kData, "the recording ends before frame " + std::to_string(number)};
}

/// Reads a frame, which must also fit the devices' buffers.
Result<void> Player::read_next(int number) {
  MIXRIG_TRY(read(number));
  if (capture_.plate.size() == color_.info.size && capture_.depth_m.size() == depth_.info.size &&
      (!depth2_.taken || capture_.depth2.depth_m.size() == depth2_.info.size))
    return {};
  return Error{ErrorCode::kData, color_.info.uri + ": frame " + std::to_string(number) +
                                     " has another size than the first: playing ends"};
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

void Player::publish(Channel& channel, HostTime at, std::uint64_t counter) {
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
      .sequence = counter,
      .device_time = DeviceTime(at.time_since_epoch()),
      .received = clock_.now()};
  ++channel.health.frames;
  const std::size_t used = draft.bytes().size(), amplitude = draft.amplitude().size();
  channel.sink(std::move(draft).publish(frame, used, amplitude));
}

void Player::fill(const Channel& channel, device::FramePool::Draft& draft) const {
  const auto fill_depth = [&](const Image<float>& depth_m, const Image<float>& amplitude,
                              const device::DepthInfo& steps) {
    fill_u16(depth_m, steps.offset_m, 1 / steps.metres_per_step, draft.bytes());
    if (!draft.amplitude().empty() && !amplitude.empty())
      fill_u16(amplitude, 0, 1, draft.amplitude());
  };
  if (&channel == &depth_) return fill_depth(capture_.depth_m, capture_.amplitude, depth_info_);
  if (&channel == &depth2_)
    return fill_depth(capture_.depth2.depth_m, capture_.depth2.amplitude, depth2_info_);
  const Image<Rgb8>& picture = &channel == &fisheye_ ? capture_.fisheye : capture_.plate;
  const std::size_t row = device::row_bytes(channel.info.format, channel.info.size.width);
  std::uint8_t* at = draft.bytes().data();
  for (int y = 0; y < picture.height(); ++y, at += row) std::memcpy(at, picture.row(y), row);
}

void Player::end(device::DeviceState state) {
  if (angles_) angles_->end();
  const std::lock_guard lock(mutex_);
  for (Channel* channel : channels())
    if (channel->sink) channel->health.state = state;
}

}  // namespace mixrig::live
