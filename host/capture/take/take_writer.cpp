// SPDX-License-Identifier: Apache-2.0
// Writes takes frame by frame into a folder that is a take from its first frame on.
#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "hal/base/left_partial.h"
#include "hal/base/output_folder.h"
#include "hal/base/partial_path.h"
#include "host/capture/take/disk_sync.h"
#include "host/capture/take/frame_tables.h"
#include "host/capture/take/growing_table.h"
#include "host/capture/take/manifest.h"
#include "host/capture/take/stream_writer.h"
#include "host/capture/take/streams/depth_steps.h"
#include "host/capture/take/streams/fisheye_stream.h"
#include "host/capture/take/streams/raw_depth.h"
#include "host/capture/take/trajectory.h"
#include "host/capture/take/unfinished.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::take {
namespace fs = std::filesystem;

namespace {

/// Rate that is used if none is known; Matroska stamps need one.
constexpr double kDefaultRate_hz = 25.0;

constexpr const char* kManifestName = "take.toml";
constexpr const char* kTrueLensTable = "truth/lens.csv";
constexpr const char* kTruePeopleTable = "truth/people.csv";

}  // namespace

struct TakeWriter::State {
  State(const fs::path& folder, const TakeInfo& take_info, StreamFormat format)
      : partial(folder),
        info(take_info),
        disk(partial.path()),
        color(partial.path(), "color", PixelKind::kRgb8, format, rate(info.color), disk),
        depth(partial.path(), "depth", PixelKind::kGray16, format, rate(info.depth), disk),
        amplitude(partial.path(), "amplitude", PixelKind::kGray16, format, rate(info.depth), disk),
        depth2(partial.path(), "depth2", PixelKind::kGray16, format, rate(info.depth), disk),
        amplitude2(partial.path(), "amplitude2", PixelKind::kGray16, format, rate(info.depth),
                   disk),
        fisheye(partial.path(), "fisheye", PixelKind::kRgb8, format,
                rate(info.fisheye.value_or(StreamInfo{})), disk) {}
  ~State();

  static double rate(const StreamInfo& stream) {
    return stream.rate_hz > 0 ? stream.rate_hz : kDefaultRate_hz;
  }
  Result<void> append(const char* name, const char* header, std::string_view rows);
  Result<void> copy_calibration();
  Result<void> write_streams(const capture::Capture& frame);
  Result<void> write_fisheye(const capture::Capture& frame);
  Result<void> write_second_depth(const capture::DepthPicture& picture);
  SecondDepthStream second_streams() const;
  TakeInfo described() const;
  Result<void> follow_streams();
  Result<void> finish_streams();

  PartialPath partial;
  TakeInfo info;
  DiskSync disk;
  FolderLock lock;
  StreamWriter color, depth, amplitude, depth2, amplitude2, fisheye;
  std::map<std::string, GrowingTable> tables;  ///< by name
  std::string manifest;                        ///< as it is on the disk
  HostTime last_fisheye = HostTime::min(), last_lens = HostTime::min();
  Image<std::uint16_t> steps;
  int frames = 0;
  std::optional<Error> failed;  ///< what write() has returned
};

/// A take that was not finished stays under its partial name if a frame was written.
TakeWriter::State::~State() {
  if (frames == 0 || partial.path().empty()) return;
  (void)finish_streams();
  partial.keep();
}

Result<void> TakeWriter::State::append(const char* name, const char* header,
                                       std::string_view rows) {
  auto at = tables.find(name);
  if (at == tables.end()) {
    at = tables.emplace(name, GrowingTable(partial.path() / name, header)).first;
    disk.grows(at->second.path());
  }
  return at->second.append(rows);
}

/// Writes each fisheye picture once, with the first frame that has it. A camera that restarted may
/// stamp a picture before its last: it is skipped, since a reader refuses it.
Result<void> TakeWriter::State::write_fisheye(const capture::Capture& frame) {
  if (frame.fisheye.empty() || frame.fisheye_mid_exposure <= last_fisheye) return {};
  last_fisheye = frame.fisheye_mid_exposure;
  MIXRIG_TRY(fisheye.write(frame.fisheye.view()));
  return append(kFisheyeTable, kFisheyeHeader,
                fisheye_row(fisheye.info().count,
                            {frames + 1, frame.fisheye_counter, frame.fisheye_mid_exposure}));
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
  MIXRIG_TRY(check_output_folder(folder, kManifestName, Force::kChecked));
  MIXRIG_TRY(set_aside_left(folder));
  auto state = std::make_unique<State>(folder, info, format);
  MIXRIG_TRY(make_take_folder(state->partial.path()));
  state->lock = FolderLock(state->partial.path());
  if (!info.calibration.empty()) MIXRIG_TRY(state->copy_calibration());
  return TakeWriter(std::move(state));
}

Result<void> TakeWriter::State::write_streams(const capture::Capture& frame) {
  MIXRIG_TRY(disk.error());
  MIXRIG_TRY(color.write(frame.plate.view()));
  const bool raw = !info.raw_depth.empty();
  if (!raw) {
    to_steps(frame.depth_m, depth_steps(info), steps);
    MIXRIG_TRY(depth.write(std::as_const(steps).view()));
  }
  if (!raw && !frame.amplitude.empty()) {
    to_steps(frame.amplitude, {}, steps);
    MIXRIG_TRY(amplitude.write(std::as_const(steps).view()));
  }
  if (info.depth2) MIXRIG_TRY(write_second_depth(frame.depth2));
  MIXRIG_TRY(write_fisheye(frame));
  if (frame.encoders && frame.mid_exposure > last_lens) {
    last_lens = frame.mid_exposure;
    MIXRIG_TRY(append(kLensTable, kLensHeader, lens_row({frame.mid_exposure, *frame.encoders})));
  }
  if (!info.has_poses) return {};
  return append("poses.txt", "", trajectory_line({frame.time_s, frame.world_from_target}));
}

