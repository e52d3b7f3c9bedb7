// SPDX-License-Identifier: Apache-2.0
// Writes takes frame by frame into a folder that gets its name at the end.
#include <algorithm>
#include <cerrno>
#include <fstream>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "hal/base/partial_path.h"
#include "host/capture/take/frame_tables.h"
#include "host/capture/take/manifest.h"
#include "host/capture/take/streams/depth_steps.h"
#include "host/capture/take/streams/fisheye_stream.h"
#include "host/capture/take/streams/matroska.h"
#include "host/capture/take/streams/raw_depth.h"
#include "host/capture/take/trajectory.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::take {
namespace fs = std::filesystem;

namespace {

/// Rate that is used if none is known; Matroska stamps need one.
constexpr double kDefaultRate_hz = 25.0;

Result<void> make_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error)
    return system_error(ErrorCode::kIo, "cannot make folder '" + path.string() + "'",
                        error.value());
  return {};
}

std::string number_name(int number) { return fmt::format("{:06d}.png", number); }

}  // namespace

/// One 16-bit or colour stream, as pictures or as a Matroska file.
class StreamWriter {
 public:
  StreamWriter(fs::path folder, const char* name, PixelKind kind, StreamFormat format,
               double rate_hz)
      : folder_(std::move(folder)), name_(name), kind_(kind), format_(format), rate_hz_(rate_hz) {}

  template <typename T>
  Result<void> write(ImageView<const T> image) {
    ++count_;
    if (format_ == StreamFormat::kPng) {
      if (count_ == 1) MIXRIG_TRY(make_folder(folder_ / name_));
      return image_io::write_png(folder_ / name_ / number_name(count_), image);
    }
    if (!matroska_) {
      MIXRIG_ASSIGN(auto writer, MatroskaWriter::create(folder_ / (name_ + ".mkv"), kind_,
                                                        image.size, rate_hz_));
      matroska_ = std::make_unique<MatroskaWriter>(std::move(writer));
    }
    return matroska_->write(image);
  }

  Result<void> finish() { return matroska_ ? matroska_->finish() : Result<void>(); }

  StreamInfo info() const {
    return {format_ == StreamFormat::kPng ? name_ + "/%06d.png" : name_ + ".mkv", 1, count_,
            rate_hz_};
  }

 private:
  fs::path folder_;
  std::string name_;
  PixelKind kind_;
  StreamFormat format_;
  double rate_hz_;
  int count_ = 0;
  std::unique_ptr<MatroskaWriter> matroska_;
};

struct TakeWriter::State {
  State(const fs::path& folder, const TakeInfo& take_info, StreamFormat format)
      : partial(folder),
        info(take_info),
        color(partial.path(), "color", PixelKind::kRgb8, format, rate(info.color)),
        depth(partial.path(), "depth", PixelKind::kGray16, format, rate(info.depth)),
        amplitude(partial.path(), "amplitude", PixelKind::kGray16, format, rate(info.depth)),
        depth2(partial.path(), "depth2", PixelKind::kGray16, format, rate(info.depth)),
        amplitude2(partial.path(), "amplitude2", PixelKind::kGray16, format, rate(info.depth)),
        fisheye(partial.path(), "fisheye", PixelKind::kRgb8, format,
                rate(info.fisheye.value_or(StreamInfo{}))) {}

  static double rate(const StreamInfo& stream) {
    return stream.rate_hz > 0 ? stream.rate_hz : kDefaultRate_hz;
  }
  Result<void> write_text(const char* name, const std::string& text) const;
  Result<void> copy_calibration();
  Result<void> write_fisheye(const capture::Capture& frame);
  Result<void> write_second_depth(const capture::DepthPicture& picture);
  SecondDepthStream second_streams() const;

