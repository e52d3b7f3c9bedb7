// SPDX-License-Identifier: Apache-2.0
#include "tests/support/genicam/genicam_take.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <utility>

#include "hal/wire/camera/genicam_buffer.h"
#include "host/capture/take/take.h"

namespace mixrig::test {
namespace {

constexpr double kStep_m = 0.00025;
constexpr std::uint16_t kInvalid = 65535;
constexpr std::uint64_t kAhead =
    6;  // frames that may be sent ahead: the host leaves some out until it has learned the clocks
constexpr std::uint64_t kClockAhead_ns = 12'345'678'901;  // lead of the cameras' clock

using namespace std::chrono;

/// Features of a camera that sends the parts, as 16-bit samples, of a point cloud of one component.
GenicamFeatures depth_features(const take::TakeInfo& info, GenicamDepthLayout layout) {
  const geometry::Pinhole& lens = info.tof.pinhole;
  GenicamFeatures features = helios2_features(lens.fx_px, lens.cx_px, lens.cy_px);
  features.size = lens.size_px;
  features.sends_alone = false;
  if (layout == GenicamDepthLayout::kAbcy) return features;
  std::erase_if(features.formats, [](const auto& f) { return f.first == "Coord3D_ABCY16"; });
  features.formats.push_back({"Confidence16", device::pfnc::kConfidence16});
  features.xml += genicam_components();
  features.multipart = true;
  features.payload_bytes = static_cast<int>(6 * lens.size_px.area());
  return features;
}

std::span<const std::uint8_t> bytes_of(const std::vector<std::uint16_t>& samples) {
  return {reinterpret_cast<const std::uint8_t*>(samples.data()), 2 * samples.size()};
}

}  // namespace

Result<std::unique_ptr<GenicamTake>> GenicamTake::open(const std::string& folder, double rate_hz,
                                                       GenicamDepthLayout layout, Shutter shutter) {
  MIXRIG_ASSIGN(auto reader, take::TakeReader::open(folder));
  const take::TakeInfo info = reader.info();
  const bool along_ray = info.depth_kind == capture::DepthKind::kDistance;
  std::vector<Frame> frames;
  capture::Capture capture;
  for (int number = 1; number <= info.frames; ++number) {
    MIXRIG_TRY(reader.read(number, capture));
    Frame frame;
    for (int y = 0; y < capture.plate.height(); ++y)
      for (int x = 0; x < capture.plate.width(); ++x) {
        const Rgb8& c = capture.plate.at(x, y);
        frame.color.insert(frame.color.end(), {c.r, c.g, c.b});
      }
    for (int y = 0; y < capture.depth_m.height(); ++y)
      for (int x = 0; x < capture.depth_m.width(); ++x) {
        double z_m = capture.depth_m.at(x, y);
        const auto ray = along_ray ? info.tof.unproject({x, y}) : std::nullopt;
        if (ray) z_m /= std::sqrt(1 + ray->squaredNorm());
        frame.steps.push_back(z_m > 0 ? static_cast<std::uint16_t>(std::lround(z_m / kStep_m))
                                      : kInvalid);
        frame.amplitude.push_back(static_cast<std::uint16_t>(std::lround(std::clamp(
            capture.amplitude.empty() ? 0.0F : capture.amplitude.at(x, y), 0.0F, 65535.0F))));
      }
    frames.push_back(std::move(frame));
  }
  return std::unique_ptr<GenicamTake>(new GenicamTake(std::move(frames), capture.plate.size(),
                                                      depth_features(info, layout), info.noise,
                                                      rate_hz, layout, std::move(shutter)));
}

GenicamTake::GenicamTake(std::vector<Frame> frames, Size color_px, const GenicamFeatures& depth,
                         const geometry::DepthNoise& noise, double rate_hz,
                         GenicamDepthLayout layout, Shutter shutter)
    : frames_(std::move(frames)),
      color_px_(color_px),
      depth_px_(depth.size),
      noise_(noise),
      rate_hz_(rate_hz),
      layout_(layout),
      shutter_(std::move(shutter)),
      color_("COLOR", {.sends_alone = false, .size = color_px}),
      depth_("TOF", depth, nullptr, "127.0.0.2"),
      thread_([this] { play(); }) {}

GenicamTake::~GenicamTake() {
  stop_ = true;
  thread_.join();
}

int GenicamTake::frame_of(std::uint64_t counter) const {
  return std::clamp(static_cast<int>(counter), 1, frames());
}

std::string GenicamTake::rig_tables() const {
  const auto table = [&](const std::string& header, const std::string& serial,
                         const std::string& more) {
    return header + "\nuri = \"aravis:Aravis-Fake-" + serial +
           "\"\nrate_hz = " + std::to_string(rate_hz_) + "\n" + more;
  };
  char noise[120];
  std::snprintf(noise, sizeof noise, "noise = [%.9g, %.9g, %.9g]\n", noise_.floor_m, noise_.linear,
                noise_.quadratic_per_m);
  const std::string color = table("[[camera]]", "COLOR", "name = \"target\"\nformat = \"rgb8\"\n");
  if (layout_ == GenicamDepthLayout::kNone) return color;
  return color + table("[depth]", "TOF", std::string("name = \"tof\"\nlight = true\n") + noise);
}

void GenicamTake::wait_for(std::function<int()> recorded) {
  const std::lock_guard lock(mutex_);
  recorded_ = std::move(recorded);
}

void GenicamTake::wait_for_host(std::uint64_t counter) {
  const auto end = steady_clock::now() + 10s;
  for (; !stop_; std::this_thread::sleep_for(5ms)) {
    const std::lock_guard lock(mutex_);
    if (!recorded_) return;
    const auto done = static_cast<std::uint64_t>(recorded_()) + left_out_ + kAhead;
    if (done >= counter) return;
    if (steady_clock::now() > end) left_out_ += counter - done;
  }
}

void GenicamTake::play() {
  std::uint64_t counter = 0;
  auto due = steady_clock::now();
  while (!stop_) {
    if (!color_.acquiring() || !(depth_.acquiring() || layout_ == GenicamDepthLayout::kNone)) {
      counter = 0;
      std::this_thread::sleep_for(5ms);
      due = steady_clock::now();
      continue;
    }
    std::this_thread::sleep_until(due);
    ++counter;
    wait_for_host(counter);
    send(frames_[static_cast<std::size_t>(frame_of(counter) - 1)], counter);
    finished_ = counter >= frames_.size() + 2;
    due = std::max(due + duration_cast<steady_clock::duration>(duration<double>(1 / rate_hz_)),
                   steady_clock::now());
  }
}

void GenicamTake::send(const Frame& frame, std::uint64_t counter) {
  const auto stamp_ns =
      static_cast<std::uint64_t>(nanoseconds(steady_clock::now().time_since_epoch()).count()) +
      kClockAhead_ns;
  if (shutter_) shutter_(frame_of(counter));
  if (layout_ != GenicamDepthLayout::kNone) send_depth(frame, counter, stamp_ns);
  sender_.send_picture(color_.host(), static_cast<std::uint16_t>(counter), stamp_ns,
                       {device::pfnc::kRgb8, color_px_, frame.color});
}

void GenicamTake::send_depth(const Frame& frame, std::uint64_t counter, std::uint64_t stamp_ns) {
  if (layout_ == GenicamDepthLayout::kParts) {
    const GvspPicture parts[] = {
        {device::pfnc::kCoord3dC16, depth_px_, bytes_of(frame.steps), 5, 1},
        {device::pfnc::kMono16, depth_px_, bytes_of(frame.amplitude), 1, 2},
        {device::pfnc::kConfidence16, depth_px_, bytes_of(frame.amplitude), 9, 3}};
    return sender_.send_parts(depth_.host(), counter, stamp_ns, parts);
  }
  buffer_.clear();
  const auto word = [&](int value) {
    buffer_.push_back(static_cast<std::uint8_t>(value));
    buffer_.push_back(static_cast<std::uint8_t>(value >> 8));
  };
  for (std::size_t i = 0; i < frame.steps.size(); ++i)
    word(0), word(0), word(frame.steps[i]), word(frame.amplitude[i]);  // A and B are not read
  sender_.send_picture(depth_.host(), static_cast<std::uint16_t>(counter), stamp_ns,
                       {device::pfnc::kCoord3dAbcy16, depth_px_, buffer_});
}

}  // namespace mixrig::test