/// The manifest of what was written until now. A frame counts only if all its streams were written.
TakeInfo TakeWriter::State::described() const {
  TakeInfo is = info;
  is.color = color.info(), is.depth = depth.info();
  is.depth.delay_s = info.depth.delay_s;
  if (is.depth2) is.depth2 = second_streams();
  if (!is.raw_depth.empty()) is.depth.path = kRawPattern;
  is.color.count = is.depth.count = frames;
  is.amplitude.reset(), is.fisheye.reset();
  if (amplitude.info().count > 0) {
    is.amplitude = amplitude.info();
    is.amplitude->count = std::min(frames, is.amplitude->count);
  }
  if (fisheye.info().count > 0) is.fisheye = fisheye.info();
  return is;
}

/// Writes the manifest when the first frame, or a stream that it does not name yet, was written.
/// While a take is written its counts are 1: a reader counts what is in the files.
Result<void> TakeWriter::State::follow_streams() {
  TakeInfo is = described();
  std::vector<StreamInfo*> streams{&is.color, &is.depth};
  if (is.amplitude) streams.push_back(&*is.amplitude);
  if (is.fisheye) streams.push_back(&*is.fisheye);
  if (is.depth2) streams.push_back(&is.depth2->depth);
  if (is.depth2 && is.depth2->amplitude) streams.push_back(&*is.depth2->amplitude);
  for (StreamInfo* stream : streams) stream->count = 1;
  std::string text = manifest_text(is, true);
  if (text == manifest) return {};
  const fs::path path = partial.path() / kManifestName;
  MIXRIG_TRY(write_file(path, text));
  disk.wrote(path);
  manifest = std::move(text);
  return {};
}

Result<void> TakeWriter::write(const capture::Capture& frame) {
  State& s = *state_;
  Result<void> done = s.write_streams(frame);
  if (done) {
    ++s.frames;
    done = s.follow_streams();
  }
  if (!done) s.failed = done.error();
  return done;
}

Result<void> TakeWriter::append(const char* table, const char* header, std::string_view rows) {
  return state_->append(table, header, rows);
}

void TakeWriter::wrote(const fs::path& file) { state_->disk.wrote(file); }

Result<void> TakeWriter::write_truth(const capture::Truth& truth) {
  State& s = *state_;
  s.info.has_truth = true;
  const fs::path folder = s.partial.path() / "truth";
  for (const char* name : {"depth", "matte", "light", "composite", "labels"})
    MIXRIG_TRY(make_take_folder(folder / name));
  const std::string name = number_name(s.frames);
  if (truth.lens)
    MIXRIG_TRY(s.append(kTrueLensTable, kTrueLensHeader, true_lens_row(s.frames, *truth.lens)));
  if (!truth.people.empty())
    MIXRIG_TRY(s.append(kTruePeopleTable, kPeopleHeader, people_rows(s.frames, truth.people)));
  to_steps(truth.depth_m, {.unit = s.info.truth_depth_unit_m}, s.steps);
  MIXRIG_TRY(image_io::write_png(folder / "depth" / name, std::as_const(s.steps).view()));
  to_steps(truth.light, {.unit = 1.0 / 65535.0}, s.steps);
  MIXRIG_TRY(image_io::write_png(folder / "light" / name, std::as_const(s.steps).view()));
  MIXRIG_TRY(image_io::write_png(folder / "matte" / name, truth.matte.view()));
  MIXRIG_TRY(image_io::write_png(folder / "composite" / name, truth.composite.view()));
  MIXRIG_TRY(image_io::write_png(folder / "labels" / name, truth.labels.view()));
  return s.follow_streams();
}

const fs::path& TakeWriter::staging() const { return state_->partial.path(); }

void TakeWriter::discard() { state_->frames = 0; }

/// Ends all streams. Errors: the first one's.
Result<void> TakeWriter::State::finish_streams() {
  Result<void> done;
  for (StreamWriter* stream : {&color, &depth, &amplitude, &depth2, &amplitude2, &fisheye}) {
    const Result<void> ended = stream->finish();
    if (done && !ended) done = ended.error();
  }
  return done;
}

Result<void> TakeWriter::finish() {
  State& s = *state_;
  if (s.frames == 0) return Error{ErrorCode::kData, "a take needs at least one frame"};
  const Result<void> ended = s.finish_streams();
  if (ended && !s.failed)
    MIXRIG_TRY(write_file(s.partial.path() / kManifestName, manifest_text(s.described())));
  else
    MIXRIG_TRY(make_whole(s.partial.path()));
  Result<void> on_disk = s.disk.finish();
  if (on_disk) on_disk = sync_path(s.partial.path());
  const fs::path folder = s.partial.path().parent_path();
  MIXRIG_TRY(s.partial.commit());
  s.frames = 0;
  if (on_disk) on_disk = sync_path(folder.empty() ? fs::path(".") : folder);
  if (s.failed) return {};  // write() has told it
  return ended ? on_disk : ended;
}

}  // namespace mixrig::take