  PartialPath partial;
  TakeInfo info;
  StreamWriter color, depth, amplitude, depth2, amplitude2, fisheye;
  std::string poses, fisheye_rows, lens_rows, true_lens_rows, people_rows;
  HostTime last_fisheye = HostTime::min(), last_lens = HostTime::min();
  Image<std::uint16_t> steps;
  int frames = 0;
};

Result<void> TakeWriter::State::write_text(const char* name, const std::string& text) const {
  const fs::path path = partial.path() / name;
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (file) return {};
  return system_error(ErrorCode::kIo, "cannot write '" + path.string() + "'", errno);
}

/// Writes each fisheye picture once, with the first frame that has it. A camera that restarted may
/// stamp a picture before its last: it is skipped, since a reader refuses it.
Result<void> TakeWriter::State::write_fisheye(const capture::Capture& frame) {
  if (frame.fisheye.empty() || frame.fisheye_mid_exposure <= last_fisheye) return {};
  last_fisheye = frame.fisheye_mid_exposure;
  MIXRIG_TRY(fisheye.write(frame.fisheye.view()));
  fisheye_rows += fisheye_row(fisheye.info().count,
                              {frames + 1, frame.fisheye_counter, frame.fisheye_mid_exposure});
  return {};
}

/// Writes the second depth. A frame without it gets unknown depth, so that frames and files have
/// the same numbers.
Result<void> TakeWriter::State::write_second_depth(const capture::DepthPicture& picture) {
  const Size size = info.tof2->model.size_px();
  const auto write = [&](const Image<float>& image, const Steps& meaning,
                         StreamWriter& stream) -> Result<void> {
    if (image.size() == size)
      to_steps(image, meaning, steps);
    else
      steps.reset(size, static_cast<std::uint16_t>(meaning.unknown[0]));
    return stream.write(std::as_const(steps).view());
  };
  MIXRIG_TRY(write(picture.depth_m, depth_steps(*info.tof2), depth2));
  if (!info.depth2->amplitude) return {};
  return write(picture.amplitude, {}, amplitude2);
}

SecondDepthStream TakeWriter::State::second_streams() const {
  SecondDepthStream streams{depth2.info(), std::nullopt};
  streams.depth.delay_s = info.depth2->depth.delay_s;
  if (info.depth2->amplitude) streams.amplitude = amplitude2.info();
  return streams;
}

/// Copies the calibration into the take.
Result<void> TakeWriter::State::copy_calibration() {
  constexpr const char* kName = "calibration.toml";
  std::error_code error;
  fs::copy_file(info.calibration, partial.path() / kName, error);
  if (error)
    return system_error(ErrorCode::kNotFound,
                        "cannot copy calibration '" + info.calibration.string() + "'",
                        error.value());
  info.calibration = kName;
  return {};
}

TakeWriter::TakeWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
TakeWriter::TakeWriter(TakeWriter&&) noexcept = default;
TakeWriter& TakeWriter::operator=(TakeWriter&&) noexcept = default;
TakeWriter::~TakeWriter() = default;

Result<TakeWriter> TakeWriter::create(const fs::path& folder, const TakeInfo& info,
                                      StreamFormat format) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::exists(folder / "take.toml", error) &&
      !fs::is_empty(folder, error))
    return Error{ErrorCode::kUsage,
                 "'" + folder.string() + "' exists and is not a take: give another folder"};
  auto state = std::make_unique<State>(folder, info, format);
  MIXRIG_TRY(make_folder(state->partial.path()));
  if (!info.calibration.empty()) MIXRIG_TRY(state->copy_calibration());
  return TakeWriter(std::move(state));
}

