// SPDX-License-Identifier: Apache-2.0
// Reads the frames of an open take, and their truth.
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "hal/base/guarded.h"
#include "host/capture/capture/fisheye.h"
#include "host/capture/take/streams/picture_files.h"
#include "host/capture/take/take_state.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::take {
namespace fs = std::filesystem;

/// Sets everything of a capture except its images.
void TakeReader::State::describe(int number, capture::Capture& capture) const {
  using capture::Stream;
  using capture::StreamStatus;
  const FrameIndex& index = frames[static_cast<std::size_t>(number - 1)];
  capture.number = number;
  capture.time_s = index.time_s;
  capture.mid_exposure = HostTime(Duration(std::llround(index.time_s * 1e9)));
  capture.tick = 0;
  if (const auto known = ticks.find(number); known != ticks.end()) {
    capture.tick = known->second.tick;
    capture.mid_exposure = known->second.mid_exposure;
  }
  const auto exposed = [&](double after_s) {
    return capture.mid_exposure + Duration(std::llround(1e9 * after_s));
  };
  capture.depth_mid_exposure = exposed(index.depth_after_s);
  if (depth2) capture.depth2.mid_exposure = exposed(index.depth2_after_s);
  capture.pan_tilt.reset();
  const auto angles = pan_tilt.find(number);
  if (angles != pan_tilt.end()) capture.pan_tilt = angles->second;
  capture.encoders = mixrig::capture::lens_at(lens, capture.mid_exposure);
  capture.lens.reset();
  capture.cameras = cameras;
  capture.world_from_target = index.world_from_target;
  capture.pose_origin = !manifest.pose_file.empty() ? capture::PoseOrigin::kRecorded
                        : manifest.fixed_pose       ? capture::PoseOrigin::kFixed
                                                    : capture::PoseOrigin::kUnknown;
  capture.status = {};
  capture.set_status(Stream::kPlate, StreamStatus::kFresh);
  capture.set_status(Stream::kDepth, StreamStatus::kFresh);
  if (depth2) capture.set_status(Stream::kDepth2, StreamStatus::kFresh);
  if (!pan_tilt.empty())
    capture.set_status(Stream::kPanTilt,
                       angles != pan_tilt.end() ? StreamStatus::kFresh : StreamStatus::kMissing);
}

/// Reads 16-bit steps (or EXR metres) as floats; `unknown` becomes 0.
Result<void> TakeReader::State::read_steps(PictureStream& stream, int index, const Steps& meaning,
                                           Image<float>& out) {
  if (stream.holds_float()) return stream.read(index, out);
  MIXRIG_TRY(stream.read(index, steps));
  from_steps(steps, meaning, out);
  return {};
}

fs::path TakeReader::State::truth_file(const char* what, int number) const {
  return manifest.info.root / manifest.truth_path / what / fmt::format("{:06d}.png", number);
}

template <typename T>
Result<void> TakeReader::State::check_size(const Image<T>& image, Size wanted,
                                           const std::string& name, const char* table) const {
  if (image.size() == wanted) return {};
  const auto size_text = [](Size s) {
    return std::to_string(s.width) + "x" + std::to_string(s.height);
  };
  const std::string is = "picture '" + name + "' is " + size_text(image.size());
  if (manifest.without_tables)
    return Error{ErrorCode::kData, is + ", the assumed camera " + size_text(wanted) + ": '" +
                                       manifest.info.path.string() +
                                       "' has no take.toml: write one with [target], [tof] and "
                                       "[target_from_tof]"};
  return Error{ErrorCode::kData, is + " but [" + table + "] size_px is " + size_text(wanted) +
                                     ": correct one of them"};
}

Result<void> TakeReader::State::read_second_depth(int index, capture::DepthPicture& out) {
  const Size size = info().tof2->model.size_px();
  const Steps meaning = depth_steps(*info().tof2, manifest.further_unknown2);
  MIXRIG_TRY(read_steps(*depth2, index, meaning, out.depth_m));
  if (depth2_check.wants_more() && !depth2->holds_float())
    depth2_check.look(steps, meaning, out.depth_m);
  MIXRIG_TRY(check_size(out.depth_m, size, depth2->name(index), "tof2"));
  if (!amplitude2) return {};
  MIXRIG_TRY(read_steps(*amplitude2, index, {}, out.amplitude));
  return check_size(out.amplitude, size, amplitude2->name(index), "tof2");
}

