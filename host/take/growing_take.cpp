// SPDX-License-Identifier: Apache-2.0
#include "host/take/growing_take.h"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "hal/base/partial_path.h"
#include "host/config/table.h"
#include "host/image_io/image_io.h"
#include "host/take/depth_steps.h"
#include "host/take/manifest.h"

namespace mixrig::take {
namespace fs = std::filesystem;

namespace {

constexpr const char* kAnglesHead = "frame,pan_rad,tilt_rad\n";
constexpr std::size_t kMostAngles_bytes = std::size_t{16} << 20;

Result<void> make_grown_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (!error) return {};
  return system_error(ErrorCode::kIo, "cannot make folder '" + path.string() + "'", error.value());
}

/// The first `count` lines of a text.
std::string first_lines(const std::string& text, int count) {
  std::size_t end = 0;
  for (int i = 0; i < count && end < text.size(); ++i) {
    const std::size_t line = text.find('\n', end);
    end = line == std::string::npos ? text.size() : line + 1;
  }
  return text.substr(0, end);
}

}  // namespace

struct GrowingTake::State {
  fs::path folder;
  TakeInfo info;
  std::string angles = kAnglesHead;  ///< pan_tilt.csv
  Image<std::uint16_t> steps;
  int frames = 0;
  bool lit = false;  ///< its frames have amplitudes

  Result<void> begin();
  Result<void> resume();
  Result<void> copy_calibration();
  Result<void> write_frame(const capture::Capture& frame, int number);
  Result<void> write_manifest(int count);
};

Result<void> GrowingTake::State::copy_calibration() {
  if (info.calibration.empty()) return {};
  MIXRIG_ASSIGN(const std::string text, config::read_text(info.calibration, kMostAngles_bytes));
  info.calibration = "calibration.toml";
  return write_file(folder / info.calibration, text);
}

Result<void> GrowingTake::State::begin() {
  for (const char* name : {"color", "depth", "amplitude"})
    MIXRIG_TRY(make_grown_folder(folder / name));
  return copy_calibration();
}

/// Rows of frames that the manifest does not count are dropped.
Result<void> GrowingTake::State::resume() {
  MIXRIG_ASSIGN(const TakeReader reader, TakeReader::open(folder));
  frames = reader.info().frames;
  lit = reader.info().amplitude.has_value();
  MIXRIG_ASSIGN(const std::string text,
                config::read_text(folder / "pan_tilt.csv", kMostAngles_bytes));
  angles = first_lines(text, frames + 1);
  return copy_calibration();
}

Result<void> GrowingTake::State::write_frame(const capture::Capture& frame, int number) {
  const auto path = [&](const char* stream) {
    return folder / stream / fmt::format("{:06d}.png", number);
  };
  MIXRIG_TRY(image_io::write_png(path("color"), frame.plate.view()));
  to_steps(frame.depth_m, info.depth_unit_m, info.depth_unknown, steps);
  MIXRIG_TRY(image_io::write_png(path("depth"), std::as_const(steps).view()));
  if (!lit) return {};
  to_steps(frame.amplitude, 1.0, 0, steps);
  return image_io::write_png(path("amplitude"), std::as_const(steps).view());
}

Result<void> GrowingTake::State::write_manifest(int count) {
  const auto stream = [&](const char* name) {
    return StreamInfo{std::string(name) + "/%06d.png", 1, count, info.rate_hz};
  };
  info.color = stream("color"), info.depth = stream("depth");
  info.amplitude.reset();
  if (lit) info.amplitude = stream("amplitude");
  info.has_poses = info.has_truth = false;
  return write_file(folder / "take.toml", manifest_text(info));
}

GrowingTake::GrowingTake(std::unique_ptr<State> state) : state_(std::move(state)) {}
GrowingTake::GrowingTake(GrowingTake&&) noexcept = default;
GrowingTake& GrowingTake::operator=(GrowingTake&&) noexcept = default;
GrowingTake::~GrowingTake() = default;

Result<GrowingTake> GrowingTake::open(const fs::path& folder, const TakeInfo& info) {
  auto state = std::make_unique<State>();
  state->folder = folder, state->info = info;
  std::error_code error;
  const bool there = fs::exists(folder / "take.toml", error);
  MIXRIG_TRY(there ? state->resume() : state->begin());
  return GrowingTake(std::move(state));
}

int GrowingTake::frames() const { return state_->frames; }

Result<void> GrowingTake::append(std::span<const capture::Capture> frames,
                                 device::PanTiltAngles at) {
  State& s = *state_;
  if (frames.empty()) return {};
  if (s.frames == 0) s.lit = !frames[0].amplitude.empty();
  std::string angles = s.angles;
  int number = s.frames;
  for (const capture::Capture& frame : frames) {
    if (s.lit && frame.amplitude.empty())
      return Error{ErrorCode::kData, "a frame without amplitudes in a take that has them"};
    MIXRIG_TRY(s.write_frame(frame, ++number));
    angles += fmt::format("{},{:.9f},{:.9f}\n", number, at.pan_rad, at.tilt_rad);
  }
  MIXRIG_TRY(write_file(s.folder / "pan_tilt.csv", angles));
  MIXRIG_TRY(s.write_manifest(number));
  s.angles = std::move(angles), s.frames = number;
  return {};
}

}  // namespace mixrig::take
