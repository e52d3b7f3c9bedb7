// SPDX-License-Identifier: Apache-2.0
// A live rig that pans: the emulated pan-tilt unit turns, byte for byte behind its driver; the
// cameras see the room at its angle; the virtual object must stay where it is in the room.
#include <algorithm>
#include <cmath>
#include <functional>
#include <mutex>
#include <numbers>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "hal/device/frame_pool.h"
#include "hal/fake/flir_ptu_emulator.h"
#include "hal/wire/pan_tilt/flir_ptu.h"
#include "host/capture/calibration_file/calibration.h"
#include "host/capture/live/session/live_source.h"
#include "host/run/loop/run.h"
#include "tests/gl/quad_mesh.h"
#include "tests/support/progress.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/threaded_clock.h"
#include "tests/support/turning_room.h"

namespace mixrig::test {
namespace {

using namespace std::chrono_literals;

constexpr Size kSize{160, 90};
constexpr double kFocal_px = 140, kCentre_px = 79.5,
                 kStep_rad = 185.1428 / 3600 * std::numbers::pi / 180;
constexpr int kTurnFrames = 60, kFarthest_steps = 430;  // 22 degrees to either side

/// The emulated unit, used by two threads.
class Unit {
 public:
  void receive(std::span<const std::uint8_t> bytes, HostTime now) {
    const std::lock_guard lock(mutex_);
    unit_.receive(bytes, now);
  }
  std::size_t send(std::span<std::uint8_t> out) {
    const std::lock_guard lock(mutex_);
    std::string& waiting = unit_.output();
    const std::size_t count = std::min(waiting.size(), out.size());
    std::copy_n(waiting.begin(), count, out.begin());
    waiting.erase(0, count);
    return count;
  }
  /// Gives the unit a command from another controller; the host does not see the answers.
  void order(const std::string& words, HostTime now) {
    const std::lock_guard lock(mutex_);
    const std::size_t kept = unit_.output().size();
    unit_.receive({reinterpret_cast<const std::uint8_t*>(words.data()), words.size()}, now);
    unit_.output().resize(kept);
  }
  double pan_rad(HostTime now) {
    const std::lock_guard lock(mutex_);
    return kStep_rad * static_cast<double>(unit_.position(now)[0]);
  }

 private:
  std::mutex mutex_;
  fake::FlirPtuEmulator unit_;
};

/// The host's end of the unit's serial line; bytes take no time.
class Line final : public device::ByteStream {
 public:
  Line(Unit& unit, Clock& clock) : unit_(unit), clock_(clock) {}
  Result<std::size_t> read(std::span<std::uint8_t> out, Duration) override {
    return unit_.send(out);
  }
  Result<void> write(std::span<const std::uint8_t> bytes) override {
    unit_.receive(bytes, clock_.now());
    return {};
  }

 private:
  Unit& unit_;
  Clock& clock_;
};

/// A camera that delivers pictures drawn by the test.
class BarCamera final : public device::Camera {
 public:
  using Draw = std::function<void(std::span<std::uint8_t>)>;
  BarCamera(Clock& clock, device::PixelFormat format)
      : clock_(clock),
        info_{.uri = "drawn:",
              .model = "drawn",
              .size = kSize,
              .format = format,
              .rate_hz = 25,
              .stamp_clock = device::StampClock::kHost},
        pool_(8, device::image_bytes(format, kSize, device::row_bytes(format, kSize.width))) {}
  const device::CameraInfo& info() const override { return info_; }
  Result<void> start(device::FrameSink sink) override {
    const std::lock_guard lock(mutex_);
    sink_ = std::move(sink);
    health_.state = device::DeviceState::kStreaming;
    return {};
  }
  void stop() override {
    const std::lock_guard lock(mutex_);
    sink_ = nullptr;
    health_.state = device::DeviceState::kStopped;
  }
  Result<void> set(device::CameraControl, double) override { return {}; }
  Result<double> get(device::CameraControl) override { return 0.0; }
  device::StreamHealth health() const override {
    const std::lock_guard lock(mutex_);
    return health_;
  }
  bool streams() const { return health().state == device::DeviceState::kStreaming; }
  void expose(const Draw& draw) {
    auto draft = pool_.take();
    ASSERT_TRUE(draft);
    draw(draft.bytes());
    const device::Frame frame{.format = info_.format,
                              .size = kSize,
                              .stride_bytes = device::row_bytes(info_.format, kSize.width),
                              .sequence = ++sequence_,
                              .device_time = DeviceTime(clock_.now().time_since_epoch()),
                              .received = clock_.now()};
    const std::size_t used = draft.bytes().size();
    const std::lock_guard lock(mutex_);
    ++health_.frames;
    sink_(std::move(draft).publish(frame, used));
  }