Result<void> TakeReader::State::read_depth(int index, Image<float>& out) {
  const Steps meaning = depth_steps(info(), manifest.further_unknown);
  MIXRIG_TRY(read_steps(*depth, index, meaning, out));
  if (!depth_check.wants_more()) return {};
  if (depth->holds_float())
    depth_check.look(out);
  else
    depth_check.look(steps, meaning, out);
  return {};
}

TakeReader::TakeReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
TakeReader::TakeReader(TakeReader&&) noexcept = default;
TakeReader& TakeReader::operator=(TakeReader&&) noexcept = default;
TakeReader::~TakeReader() = default;

const TakeInfo& TakeReader::info() const { return state_->manifest.info; }

Result<void> TakeReader::read(int number, capture::Capture& frame) {
  State& s = *state_;
  const TakeInfo& info = s.info();
  if (number < 1 || number > info.frames)
    return Error{ErrorCode::kNotFound, "take '" + info.path.string() + "' has no frame " +
                                           std::to_string(number) + ": it has 1 to " +
                                           std::to_string(info.frames)};
  if (!s.joined.empty()) return s.read_joined(number, frame);
  return guarded(fmt::format("frame {} of take '{}'", number, info.path.string()),
                 [&] { return s.read_frame(number, frame); });
}

Result<void> TakeReader::State::read_frame(int number, capture::Capture& frame) {
  const FrameIndex& index = frames[static_cast<std::size_t>(number - 1)];
  describe(number, frame);
  MIXRIG_TRY(color->read(index.color, frame.plate));
  MIXRIG_TRY(check_size(frame.plate, info().target.size_px(), color->name(index.color), "target"));
  if (raw)
    MIXRIG_TRY(raw->read(index.depth, frame.depth_m, frame.amplitude));
  else
    MIXRIG_TRY(read_depth(index.depth, frame.depth_m));
  MIXRIG_TRY(check_size(frame.depth_m, info().tof.size_px(),
                        raw ? raw->name(index.depth) : depth->name(index.depth), "tof"));
  if (fisheye)
    MIXRIG_TRY(fisheye->read(frame));
  else
    capture::clear_fisheye(frame);
  if (depth2) MIXRIG_TRY(read_second_depth(index.depth2, frame.depth2));
  if (!amplitude) return {};
  MIXRIG_TRY(read_steps(*amplitude, index.depth, {}, frame.amplitude));
  return check_size(frame.amplitude, info().tof.size_px(), amplitude->name(index.depth), "tof");
}

Result<void> TakeReader::read_truth(int number, capture::Truth& truth) {
  State& s = *state_;
  const TakeInfo& info = s.info();
  if (!info.has_truth || number < 1 || number > info.frames)
    return Error{ErrorCode::kNotFound, "take '" + info.path.string() + "' has no truth of frame " +
                                           std::to_string(number)};
  if (!s.joined.empty()) return s.read_joined_truth(number, truth);
  truth.people.clear();
  if (const auto known = s.people.find(number); known != s.people.end())
    truth.people = known->second;
  truth.lens.reset();
  if (const auto known = s.true_lens.find(number); known != s.true_lens.end())
    truth.lens = known->second;
  const int file = info.color.first + s.frames[static_cast<std::size_t>(number - 1)].color;
  const auto read_scaled = [&](const char* what, double unit, Image<float>& out) -> Result<void> {
    PictureFiles stream([&](int) { return s.truth_file(what, file); });
    MIXRIG_TRY(s.read_steps(stream, 0, {.unit = unit}, out));
    return s.check_size(out, info.target.size_px(), stream.name(0), "target");
  };
  MIXRIG_TRY(read_scaled("depth", info.truth_depth_unit_m, truth.depth_m));
  MIXRIG_TRY(read_scaled("light", 1.0 / 65535.0, truth.light));
  MIXRIG_TRY(image_io::read_gray8(s.truth_file("matte", file), truth.matte));
  MIXRIG_TRY(s.check_size(truth.matte, info.target.size_px(), s.truth_file("matte", file).string(),
                          "target"));
  MIXRIG_TRY(image_io::read_rgb8(s.truth_file("composite", file), truth.composite));
  MIXRIG_TRY(s.check_size(truth.composite, info.target.size_px(),
                          s.truth_file("composite", file).string(), "target"));
  MIXRIG_TRY(image_io::read_gray8(s.truth_file("labels", file), truth.labels));
  return s.check_size(truth.labels, info.target.size_px(), s.truth_file("labels", file).string(),
                      "target");
}

}  // namespace mixrig::take