Result<void> TakeWriter::write(const capture::Capture& frame) {
  State& s = *state_;
  MIXRIG_TRY(s.color.write(frame.plate.view()));
  const bool raw = !s.info.raw_depth.empty();
  if (!raw) {
    to_steps(frame.depth_m, depth_steps(s.info), s.steps);
    MIXRIG_TRY(s.depth.write(std::as_const(s.steps).view()));
  }
  if (!raw && !frame.amplitude.empty()) {
    to_steps(frame.amplitude, {}, s.steps);
    MIXRIG_TRY(s.amplitude.write(std::as_const(s.steps).view()));
  }
  if (s.info.depth2) MIXRIG_TRY(s.write_second_depth(frame.depth2));
  MIXRIG_TRY(s.write_fisheye(frame));
  if (frame.encoders && frame.mid_exposure > s.last_lens) {
    s.last_lens = frame.mid_exposure;
    s.lens_rows += lens_row({frame.mid_exposure, *frame.encoders});
  }
  s.poses += trajectory_line({frame.time_s, frame.world_from_target});
  ++s.frames;
  return {};
}

Result<void> TakeWriter::write_truth(const capture::Truth& truth) {
  State& s = *state_;
  s.info.has_truth = true;
  const fs::path folder = s.partial.path() / "truth";
  for (const char* name : {"depth", "matte", "light", "composite", "labels"})
    MIXRIG_TRY(make_folder(folder / name));
  const std::string name = number_name(s.frames);
  if (truth.lens) s.true_lens_rows += true_lens_row(s.frames, *truth.lens);
  s.people_rows += people_rows(s.frames, truth.people);
  to_steps(truth.depth_m, {.unit = s.info.truth_depth_unit_m}, s.steps);
  MIXRIG_TRY(image_io::write_png(folder / "depth" / name, std::as_const(s.steps).view()));
  to_steps(truth.light, {.unit = 1.0 / 65535.0}, s.steps);
  MIXRIG_TRY(image_io::write_png(folder / "light" / name, std::as_const(s.steps).view()));
  MIXRIG_TRY(image_io::write_png(folder / "matte" / name, truth.matte.view()));
  MIXRIG_TRY(image_io::write_png(folder / "composite" / name, truth.composite.view()));
  return image_io::write_png(folder / "labels" / name, truth.labels.view());
}

const fs::path& TakeWriter::staging() const { return state_->partial.path(); }

Result<void> TakeWriter::finish() {
  State& s = *state_;
  if (s.frames == 0) return Error{ErrorCode::kData, "a take needs at least one frame"};
  for (StreamWriter* stream :
       {&s.color, &s.depth, &s.amplitude, &s.depth2, &s.amplitude2, &s.fisheye})
    MIXRIG_TRY(stream->finish());
  s.info.color = s.color.info();
  const double delay_s = s.info.depth.delay_s;
  s.info.depth = s.depth.info();
  s.info.depth.delay_s = delay_s;
  if (s.info.depth2) s.info.depth2 = s.second_streams();
  if (!s.info.raw_depth.empty()) s.info.depth.path = kRawPattern;
  // A frame counts only if all its streams were written.
  s.info.color.count = s.info.depth.count = s.frames;
  s.info.amplitude.reset();
  if (s.amplitude.info().count > 0) {
    s.info.amplitude = s.amplitude.info();
    s.info.amplitude->count = std::min(s.frames, s.info.amplitude->count);
  }
  s.info.fisheye.reset();
  if (s.fisheye.info().count > 0) {
    s.info.fisheye = s.fisheye.info();
    MIXRIG_TRY(s.write_text(kFisheyeTable, kFisheyeHeader + s.fisheye_rows));
  }
  if (s.info.has_poses) MIXRIG_TRY(s.write_text("poses.txt", s.poses));
  if (!s.lens_rows.empty()) MIXRIG_TRY(s.write_text(kLensTable, kLensHeader + s.lens_rows));
  if (!s.true_lens_rows.empty())
    MIXRIG_TRY(s.write_text("truth/lens.csv", kTrueLensHeader + s.true_lens_rows));
  if (!s.people_rows.empty())
    MIXRIG_TRY(s.write_text("truth/people.csv", kPeopleHeader + s.people_rows));
  MIXRIG_TRY(s.write_text("take.toml", manifest_text(s.info)));
  return s.partial.commit();
}

}  // namespace mixrig::take