 private:
  Clock& clock_;
  const device::CameraInfo info_;
  device::FramePool pool_;
  mutable std::mutex mutex_;
  device::FrameSink sink_;
  device::StreamHealth health_;
  std::uint64_t sequence_ = 0;
};

/// Columns of bar and object in a composite.
struct Columns {
  double bar_px = 0, object_px = 0;
  bool pose = false;
};

class ColumnSink final : public output::CompositeSink {
 public:
  explicit ColumnSink(std::vector<Columns>& frames, std::atomic<int>& count)
      : frames_(frames), count_(count) {}
  std::string_view name() const override { return "columns"; }
  render::OutputMask wanted(int) const override { return render::kColor | render::kLayer; }
  Result<void> write(const output::CompositePtr& composite) override {
    const auto& images = composite->images;
    Columns seen;
    seen.pose = composite->pose.ok();
    seen.bar_px = bar_in_row(kSize.width, [&](int x) { return images.color.at(x, 5).g; });
    double sum = 0;
    int count = 0;
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x)
        if (images.layer.at(x, y) == static_cast<std::uint8_t>(render::Layer::kVirtual))
          sum += x, ++count;
    seen.object_px = sum / count;
    frames_.push_back(seen);
    ++count_;
    return {};
  }
  Result<void> finish() override { return {}; }

