// SPDX-License-Identifier: Apache-2.0
// Measures the processor time that a live rig costs the host, without decoding and encoding: three
// cameras of 1280x1024 (YUYV at 25, 25 and 10 Hz) whose pictures are copied out of a driver's
// buffer, a ToF camera of 640x480 (distance and amplitude, checksummed packets) at 25 Hz, a master
// of 100 Hz, pairing into sets. The emulated devices' own time is subtracted. Prints percent of one
// core. usage: rig_cpu_bench [SECONDS]
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <thread>

#include <sys/resource.h>
#include <time.h>

#include "hal/device/frame_pool.h"
#include "hal/fake/fake_trigger.h"
#include "hal/linux/tof_usb_camera.h"
#include "host/capture/live/session/live_session.h"
#include "tests/support/fake_bulk.h"
#include "tests/support/tof_stream.h"

namespace mixrig {
namespace {

using namespace std::chrono_literals;
constexpr Size kColor{1280, 1024}, kTof{640, 480};

double thread_cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double process_cpu_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto s = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return s(usage.ru_utime) + s(usage.ru_stime);
}

/// Does the work of the V4L2 driver without the kernel: wakes up, takes a buffer, copies,
/// publishes.
class CopyingCamera final : public device::Camera {
 public:
  CopyingCamera(double rate_hz, Clock& clock)
      : info_{.uri = "bench:",
              .size = kColor,
              .format = device::PixelFormat::kYuyv,
              .rate_hz = rate_hz,
              .stamp_clock = device::StampClock::kHost},
        clock_(clock),
        kernel_(kColor.area() * 2, 77),
        pool_(6, kernel_.size()) {}
  ~CopyingCamera() override { stop(); }
  const device::CameraInfo& info() const override { return info_; }
  Result<void> start(device::FrameSink sink) override {
    sink_ = std::move(sink);
    stop_ = false;
    thread_ = std::thread([this] { work(); });
    return {};
  }
  void stop() override {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  Result<void> set(device::CameraControl, double) override { return {}; }
  Result<double> get(device::CameraControl) override { return 0.0; }
  device::StreamHealth health() const override { return {.frames = frames_}; }

 private:
  void work() {
    HostTime next = clock_.now();
    for (std::uint64_t sequence = 0; !stop_; ++sequence) {
      next += Duration(static_cast<long>(1e9 / info_.rate_hz));
      clock_.sleep_until(next);
      auto draft = pool_.take();
      if (!draft) continue;
      std::memcpy(draft.bytes().data(), kernel_.data(), kernel_.size());
      ++frames_;
      sink_(std::move(draft).publish({.format = info_.format,
                                      .size = info_.size,
                                      .stride_bytes = 2 * static_cast<std::size_t>(kColor.width),
                                      .sequence = sequence,
                                      .device_time = DeviceTime(clock_.now().time_since_epoch()),
                                      .received = clock_.now()},
                                     kernel_.size()));
    }
  }
  device::CameraInfo info_;
  Clock& clock_;
  std::vector<std::uint8_t> kernel_;
  device::FramePool pool_;
  device::FrameSink sink_;
  std::thread thread_;
  std::atomic<bool> stop_ = false;
  std::atomic<std::uint64_t> frames_ = 0;
};

/// Ticks and ToF packets, on a thread whose time does not count.
class Emulator {
 public:
  Emulator(fake::FakeTrigger& trigger, test::FakeTofDevice& tof,
           const device::TofDescription& description, Clock& clock)
      : thread_([&trigger, &tof, description, &clock, this] {
          std::vector<std::vector<std::vector<std::uint8_t>>> frames;
          for (std::uint32_t frame = 0; frame < 8; ++frame)
            frames.push_back(test::tof_frame(description, frame, 0));
          HostTime next = clock.now();
          std::uint32_t counter = 0;
          while (!stop_) {
            next += 10ms;
            clock.sleep_until(next);
            if (trigger.tick() % 4 == 0) send(tof, description, ++counter, frames);
            cpu_s_ = thread_cpu_s();
          }
        }) {}
  ~Emulator() {
    stop_ = true;
    thread_.join();
  }
  double cpu_s() const { return cpu_s_; }

 private:
  /// Sends one of eight prepared frames in turn; only the headers are new.
  static void send(test::FakeTofDevice& tof, const device::TofDescription& description,
                   std::uint32_t counter,
                   const std::vector<std::vector<std::vector<std::uint8_t>>>& frames) {
    for (auto packet : frames[counter % frames.size()]) {
      auto header = *device::parse_tof_header(packet, description.size);
      header.frame = counter;
      header.time_us = 40'000ULL * counter;
      const auto bytes = device::pack_tof_header(header);
      std::copy(bytes.begin(), bytes.end(), packet.begin());
      tof.send(std::move(packet));
    }
  }
  std::atomic<bool> stop_ = false;
  std::atomic<double> cpu_s_ = 0;
  std::thread thread_;
};

int run(double seconds_wanted) {
  SystemClock clock;
  live::RigConfig config;
  config.lines = {{0, {.divider = 4, .width = 1ms}}, {1, {.divider = 10, .width = 1ms}}};
  live::Devices devices;
  for (const double rate_hz : {25.0, 25.0, 10.0}) {
    live::CameraConfig camera;
    camera.name = "camera" + std::to_string(config.cameras.size());
    config.cameras.push_back(camera);
    devices.cameras.push_back(std::make_unique<CopyingCamera>(rate_hz, clock));
  }
  device::TofDescription description;
  description.size = kTof;
  description.rate_hz = 25;
  description.amplitude = true;
  description.depth.metres_per_step = 0.00025;
  test::FakeTofDevice tof(description, clock);
  auto depth = device::open_tof(std::make_unique<test::FakeBulk>(tof), "usb:bench", clock);
  if (!depth) return 1;
  devices.depth = *std::move(depth);
  config.depth.emplace();
  config.depth->name = "depth";
  config.depth->trigger_line = 0;
  auto trigger = std::make_unique<fake::FakeTrigger>(clock);
  auto* master = trigger.get();
  devices.trigger = std::move(trigger);
  live::LiveSession session(config, devices, clock);
  if (!session.start()) return 1;
  const Emulator emulator(*master, tof, description, clock);
  const HostTime warm = clock.now() + 2s;
  while (clock.now() < warm) (void)session.next(100ms);
  const double cpu_s = process_cpu_s(), off_s = emulator.cpu_s();
  const HostTime begin = clock.now();
  const auto before = session.report();
  while (seconds(clock.now() - begin) < seconds_wanted) (void)session.next(100ms);
  const double wall_s = seconds(clock.now() - begin);
  const double used_s = process_cpu_s() - cpu_s - (emulator.cpu_s() - off_s);
  const auto after = session.report();
  std::printf("%.1f %% of one core over %.1f s (emulated devices: %.1f %% more)\n",
              100 * used_s / wall_s, wall_s, 100 * (emulator.cpu_s() - off_s) / wall_s);
  for (std::size_t i = 0; i < after.streams.size(); ++i)
    std::printf(
        "%-8s %.1f Hz\n", after.streams[i].name.c_str(),
        static_cast<double>(after.streams[i].health.frames - before.streams[i].health.frames) /
            wall_s);
  std::printf("sets     %.1f Hz, %llu dropped\n",
              static_cast<double>(after.sets - before.sets) / wall_s,
              static_cast<unsigned long long>(after.dropped_sets - before.dropped_sets));
  session.stop();
  return 0;
}

}  // namespace
}  // namespace mixrig

int main(int argc, char** argv) { return mixrig::run(argc > 1 ? std::atof(argv[1]) : 10); }