 private:
  std::vector<Columns>& frames_;
  std::atomic<int>& count_;
};

class TurningHead : public ::testing::Test {
 protected:
  void SetUp() override {
    session_.scene.path = "scene.toml";
    session_.scene.pose_source = scene::PoseSource::kPanTilt;
    // The base is placed so that the camera has the world's axes at angles zero.
    session_.scene.camera.world_from_base.rotation =
        Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()));
    calibration_file::Calibration chain;
    chain.pan_tilt.emplace();
    chain.pan_tilt->head_from_target.rotation =
        Eigen::Quaterniond(Eigen::AngleAxisd(-std::numbers::pi / 2, Eigen::Vector3d::UnitX()));
    chain.pan_tilt->tilt.direction = Eigen::Vector3d::UnitX();
    session_.calibration.file = folder_ / "calibration.toml";
    ASSERT_TRUE(calibration_file::write_calibration(session_.calibration.file, chain));
    session_.source = open_rig();
    session_.setup = *session::setup_of(session_.source->info(), std::nullopt);
    session_.backend = {render::Backend::kCpu, 1};
    render::VirtualObject object;
    object.meshes.push_back(quad_.view);
    session_.setup.objects.push_back(std::move(object));
  }

  std::unique_ptr<capture::CaptureSource> open_rig() {
    live::RigConfig config;
    config.name = "turning";
    config.cameras.emplace_back();
    config.cameras[0].name = "color";
    config.depth.emplace();
    config.depth->name = "depth";
    config.target.emplace();
    config.target->pinhole = {kSize, kFocal_px, kFocal_px, kCentre_px, 44.5};
    config.tof = config.target;
    live::Devices devices;
    auto color = std::make_unique<BarCamera>(clock_, device::PixelFormat::kRgb8);
    auto depth = std::make_unique<BarCamera>(clock_, device::PixelFormat::kDepth16);
    color_ = color.get();
    depth_ = depth.get();
    devices.cameras.push_back(std::move(color));
    devices.depth = device::as_depth_camera(std::move(depth), {});
    auto head = device::FlirPtu::open(std::make_unique<Line>(unit_, clock_), clock_, "flir-ptu:");
    EXPECT_TRUE(head) << head.error().context;
    devices.pan_tilt = *std::move(head);
    auto source = live::make_live_source(std::move(config), std::move(devices), stop_, clock_);
    EXPECT_TRUE(source) << source.error().context;
    return *std::move(source);
  }

  /// Advances 10 ms and waits until the head has answered twice after that.
  void tick() {
    clock_.advance(10ms);
    const auto answers = [&] { return session_.source->report()->pan_tilt_samples; };
    const std::uint64_t wanted = answers() + 2;
    EXPECT_TRUE(comes_true([&] { return done_ || answers() >= wanted; }));
  }
  void expose() {
    const double pan_rad = unit_.pan_rad(clock_.now());
    color_->expose([&](std::span<std::uint8_t> rgb) {
      for (std::size_t i = 0; i < rgb.size(); ++i)
        rgb[i] = static_cast<std::uint8_t>(room_.luminance(
            static_cast<int>(i / 3 % static_cast<std::size_t>(kSize.width)), pan_rad));
    });
    // A cylindrical wall: its depth does not change while the camera turns.
    depth_->expose([](std::span<std::uint8_t> steps) {
      for (std::size_t i = 0; i < steps.size(); i += 2) steps[i] = 0xd0, steps[i + 1] = 0x07;
    });
  }
  /// Swings the unit to and fro at 0.36 rad/s while kTurnFrames pictures are taken.
  void swing() {
    ASSERT_TRUE(comes_true([&] { return done_ || (color_->streams() && depth_->streams()); }));
    unit_.order("PS400 ", clock_.now());
    int exposed = 0, target = kFarthest_steps;
    for (int number = 0; exposed < kTurnFrames && !done_; ++number) {
      if (number == 0 || number % 120 == 60) {
        unit_.order("PP" + std::to_string(target) + " ", clock_.now());
        target = -target;
      }
      tick();
      if (number % 4 != 0) continue;
      expose();
      ++exposed;
      // A set waits for the head's next answer: all but the last two pictures are composited.
      EXPECT_TRUE(comes_true([&] { return done_ || composited_ >= exposed - 2; })) << exposed;
    }
    color_->stop();
    depth_->stop();
    while (!done_) tick();
  }

  const TemporaryFolder folder_;
  const TurningRoom room_{kFocal_px, kCentre_px};
  // The object is straight ahead at 1 m, in the lower half of the picture.
  const Quad quad_{{-0.05F, 0.05F}, {0.05F, 0.2F}, 1};
  SteppedClock clock_;
  Unit unit_;
  std::atomic<bool> stop_ = false, done_ = false;
  std::atomic<int> composited_ = 0;
  BarCamera *color_ = nullptr, *depth_ = nullptr;
  session::Session session_;
  std::vector<Columns> frames_;
};

TEST_F(TurningHead, TheObjectStaysInTheRoom) {
  session::RunParts parts;
  parts.sinks.push_back(std::make_unique<ColumnSink>(frames_, composited_));
  std::thread world([&] { swing(); });
  const auto report = session::run(session_, {}, clock_, {}, std::move(parts));
  done_ = true;
  world.join();
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_EQ(report->pose.source, "pan_tilt");
  EXPECT_GE(frames_.size(), kTurnFrames - 5U);
  double worst_px = 0, low_px = 1e9, high_px = 0;
  int known = 0;
  for (const Columns& seen : frames_) {
    if (!seen.pose) continue;
    ++known;
    worst_px = std::max(worst_px, std::abs(seen.object_px - seen.bar_px));
    low_px = std::min(low_px, seen.object_px);
    high_px = std::max(high_px, seen.object_px);
  }
  EXPECT_GE(known, kTurnFrames - 10);
  // The head moves by 0.4 rad in all. The object stays within 0.75 px: half a pixel for the whole
  // pixels of the mask, a quarter for two of the unit's steps.
  EXPECT_GT(high_px - low_px, 0.4 * kFocal_px);
  EXPECT_LT(worst_px, 0.75);
  std::printf("%d frames, object from column %.1f to %.1f, at most %.2f px from the bar\n", known,
              low_px, high_px, worst_px);
}

}  // namespace
}  // namespace mixrig::test
